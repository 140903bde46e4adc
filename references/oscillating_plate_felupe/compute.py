"""Computes the tables of this folder: `python compute.py --runs RUNS`. README.md says what."""

from pathlib import Path

import numpy as np

import felupe_motion
import kept
import plate
import tables
from tables import doubt, number

LAWS, SHARED = ("neo_hookean", "hencky", "saint_venant"), "neo_hookean"  # SHARED tells what the time step changes
COARSE, FINE, STEP, UNTIL = 8, 16, 5e-4, 0.8
POISSON = (0.2, 0.3, 0.45)  # of plates whose first period alone is computed


def runs():
    listed = [dict(law=law, layers=n, step=STEP) for law in LAWS for n in (COARSE, FINE)]
    listed.append(dict(law=SHARED, layers=COARSE, step=STEP / 2))
    return listed + [dict(law=SHARED, layers=n, step=STEP, poisson=nu) for nu in POISSON for n in (COARSE, FINE)]


def file(law, layers, step, poisson=plate.POISSON):
    return f"{law}_{layers}_{step:g}_{poisson:g}.npz"


def simulate(law, layers, step, poisson=plate.POISSON):
    return plate.swing(law, layers, step, UNTIL if poisson == plate.POISSON else 0.3, poisson)


def quantities(run, poisson=plate.POISSON):
    """Of the definitions in the README of `oscillating_plate`: name -> value."""
    t, (x, y) = run["t"], run["path"].T
    passages = felupe_motion.crossings(t[1:], y[1:])[:6]
    bounds = np.r_[0, passages]
    out = {"period": passages[1], "period_2": passages[3] - passages[1], "period_3": passages[5] - passages[3]}
    for n in range(6):
        inside = (t >= bounds[n]) & (t <= bounds[n + 1])
        sign = 1 if n % 2 == 0 else -1
        out[f"extreme_{n + 1}"] = sign * felupe_motion.peak(t[inside], sign * y[inside])[0]
        out[f"passage_{n + 1}"] = passages[n]
    out["period_excess"] = passages[1] / plate.thin_plate_period(poisson) - 1
    out["amplitude_ratio"] = out["extreme_1"] * 2 * np.pi / (passages[1] * plate.speed_of_end(poisson))
    first = t <= passages[1]
    out["x_least"] = -felupe_motion.peak(t[first], -x[first])[0]
    return out


def unit(name):
    if name in ("period_excess", "amplitude_ratio"):
        return "-"
    return "m" if name.startswith("extreme") or name == "x_least" else "s"


def values(load):
    rows = []
    for law in LAWS:
        base, half = (quantities(load(SHARED, COARSE, step)) for step in (STEP, STEP / 2))
        coarse, fine = (quantities(load(law, n, STEP)) for n in (COARSE, FINE))
        for name in fine:
            c, f, b, h = coarse[name], fine[name], base[name], half[name]
            u = abs(f - c) + 4 / 3 * abs(h - b)
            rows.append((law, "", name, unit(name), number(f, 7), doubt(u), *(number(v, 7) for v in (c, f, b, h))))
    return rows


def period(run):
    return felupe_motion.crossings(run["t"][1:], run["path"][1:, 1])[1]


def others(load):
    base, half = (period(load(SHARED, COARSE, step)) for step in (STEP, STEP / 2))
    for nu in POISSON:
        coarse, fine = (period(load(SHARED, n, STEP, nu)) for n in (COARSE, FINE))
        u = abs(fine - coarse) + 4 / 3 * abs(half - base)
        excess = fine / plate.thin_plate_period(nu) - 1
        yield nu, number(fine, 7), doubt(u), number(coarse, 7), number(excess, 4)


FIELDS = {
    "poisson": [
        ("poisson", "number", "-", "Poisson's ratio; the speed of the end is 0.01 c0 of this material"),
        ("period", "number", "s", f"first period, {SHARED}, on {FINE} elements across the thickness"),
        ("uncertainty", "number", "s", "as in values"),
        ("coarse", "number", "s", f"on {COARSE}"),
        ("period_excess", "number", "-", "period over that of a thin plate, less 1")],
    "values": [
        ("law", "string", "-", "constitutive law"),
        ("layers", "integer", "-", "empty: the middle of the end"),
        ("quantity", "string", "-", "as in the summary of oscillating_plate"),
        ("unit", "string", "-", "unit of the row"),
        ("value", "number", "see column unit", "on the fine mesh"),
        ("uncertainty", "number", "see column unit", "fine less coarse, plus 4/3 of half_step less base"),
        ("coarse", "number", "see column unit", f"on {COARSE} elements across the thickness"),
        ("fine", "number", "see column unit", f"on {FINE}"),
        ("base", "number", "see column unit", f"{SHARED} on {COARSE}"),
        ("half_step", "number", "see column unit", f"{SHARED} on {COARSE} with half the time step")],
}

if __name__ == "__main__":
    folder = kept.folder(__doc__)
    kept.make(folder, runs(), file, simulate, lambda run, result: f"end {result['path'][-1]}")

    def load(*which, **more):
        return dict(np.load(folder / file(*which, **more)))

    tables.write(Path(__file__).parent, FIELDS, {"values": values(load), "poisson": list(others(load))})
