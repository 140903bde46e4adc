"""Computes the tables of this folder. `python compute.py --help` says how; README.md says what."""

import argparse
import shutil
import subprocess
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

import checks
import dam
import package
import read
import tables

SHARED = {"lobovsky": 30, "martin_moyce": 20, "square": 20}  # the meshes on which the variants run
VARIANTS = {
    "mules": dict(solver="interFoam"),
    "tension": dict(tension=dam.TENSION),
    "high_rim": dict(rim=0.9),
}
DOUBLE = 0.4  # Courant number of the runs on the finest mesh with twice the step
SAFETY = 1.25  # of the grid convergence index with three meshes (Roache)
NEAR_BY = 0.1  # an uncertainty in a series is the greatest so near to the row [(H/g)^(1/2)]
ARRIVAL = 0.1  # the wave has arrived when P1 first exceeds this [rho g H]
WINDOWS = (1.0, 2.5)  # impulses are counted for so long after the arrival [(H/g)^(1/2)]
RUNNING = (1.0, 2.3)  # the speed of the front is found between these times [(H/g)^(1/2)]


def steps(scene):
    """The runs of a scene on its finest mesh, with its step and with twice the step.

    The step is of first order, so the difference of the two is the error of the first.
    """
    run = dam.Run(scene, dam.SCENES[scene].meshes[-1])
    return run, replace(run, courant=DOUBLE)


def variants():
    """(name, run) of every variant, at last twice the step on the finest mesh."""
    for name, changes in VARIANTS.items():
        for scene, n in SHARED.items():
            if name == "high_rim" and scene != "lobovsky":
                continue
            yield name, replace(dam.Run(scene, n), **changes)
    for scene in dam.SCENES:
        yield "double_step", steps(scene)[1]


def runs():
    """All runs, the cheap ones first."""
    base = [dam.Run(scene.name, n) for scene in (dam.REST, *dam.SCENES.values()) for n in scene.meshes]
    every = dict.fromkeys([*base, *(run for _, run in variants())])
    return sorted(every, key=lambda run: np.prod(run.cells) * run.n / run.courant)


def simulate(run, runs):
    """Makes a run in a folder below `runs` and keeps what read.py takes of it; the fields are deleted."""
    folder, kept = runs / run.label, runs / f"{run.label}.npz"
    if kept.exists():
        return
    shutil.rmtree(folder, ignore_errors=True)
    dam.write(run, folder)
    for program in ("blockMesh", run.solver):
        with open(folder / f"log.{program}", "w") as log:
            subprocess.run([program], cwd=folder, stdout=log, stderr=subprocess.STDOUT, check=True)
    np.savez_compressed(kept, **read.read(run, folder))
    shutil.rmtree(folder)


def first_above(t, values, level):
    """Time at which a curve first passes a level, linear between its points; NaN if it never does."""
    above = np.flatnonzero(values > level)
    if above.size == 0:
        return np.nan
    k = above[0]
    return t[k] if k == 0 else np.interp(level, values[k - 1 : k + 1], t[k - 1 : k + 1])


def arrival(kept):
    """When P1 first exceeds ARRIVAL."""
    return first_above(kept["p_t"], kept["p"][0], ARRIVAL)


def impulse(kept, sensor, window):
    """Integral of a pressure from the arrival at P1 on; NaN if the run ends before."""
    t, p, start = kept["p_t"], kept["p"][sensor], arrival(kept)
    if t[-1] < start + window:
        return np.nan
    inside = t[(t > start) & (t < start + window)]
    points = np.concatenate(([start], inside, [start + window]))
    return np.trapezoid(np.interp(points, t, p), points)


def tongue(kept):
    """Mean level at H4 for one unit of time from when it first exceeds 0.02."""
    t, level = kept["t"], kept["H4"]
    start = first_above(t, level, 0.02)
    if not t[-1] > start + 1.0:
        return np.nan
    fine = np.linspace(start, start + 1.0, 101)
    return np.interp(fine, t, level).mean()


def speed(kept):
    """Slope of the least squares line of the front."""
    t, x = kept["t"], kept["front"]
    if t[-1] < RUNNING[1]:
        return np.nan
    inside = (t > RUNNING[0] - 1e-6) & (t < RUNNING[1] + 1e-6)
    return np.polyfit(t[inside], x[inside], 1)[0]


def at(name, time):
    """Value of a curve at a time, NaN after the end of a run."""

    def value(kept):
        return np.interp(time, kept["t"], kept[name]) if kept["t"][-1] > time - 1e-6 else np.nan

    return value


LENGTH, TIME, PRESSURE, IMPULSE, ENERGY = "H", "(H/g)^(1/2)", "rho g H", "rho g H (H/g)^(1/2)", "M g H/2"


