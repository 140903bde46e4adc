"""Computes the tables of this folder. `python compute.py --help` says how; README.md says what."""

from pathlib import Path

import numpy as np

import checks
import kept
import package
import plane_strain
import plate
import tables
from plate import STEP
from tables import doubt, fixed, number, richardson, widest

MESHES = (4, 8, 16)
MIDDLE = 8  # the mesh on which other clamps are
SHARED = 4  # the mesh on which the half step is
SAMPLE = 0.002
SWINGS = 6  # half periods


def runs():
    """All plates as keyword arguments, the cheap ones first."""
    listed = [dict(law=law, layers=n, step=STEP) for law in plane_strain.LAWS for n in MESHES]
    listed += [dict(law=law, layers=SHARED, step=STEP / 2) for law in plane_strain.LAWS]
    middle = dict(law="hencky", layers=MIDDLE, step=STEP)
    listed += [dict(middle, behind=plate.THICKNESS / n / 2) for n in plate.LAYERS]
    return sorted(listed, key=lambda run: run["layers"] ** 2 / run["step"])


def file(law, layers, step, behind=0.0):
    return f"{law}_{layers}_{step:.3g}{f'_{behind:.3g}' if behind else ''}.npz"


def told(_, result):
    period = summary(result, 0)["period"]
    return f"period {period:.7f} s, iterations {result['iterations']:.1f}, factors {result['factored']}"


# --- Numbers of one run -------------------------------------------------------------------------------

def extreme(t, y):
    """Value of greatest magnitude and its time, by a parabola through three samples."""
    n = int(np.clip(np.argmax(np.abs(y)), 1, len(y) - 2))
    a, b, c = y[n - 1 : n + 2]
    shift = 0.5 * (a - c) / (a - 2 * b + c)
    return b - 0.25 * (a - c) * shift, t[n] + shift * (t[1] - t[0])


def summary(run, station):
    """Quantities of summary.csv of a station: name -> value."""
    t, (x, y) = run["t"], run["path"][:, station].T
    k = np.flatnonzero(y[1:-1] * y[2:] < 0) + 1
    passages = t[k] + (t[k + 1] - t[k]) * y[k] / (y[k] - y[k + 1])
    bounds = np.r_[0, passages]
    out = {"period": passages[1], "period_2": passages[3] - passages[1],
           "period_3": passages[5] - passages[3]}
    for n in range(SWINGS):
        inside = (t > bounds[n]) & (t < bounds[n + 1])
        out[f"extreme_{n + 1}"], out[f"t_extreme_{n + 1}"] = extreme(t[inside], y[inside])
    for n in range(SWINGS):
        out[f"passage_{n + 1}"] = passages[n]
    out["period_excess"] = out["period"] / plate.thin_plate_period() - 1
    out["amplitude_ratio"] = out["extreme_1"] * 2 * np.pi / (out["period"] * plate.SPEED)
    first = t < bounds[2]
    out["x_least"] = extreme(t[first], x[first])[0]
    return out


UNITS = {"period_excess": "-", "amplitude_ratio": "-", "x_least": "m"}


def unit(quantity):
    return UNITS.get(quantity, "m" if quantity.startswith("extreme") else "s")


# --- Tables -------------------------------------------------------------------------------------------

def family(folder, law):
    """Three meshes, and the mesh SHARED with the step and with half of it."""
    def load(layers, step=STEP):
        return dict(np.load(folder / file(law, layers, step)))

    return [load(n) for n in MESHES] + [load(SHARED), load(SHARED, STEP / 2)]


def uncertainty(values):
    """Mesh, plus time step, whose error is of second order."""
    _, middle, fine, whole, half = values
    return np.abs(fine - middle) + 4 / 3 * np.abs(half - whole)


def series_rows(folder):
    every, end = round(SAMPLE / STEP), 1 + round(plate.UNTIL / SAMPLE)
    for law in plane_strain.LAWS:
        found = family(folder, law)
        paths = [run["path"][:: round(SAMPLE / float(run["step"]))][:end] for run in found]
        wide = np.apply_along_axis(widest, 0, uncertainty([path[:, 0] for path in paths]))
        fine = paths[2]
        for n, t in enumerate(found[2]["t"][::every][:end]):
            row = [law, fixed(t, 3)]
            for k in range(2):
                row += [fixed(fine[n, 0, k], 7), doubt(wide[n, k], 7)]
            for station in range(1, len(plate.LAYERS) + 1):
                row += [fixed(fine[n, station, k], 7) for k in range(2)]
            yield row


def summary_rows(folder):
    for law in plane_strain.LAWS:
        found = family(folder, law)
        for station, layers in enumerate(("", *plate.LAYERS)):
            values = [summary(run, station) for run in found]
            for key in values[2]:
                of = [v[key] for v in values]
                extrapolated, order = richardson(*of[:3])
                yield [law, layers, key, unit(key), number(of[2], 7), doubt(uncertainty(of)),
                       number(extrapolated, 7), number(order, 2), *(number(value, 7) for value in of)]


def clamp_rows(folder):
    """Plates that are clamped half a spacing behind the place where those of the case begin to be held."""
    base = dict(np.load(folder / file("hencky", MIDDLE, STEP)))
    for station, layers in enumerate(plate.LAYERS, 1):
        behind = plate.THICKNESS / layers / 2
        run = dict(np.load(folder / file("hencky", MIDDLE, STEP, behind)))
        mine, theirs = summary(run, station), summary(base, station)
        row = [layers, number(behind)]
        for key in ("period", "extreme_1"):
            row += [number(mine[key]), number(mine[key] / theirs[key] - 1, 3)]
        yield row


def check_rows(folder):
    for run in runs():
        if "behind" in run:
            continue
        result = dict(np.load(folder / file(**run)))
        total = result["kinetic"] + result["strain"]
        change = np.abs(total[::10] / total[0] - 1).max()
        yield ["greatest change of the total energy over the initial", run["law"], run["layers"],
               number(run["step"]), number(change, 3), "0"]
    for check, law, mesh, step, value, expected in checks.rows():
        yield [check, law, mesh, step, number(value, 8), number(expected, 8)]


if __name__ == "__main__":
    folder = kept.folder(__doc__)
    kept.make(folder, runs(), file, plate.run, told)
    tables.write(Path(__file__).parent, package.TABLES, {
        "series": series_rows(folder), "summary": summary_rows(folder),
        "clamps": clamp_rows(folder), "checks": check_rows(folder),
    })
