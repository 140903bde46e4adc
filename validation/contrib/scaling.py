"""How a step gets faster with threads: the dam break with 20,000, 100,000 and a million particles.

    python scaling.py [THREADS ...]

prints one table in Markdown: for each number of particles and of threads (by default 1, 2, 4, … up to the cores
of the machine) nanoseconds per particle and time step, over several runs the least, the speed-up, and its parts.
A row is refused if its particles end with other bits than on the first number of threads. Takes some minutes;
nothing else should work on the machine. TOUCHSTONE names the program, if it is not in the PATH.
"""

import json
import os
import subprocess
import sys

# Spacings along the shorter side of the column, and the end of the run [(H/g)^(1/2)]: 60 to 200 steps.
SIZES = [(100, 0.09), (224, 0.04), (707, 0.004)]
# Rounds over the numbers of threads, so that a change of the machine's speed affects all alike.
ROUNDS = 3


def run(program, size, threads):
    n, end = size
    command = [program, "run", "dam_break", "--variant", "modern", "--profile", "--json", "--allow-long"]
    command += ["--set", f"n={n}", "--set", f"end={end}", "--threads", str(threads)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def row(record):
    """Nanoseconds per particle and step by part, of the stepping and of the observing."""
    cost = record["cost"]
    steps = cost["breakdown"]["steps"] * cost["particles"]
    parts = {part["name"]: 1e9 * part["seconds"] / steps for part in cost["breakdown"]["stepping"]}
    observing = sum(part["seconds"] for part in cost["breakdown"]["observing"])
    return {"step": sum(parts.values()), "observing": 1e9 * observing / steps, **parts}


def main():
    program = os.environ.get("TOUCHSTONE", "touchstone")
    cores = os.cpu_count() or 1
    usual = [2**k for k in range(cores.bit_length())]
    counts = [int(word) for word in sys.argv[1:]] or usual
    rows, names, states = {}, [], {}
    for size in SIZES:
        for _ in range(ROUNDS):
            for threads in counts:
                record = run(program, size, threads)
                if states.setdefault(size, record["state"]) != record["state"]:
                    sys.exit(f"scaling.py: n={size[0]} has other bits on {threads} threads")
                found = {"particles": record["cost"]["particles"], "threads": threads, **row(record)}
                names = names or list(found)
                before = rows.get((size, threads), found)
                rows[size, threads] = min(before, found, key=lambda one: one["step"] + one["observing"])
    heads = names[:4] + ["speed-up"] + names[4:]
    print("| " + " | ".join(heads) + " |\n|" + "--:|" * len(heads))
    for (size, _), found in rows.items():
        first = rows[size, counts[0]]
        ratio = [(one["step"] + one["observing"]) for one in (first, found)]
        cells = [f"{found.get(name, 0.0):.{0 if name in names[:2] else 1}f}" for name in names]
        print("| " + " | ".join(cells[:4] + [f"{ratio[0] / ratio[1]:.2f}"] + cells[4:]) + " |")


main()