def of_tank():
    """(quantity, unit, function) in the tank."""
    for name in ("front", "front_depth_2", "front_depth_5"):
        for time_ in (1.0, 1.5, 2.0, 2.3):
            yield f"{name}_at_{time_:g}", LENGTH, at(name, time_)
    yield "front_speed", "(g H)^(1/2)", speed
    yield "arrival", TIME, arrival
    yield "tongue", LENGTH, tongue
    for probe in ("H1", "H2", "H3", "H4"):
        for time_ in (2.0, 3.0, 4.0, 5.0):
            if (probe, time_) not in (("H3", 2.0), ("H4", 2.0)):
                yield f"{probe}_at_{time_:g}", LENGTH, at(probe, time_)
    for window in WINDOWS:
        for k in range(4):
            yield (
                f"impulse_P{k + 1}_{window:g}",
                IMPULSE,
                lambda kept, k=k, window=window: impulse(kept, k, window),
            )
    for k in range(4):
        yield (
            f"peak_P{k + 1}",
            PRESSURE,
            lambda kept, k=k: kept["p"][k].max() if kept["t"][-1] > 3.5 else np.nan,
        )
    yield "reaches_rim", TIME, lambda kept: first_above(kept["t"], kept["run_up"], 1.999)
    for time_ in (2.0, 3.0, 4.0, 5.0):
        yield f"kinetic_at_{time_:g}", ENERGY, at("kinetic", time_)
        yield f"potential_at_{time_:g}", ENERGY, at("potential", time_)
    for time_ in (4.0, 5.0):
        yield f"lost_at_{time_:g}", "water", lambda kept, time_=time_: 1 - at("water", time_)(kept)
    yield "jet_closes", TIME, lambda kept: first_above(kept["t"], kept["pocket"], read.POCKET)


def of_column(times):
    """(quantity, unit, function) of a column that runs out freely."""

    def listed():
        for name in ("front", "front_depth_2", "front_depth_5", "height", "height_wall"):
            for time_ in times:
                yield f"{name}_at_{time_:g}", LENGTH, at(name, time_)
        for time_ in times:
            yield f"kinetic_at_{time_:g}", ENERGY, at("kinetic", time_)
            yield f"potential_at_{time_:g}", ENERGY, at("potential", time_)

    return listed


QUANTITIES = {
    "lobovsky": of_tank,
    "martin_moyce": of_column((0.5, 1.0, 1.5, 1.65)),
    "square": of_column((1.0, 1.5, 2.0, 2.5)),
}


def digits(value, figures=6):
    """A cell: empty if there is no number."""
    return "" if not np.isfinite(value) else f"{value:.{figures}g}"


def judge(numbers):
    """(uncertainty, extrapolated, order) of three numbers from coarse to fine.

    The grid convergence index: SAFETY times what Richardson's extrapolation adds. The order is the observed
    one, at least 1/2, in the uncertainty at most 1, in the extrapolation at most 2. Where differences change
    their sign or grow there is none: three times the last difference. Of two meshes: SAFETY times their
    difference, as for the order 1.
    """
    numbers = [number for number in numbers if np.isfinite(number)]
    if len(numbers) < 2:
        return np.nan, np.nan, np.nan
    last = numbers[-1] - numbers[-2]
    if len(numbers) == 2:
        return SAFETY * abs(last), np.nan, np.nan
    before = numbers[-2] - numbers[-3]
    if last == 0.0 or before / last <= 1.0:
        return 3.0 * abs(last), np.nan, np.nan
    order = np.log2(before / last)
    adds = [last / (2.0 ** min(max(order, 0.5), most) - 1.0) for most in (1.0, 2.0)]
    return SAFETY * abs(adds[0]), numbers[-1] + adds[1], order


def summary(folder):
    """Rows of summary.csv."""
    for scene, quantities in QUANTITIES.items():
        made = read.meshes(folder, scene)
        single, double = (read.load(folder, run) for run in steps(scene))
        for name, unit, of in quantities():
            numbers = {n: of(kept) for n, kept in made}
            finite = [(n, value) for n, value in numbers.items() if np.isfinite(value)]
            if not finite:
                continue
            error, limit, order = judge([value for _, value in finite])
            step = abs(of(double) - of(single))
            error += step if np.isfinite(step) else 0.0
            each = [digits(numbers.get(n, np.nan)) for n in dam.SCENES[scene].meshes]
            yield (
                scene,
                name,
                unit,
                digits(finite[-1][1]),
                digits(error, 2),
                finite[-1][0],
                digits(limit),
                digits(order, 2),
                *each,
            )


def spread(folder):
    """Rows of spread.csv."""
    for name, run in variants():
        made, base = read.load(folder, run), read.load(folder, dam.Run(run.scene, run.n))
        if made is None or base is None:
            continue
        for quantity, unit, of in QUANTITIES[run.scene]():
            value, reference = of(made), of(base)
            if np.isfinite(value) and np.isfinite(reference):
                yield run.scene, name, run.n, quantity, unit, digits(value), f"{value - reference:.2g}"


