"""Computes the tables of this folder. `python compute.py --help` says how; README.md says what."""

import argparse
import functools
import sys
from pathlib import Path

import numpy as np

import checks
import kept
import package
import ring
import tables
from tables import doubt, fixed, number, richardson, widest

SPEEDS = (0.059, 0.03)
MESHES = {"hencky": (4, 8, 16), "neo_hookean": (4, 8, 16), "jaumann": (4, 8, 16),
          "saint_venant": (4, 8, 16)}
FINER = dict(law="hencky", speed=0.059, layers=32, penalty=4.0, courant=0.7)  # a check of the above
STIFFNESS, COURANT = 16.0, 0.5
SHARED = 16  # the mesh on which the half step and the rigid contact run
SEEDS, SEEDED = (1, 2, 3, 4, 5), 8  # runs from disturbed starts, on the mesh of so many elements
TOO_FAST = 0.12
APART = 5.0  # contacts closer in time than this belong to one phase
PICTURED = (32.0, 60.0, 80.0, 120.0, 200.0)  # times of the outlines
LAW_MESHES = {"neo_hookean": 16, "saint_venant": 16, "jaumann": 16}  # compared with hencky on the same


def runs():
    """All collisions as keyword arguments, the cheap ones first."""
    base = dict(penalty=STIFFNESS, courant=COURANT)
    listed = []
    for speed in SPEEDS:
        for law, meshes in MESHES.items():
            listed += [dict(base, law=law, speed=speed, layers=layers) for layers in meshes]
        listed += [dict(base, law="hencky", speed=speed, layers=SHARED, courant=COURANT / 2)]
        listed += [dict(base, law="hencky", speed=speed, layers=SHARED, penalty=None)]
        listed += [dict(base, law=law, speed=speed, layers=LAW_MESHES[law]) for law in LAW_MESHES if law not in MESHES]
        listed += [dict(base, law="hencky", speed=speed, layers=SEEDED, seed=seed) for seed in SEEDS]
    listed += [FINER]
    # Faster: only until the inner faces meet, to show why it is not certified.
    listed += [dict(base, law="hencky", speed=TOO_FAST, layers=layers, until=60.0) for layers in (8, 16)]
    return sorted(listed, key=lambda run: run["layers"] ** 3)


def file(law, speed, layers, penalty=STIFFNESS, courant=COURANT, until=200.0, seed=0):
    return f"{law}_{speed}_{layers}_{penalty}_{courant}{f'_{seed}' if seed else ''}.npz"


def told(run, result):
    return f"dt {result['dt']:.4g}, v_c/V {result['v_c'][-1] / run['speed']:.5f}"


# --- Numbers of one run -------------------------------------------------------------------------------

def series(run):
    """Columns of series.csv at the samples."""
    force = np.gradient(run["impulse"], ring.SAMPLE)
    return {"x_c": run["x_c"], "v_c": run["v_c"], "width": run["x_max"] - run["x_min"],
            "height": run["height"], "gap": run["x_min"], "pole_gap": run["pole"],
            "hole": run["hole_axis"], "force": force, "impulse": run["impulse"],
            "kinetic": run["kinetic"], "strain": run["strain"]}


def peak(t, y, sign):
    """Greatest (sign 1) or least (sign -1) value and its time, by a parabola through three samples."""
    n = int(np.clip(np.argmax(sign * y), 1, len(y) - 2))
    a, b, c = y[n - 1 : n + 2]
    bend = a - 2 * b + c
    shift = 0.5 * (a - c) / bend if bend else 0.0
    return b - 0.25 * (a - c) * shift, t[n] + shift * (t[1] - t[0])


def phases(run):
    """Contact phases: times of the first and the last touch, and of 1, 50 and 99 % of the impulse."""
    force, dt = run["force"], float(run["dt"])
    touching = np.flatnonzero(force > 0)
    breaks = np.flatnonzero(np.diff(touching) * dt >= APART)
    starts, ends = touching[np.r_[0, breaks + 1]], touching[np.r_[breaks, len(touching) - 1]]
    mean = np.gradient(run["impulse"], ring.SAMPLE)
    found = []
    for start, end in zip(starts, ends, strict=True):
        total = np.cumsum(force[start : end + 1]) * dt
        when = {f"impulse_{100 * part:.0f}": (start + np.searchsorted(total, part * total[-1])) * dt
                for part in (0.01, 0.5, 0.99)}
        inside = (run["t"] > start * dt - ring.SAMPLE) & (run["t"] < end * dt + ring.SAMPLE)
        found.append({"first_touch": start * dt, **when, "last_touch": end * dt, "impulse": total[-1],
                      "greatest_force": mean[inside].max()})
    return found


