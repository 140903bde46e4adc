"""Computes the tables of this folder. `python compute.py --help` says how; README.md says what."""

from pathlib import Path

import numpy as np

import bar
import checks
import kept
import package
import tables
from tables import doubt, fixed, number, widest

MESHES, STEP = (4, 8), 0.0025
SAMPLE = 0.01


def runs():
    """All bars as keyword arguments, the cheap ones first."""
    coarse, fine = MESHES
    listed = []
    for law in bar.LAWS:
        for gravity in (bar.LARGE, bar.SMALL):
            base = dict(law=law, gravity=gravity)
            listed += [dict(base, layers=coarse, step=step) for step in (STEP, STEP / 2)]
            listed += [dict(base, layers=fine, step=STEP)]
    return sorted(listed, key=lambda run: run["layers"] ** 2 / run["step"])


def file(law, gravity, layers, step):
    return f"{law}_{gravity}_{layers}_{step:.3g}.npz"


def told(_, result):
    found = summary(result, 0)
    mean, amplitude = 1e3 * found["mean_y"], 1e3 * found["amplitude_y"]
    return f"y {mean:.4f} +- {amplitude:.4f} mm, {found['frequency']:.5f} Hz"


def summary(run, station):
    return bar.summary(run["t"], *run["path"][:, station].T)


def unit(quantity):
    return {"frequency": "Hz", "first_fall": "s", "last_fall": "s"}.get(quantity, "m")


def load(folder, law, gravity, layers, step=STEP):
    return dict(np.load(folder / file(law, gravity, layers, step)))


def family(folder, law, gravity):
    """The coarse and the fine mesh, and the coarse one with half the step."""
    coarse, fine = MESHES
    of = (coarse, STEP), (fine, STEP), (coarse, STEP / 2)
    return [load(folder, law, gravity, *one) for one in of]


def uncertainty(values):
    """Mesh, plus time step, whose error is of second order."""
    coarse, fine, half = values
    return np.abs(fine - coarse) + 4 / 3 * np.abs(half - coarse)


def series_rows(folder):
    for law in bar.LAWS:
        found = family(folder, law, bar.LARGE)
        paths = [run["path"][:: round(SAMPLE / float(run["step"])), 0] for run in found]
        wide = np.apply_along_axis(widest, 0, uncertainty(paths))
        for n, place in enumerate(paths[1]):
            row = [bar.LARGE, law, fixed(n * SAMPLE, 2)]
            for k in range(2):
                row += [fixed(place[k], 7), doubt(wide[n, k], 7)]
            yield row


def summary_rows(folder):
    for law in bar.LAWS:
        loads = {gravity: family(folder, law, gravity) for gravity in (bar.LARGE, bar.SMALL)}
        for station, layers in enumerate(("", *bar.LAYERS)):
            values = {gravity: [summary(run, station) for run in runs] for gravity, runs in loads.items()}
            for key in values[bar.LARGE][0]:
                for gravity, found in values.items():
                    of = [one[key] for one in found]
                    yield [gravity, law, layers, key, unit(key), number(of[1], 7), doubt(uncertainty(of)),
                           *(number(value, 7) for value in of)]


def check_rows(folder):
    for run in runs():
        result = dict(np.load(folder / file(**run)))
        total = result["kinetic"] + result["strain"] + result["lift"]
        change = np.abs(total[::10]).max() / result["kinetic"].max()
        yield ["greatest change of the total energy over the greatest kinetic energy", run["gravity"],
               run["law"], run["layers"], number(run["step"]), number(change, 3), "0"]
    for check, gravity, law, mesh, step, value, expected in checks.rows():
        yield [check, gravity, law, mesh, step, number(value, 8), number(expected, 8)]


if __name__ == "__main__":
    folder = kept.folder(__doc__)
    kept.make(folder, runs(), file, bar.run, told)
    tables.write(Path(__file__).parent, package.TABLES, {
        "series": series_rows(folder), "summary": summary_rows(folder),
        "checks": check_rows(folder),
    })