def distance(one, other, name, clock, times):
    """The greatest distance of two curves within NEAR_BY of each time."""
    far = abs(np.interp(times, one[clock], one[name]) - np.interp(times, other[clock], other[name]))
    return np.array([far[abs(times - time_) <= NEAR_BY + 1e-9].max() for time_ in times])


def columns(pairs, names, clock, times, figures):
    """Columns of a table: of each curve its values at the times and its uncertainty, as text.

    `pairs` are runs whose curves differ, each with the share of their distance that counts. The values are
    those of the first run of the first pair.
    """
    out = []
    for name in names:
        values = np.interp(times, pairs[0][1][clock], pairs[0][1][name])
        errors = sum(share * distance(one, other, name, clock, times) for share, one, other in pairs)
        errors = np.maximum(errors, 0.5 * 10.0**-figures)
        out += [[f"{value:.{figures}f}" for value in values], [f"{error:.1e}" for error in errors]]
    return out


CURVES = ("front", "front_depth_2", "front_depth_5", "height", "height_wall", "kinetic", "potential", "lost")
LEVELS = tuple(f"{kind}H{k}" for kind in ("", "top_") for k in (1, 2, 3, 4))


def with_curves(kept):
    """A run with the curves that are made of others."""
    pressures = {f"P{k + 1}": kept["p"][k] for k in range(4)} if "p" in kept else {}
    return kept | {"lost": 1 - kept["water"]} | pressures


def segments(folder, scene):
    """(mesh, pairs, from, to): the two finest meshes that reach the rows of each segment, and the two steps.

    The finest mesh may end before the others; what comes later is that of the next, and column mesh says so.
    """
    made = [(n, with_curves(kept)) for n, kept in read.meshes(folder, scene)]
    single, double = (with_curves(read.load(folder, run)) for run in steps(scene))
    done = -1.0
    for (_, coarse), (n, fine) in reversed(list(pairwise(made))):
        end = min(fine["t"][-1], coarse["t"][-1])
        if end > done:
            yield n, [(SAFETY, fine, coarse), (1.0, single, double)], done, end
            done = end


def sampled(folder, scene, names):
    """Rows of curves at regular times."""
    for n, pairs, start, end in segments(folder, scene):
        times = np.round(np.arange(0, int(round(end / dam.SAMPLE)) + 1) * dam.SAMPLE, 6)
        times = times[times > start + 1e-6]
        cells = columns(pairs, names, "t", times, 4)
        yield from zip([f"{t:.2f}" for t in times], [n] * len(times), *cells, strict=True)


def series(folder):
    """Rows of series.csv."""
    for scene in dam.SCENES:
        yield from ((scene, *row) for row in sampled(folder, scene, CURVES))


def levels(folder):
    """Rows of levels.csv."""
    yield from sampled(folder, "lobovsky", LEVELS)


def pressure(folder):
    """Rows of pressure.csv: from shortly before the arrival on, with the clock of the mesh of the row.

    The uncertainty compares after the arrivals were put on each other: a steep rise that comes a little later
    is in the uncertainty of the arrival.
    """
    for n, pairs, start, end in segments(folder, "lobovsky"):
        clock = arrival(pairs[0][1])
        if np.isnan(clock):
            continue
        moved = [
            (share, *(kept | dict(p_t=kept["p_t"] + clock - arrival(kept)) for kept in both))
            for share, *both in pairs
        ]
        p_t = pairs[0][1]["p_t"]
        last = min(end, *(kept["p_t"][-1] for _, *both in moved for kept in both))
        times = p_t[(p_t > max(start, clock - 0.1)) & (p_t < last)]
        cells = columns(moved, ("P1", "P2", "P3", "P4"), "p_t", times, 4)
        yield from zip([f"{t:.3f}" for t in times], [n] * len(times), *cells, strict=True)


def every_table(folder):
    """The rows of each."""
    return {
        "series": series(folder),
        "levels": levels(folder),
        "pressure": pressure(folder),
        "summary": summary(folder),
        "spread": spread(folder),
        "checks": checks.rows(folder),
    }


def text(value):
    """A cell of a number that is not yet text."""
    return tables.number(value) if isinstance(value, float) else value


def main():
    """Makes the runs that are missing, then the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--runs", type=Path, required=True, help="folder of the runs; those in it are not repeated"
    )
    parser.add_argument("--tables", action="store_true", help="only write the tables from the runs there are")
    parser.add_argument("--only", nargs="*", help="labels of the runs to make; all if not given")
    options = parser.parse_args()
    options.runs.mkdir(parents=True, exist_ok=True)
    for run in [] if options.tables else runs():
        if options.only is None or run.label in options.only:
            start = time.time()
            simulate(run, options.runs)
            print(f"{run.label}: {time.time() - start:.0f} s", flush=True)
    if options.only is None:
        every = every_table(options.runs).items()
        cells = {name: [[text(value) for value in row] for row in rows] for name, rows in every}
        tables.write(Path(__file__).parent, package.TABLES, cells)


if __name__ == "__main__":
    main()