def summary(run, speed):
    """Quantities of summary.csv: name -> value."""
    t, columns = run["t"], series(run)
    found = phases(run)
    out = {"restitution": run["v_c"][-1] / speed}
    if len(found) > 1:
        middle = 0.5 * (found[0]["last_touch"] + found[1]["first_touch"])
        out["v_c_between_phases"] = float(np.interp(middle, t, run["v_c"]))
    for key in ("x_c_min", "width_min", "height_max", "hole_min", "strain_max", "kinetic_min"):
        column, extreme = key[:-4], key[-3:]
        out[key], out["t_" + key] = peak(t, columns[column], 1 if extreme == "max" else -1)
    late = t > found[-1]["last_touch"]
    out["width_max_after"], out["t_width_max_after"] = peak(t[late], columns["width"][late], 1)
    out["height_min_after"], out["t_height_min_after"] = peak(t[late], columns["height"][late], -1)
    out["x_c_200"] = run["x_c"][-1]
    return out


UNITS = {"restitution": "-", "v_c_between_phases": "c0",
         "strain_max": package.ENERGY, "kinetic_min": package.ENERGY}


def unit(quantity):
    return UNITS.get(quantity, "L/c0" if quantity.startswith("t_") else "L")


# --- Tables -------------------------------------------------------------------------------------------

class Family:
    """The runs that tell value and uncertainty for a law and a speed."""

    def __init__(self, folder, law, speed):
        def load(**run):
            return dict(np.load(folder / file(speed=speed, **run)))

        self.law, self.speed = law, speed
        self.meshes = [load(law=law, layers=layers) for layers in MESHES[law]]
        self.shared = load(law="hencky", layers=SHARED)
        self.half_step = load(law="hencky", layers=SHARED, courant=COURANT / 2)
        self.rigid = load(law="hencky", layers=SHARED, penalty=None)
        self.seeded = [load(law="hencky", layers=SEEDED, seed=seed) for seed in (0, *SEEDS)]

    def values(self, of):
        """`of` a run: three meshes, the shared mesh, with half the step, with rigid contact, the seeds."""
        return [of(run) for run in (*self.meshes, self.shared, self.half_step, self.rigid, *self.seeded)]


def uncertainty(values):
    """Mesh, plus time step, plus contact; not below half the range of the disturbed starts."""
    _, middle, fine, shared, half, rigid, *seeded = values
    parts = np.abs(fine - middle) + np.abs(half - shared) + np.abs(rigid - shared)
    return np.maximum(parts, 0.5 * np.ptp(np.array(seeded), axis=0))


DECIMALS = {"v_c": 6, "force": 4, "impulse": 5, "kinetic": 6, "strain": 6}


def series_rows(families):
    for family in families:
        every = 2 if family.law in ("neo_hookean", "saint_venant") else 1
        values = [series(run) for run in family.values(lambda run: run)]
        t = family.meshes[-1]["t"]
        wide = {key: widest(uncertainty([v[key] for v in values])) for key in values[0]}
        for n in range(0, len(t), every):
            row = [family.speed, family.law, fixed(t[n], 1)]
            for key, column in values[2].items():
                decimals = DECIMALS.get(key, 4)
                row.append(fixed(column[n], decimals))
                if key != "impulse":
                    row.append(doubt(wide[key][n], decimals))
            yield row


def summary_rows(families):
    for family in families:
        values = family.values(functools.partial(summary, speed=family.speed))
        for key in values[2]:
            of = [v[key] for v in values]
            extrapolated, order = richardson(*of[:3])
            yield [family.speed, family.law, key, unit(key), number(of[2]), doubt(uncertainty(of)),
                   number(extrapolated), number(order, 2), *map(number, of[:6]), number(np.ptp(of[6:]), 2)]


def phase_rows(families):
    for family in families:
        values = family.values(phases)
        assert len({len(found) for found in values}) == 1, "the meshes disagree on the number of phases"
        for phase in range(len(values[0])):
            row = [family.speed, family.law, phase + 1]
            for key in values[0][phase]:
                of = [v[phase][key] for v in values]
                row += [number(of[2]), doubt(uncertainty(of))]
            yield row


def law_rows(folder):
    for speed in SPEEDS:
        for law, mesh in LAW_MESHES.items():
            run, base = (dict(np.load(folder / file(one, speed, mesh))) for one in (law, "hencky"))
            reference = summary(base, speed)
            for key, value in summary(run, speed).items():
                difference = value - reference[key]
                yield [speed, law, mesh, key, unit(key), number(value), number(difference, 3)]
            for key in ("x_c", "v_c", "width", "height"):
                greatest = np.abs(series(run)[key] - series(base)[key]).max()
                name = f"{key}_greatest_difference"
                yield [speed, law, mesh, name, "c0" if key == "v_c" else "L", "", number(greatest, 3)]


def outline_rows(folder):
    """Both faces of half of the ring, every fourth node, at the times of the report's pictures."""
    speed, law = SPEEDS[0], "jaumann"
    mesh = MESHES[law][-1]
    run = dict(np.load(folder / file(law, speed, mesh)))
    for t in PICTURED:
        sample = int(round(t / ring.SAMPLE))
        for face in ("outer", "inner"):
            for x, y in run[face][sample].T[::4]:
                yield [speed, law, mesh, fixed(t, 1), face, fixed(x, 4), fixed(y, 4)]


def finer_rows(folder, row):
    """The finer run, with softer springs and a longer step, against the one that the tables hold."""
    speed, law = FINER["speed"], FINER["law"]
    both = FINER, dict(law=law, speed=speed, layers=MESHES[law][-1])
    finer, held = (dict(np.load(folder / file(**run))) for run in both)
    of = summary(held, speed)
    mark = [speed, law, FINER["layers"]]
    for key, value in summary(finer, speed).items():
        check = f"{key} on a finer mesh, springs of 4 rho cp^2 / h, against summary.csv"
        yield row(check, *mark, value, of[key])
    for key in ("x_c", "v_c", "width", "height"):
        greatest = np.abs(series(finer)[key] - series(held)[key]).max()
        yield row(f"greatest difference of {key} through time, the same two runs", *mark, greatest, 0)


def check_rows(folder):
    def row(check, speed, law, mesh, value, expected):
        return [check, speed, law, mesh, number(value, 8), "" if expected is None else number(expected, 8)]

    for run in runs():
        path = folder / file(**run)
        result = dict(np.load(path))
        total = result["kinetic"] + result["strain"] + result["contact"]
        mark = [run["speed"], run["law"], run["layers"]]
        how = "half step" if run["courant"] != COURANT else "base"
        how = "rigid contact" if run["penalty"] is None else how
        if "seed" in run:
            continue
        if run == FINER:
            yield from finer_rows(folder, row)
            continue
        if run["speed"] == TOO_FAST:
            met = np.flatnonzero(result["hole_min"] < 0.05)
            yield row("time when the inner faces come within 0.05 L", *mark, result["t"][met[0]], None)
            continue
        change = np.abs(total / total[0] - 1).max()
        yield row(f"greatest change of the total energy over the initial, {how}", *mark, change, 0)
        gained = result["mass"] * (result["v_c"] - result["v_c"][0])
        balance = np.abs(gained - result["impulse"]).max() / result["impulse"][-1]
        yield row(f"momentum gained less impulse over impulse, {how}", *mark, balance, 0)
        yield row(f"deepest penetration, {how}", *mark, max(-result["x_min"].min(), 0), 0)
        if how == "base":
            yield row("least volume ratio J at a Gauss point", *mark, result["j_min"].min(), None)
            yield row("greatest volume ratio J at a Gauss point", *mark, result["j_max"].max(), None)
            yield row("greatest principal logarithmic strain", *mark, result["log_strain"].max(), None)
            yield row("least distance of the inner faces, 60 degrees from either pole", *mark,
                      result["hole_min"].min(), None)
            yield row("length of a time step", *mark, float(result["dt"]), None)
            yield row("first touch", *mark, phases(result)[0]["first_touch"], 1 / run["speed"])
    for check, mesh, value, expected in checks.rows():
        yield [check, "", "", mesh, number(value, 8), number(expected, 8)]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=Path, required=True, help="folder that keeps the raw results")
    parser.add_argument("--speed", type=float, help="simulate this speed only and write no table")
    options = parser.parse_args()
    options.runs.mkdir(parents=True, exist_ok=True)
    wanted = [run for run in runs() if options.speed in (None, run["speed"])]
    kept.make(options.runs, wanted, file, ring.collide, told)
    if options.speed is not None:
        sys.exit()
    every_family = [Family(options.runs, law, speed) for law in MESHES for speed in SPEEDS]
    tables.write(Path(__file__).parent, package.TABLES, {
        "series": series_rows(every_family), "summary": summary_rows(every_family),
        "phases": phase_rows(every_family), "laws": law_rows(options.runs),
        "outlines": outline_rows(options.runs), "checks": check_rows(options.runs),
    })
