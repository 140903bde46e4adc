"""Computes the tables of this folder: `python compute.py --runs RUNS`. README.md says what."""

from pathlib import Path

import numpy as np

import kept
import ring
import tables
from tables import doubt, number

SPEEDS, LAWS = (0.059, 0.03), ("neo_hookean",)
SHARED, COARSE, FINE = 6, 8, 12  # SHARED tells what time step and contact change, with the first law
BASE = dict(stiffness=10.0, courant=0.5)
HALF, HARD = dict(BASE, courant=0.25), dict(BASE, stiffness=40.0)


def runs():
    listed = [dict(BASE, law=law, speed=v, layers=n) for law in LAWS for n in (COARSE, FINE) for v in SPEEDS]
    listed[4:4] = [dict(how, law=LAWS[0], speed=v, layers=SHARED) for how in (BASE, HALF, HARD) for v in SPEEDS]
    return listed


def file(law, speed, layers, stiffness, courant):
    return f"{law}_{speed:g}_{layers}_{stiffness:g}_{courant:g}.npz"


def vertex(t, y):
    """Least value and its time, of the parabola through three samples, as `rubber_rings` reads it."""
    k = int(np.clip(np.argmin(y), 1, len(y) - 2))
    a, b, _ = np.polyfit(t[k - 1:k + 2] - t[k], y[k - 1:k + 2], 2)
    return y[k] - b * b / (4 * a), t[k] - b / (2 * a)


def quantities(run, speed, first=0):
    """Of the definitions in the README of `rubber_rings`: name -> value. Extremes are read from samples every
    0.5 L/c0 from the sample `first` on; there are twice as many."""
    t, v = run["t"], run["v_c"]
    touching = np.flatnonzero(run["force"] > 0)
    apart = np.flatnonzero(np.diff(t[touching]) > 5)
    assert len(apart) == 1, "two phases of contact"
    between = (t > t[touching[apart[0]]]) & (t < t[touching[apart[0] + 1]])
    late = t > t[touching[-1]]
    width = run["x_max"] - run["x_min"]
    out = {"restitution": v[-1] / speed, "v_c_between_phases": v[between].mean()}

    def put(name, values, sign, part=np.ones(len(t), bool)):
        own = np.flatnonzero(part & (np.arange(len(t)) % 2 == first))
        found, when = vertex(t[own], -sign * values[own])
        out[name], out[f"t_{name}"] = -sign * found, when

    put("x_c_min", run["x_c"], -1)
    put("width_min", width, -1)
    put("height_max", run["height"], 1)
    put("strain_max", run["strain"], 1)
    put("kinetic_min", run["kinetic"], -1)
    put("width_max_after", width, 1, late)
    put("height_min_after", run["height"], -1, late)
    out["x_c_200"] = run["x_c"][-1]
    return out


def unit(name):
    energy = "rho c0^2 L^2"
    plain = {"restitution": "-", "v_c_between_phases": "c0", "strain_max": energy, "kinetic_min": energy}
    return plain.get(name, "L/c0" if name.startswith("t_") else "L")


def values(load):
    rows = []
    for speed in SPEEDS:
        other = [quantities(load(LAWS[0], speed, SHARED, **how), speed) for how in (BASE, HALF, HARD)]
        for law in LAWS:
            coarse, fine = (quantities(load(law, speed, n, **BASE), speed) for n in (COARSE, FINE))
            later = quantities(load(law, speed, FINE, **BASE), speed, first=1)
            for name in fine:
                base, half, hard = (run[name] for run in other)
                c, f = coarse[name], fine[name]
                u = abs(f - c) + 4 / 3 * abs(half - base) + abs(hard - base) + abs(later[name] - f)
                of = c, f, later[name], base, half, hard
                rows.append((speed, law, name, unit(name), number(f), doubt(u), *map(number, of)))
    return rows


def checks(load):
    for speed in SPEEDS:
        for law in LAWS:
            for layers in (COARSE, FINE):
                run = load(law, speed, layers, **BASE)
                total = run["kinetic"] + run["strain"] + run["contact"]
                mark = speed, law, layers
                yield ("greatest change of the total energy over the initial", *mark,
                       number(np.abs(total / total[0] - 1).max(), 3), "0")
                yield ("greatest depth of a node of the outer face behind the plane [L]", *mark,
                       number(-run["x_min"].min(), 3), "0")
                yield ("mass of the ring over 7 pi, less 1", *mark, number(run["mass"] / (7 * np.pi) - 1, 2), "0")


FIELDS = {
    "values": [
        ("speed", "number", "c0", "initial, towards the plane"),
        ("law", "string", "-", "constitutive law"),
        ("quantity", "string", "-", "as in the summary of rubber_rings"),
        ("unit", "string", "-", "unit of the row"),
        ("value", "number", "see column unit", "on the fine mesh"),
        ("uncertainty", "number", "see column unit",
         "fine less coarse, plus 4/3 of half_step less base, plus hard less base, plus later less fine"),
        ("coarse", "number", "see column unit", f"on {COARSE} elements across the ring"),
        ("fine", "number", "see column unit", f"on {FINE}"),
        ("later", "number", "see column unit", f"on {FINE}, extremes read from samples half a spacing later"),
        ("base", "number", "see column unit", f"neo_hookean on {SHARED}"),
        ("half_step", "number", "see column unit", f"neo_hookean on {SHARED} with half the time step"),
        ("hard", "number", "see column unit", f"neo_hookean on {SHARED} with a plane four times as stiff")],
    "checks": [
        ("check", "string", "-", "what is checked"),
        ("speed", "number", "c0", "initial"),
        ("law", "string", "-", "constitutive law"),
        ("mesh", "integer", "-", "elements across the ring"),
        ("value", "number", "see column check", "as computed"),
        ("expected", "number", "see column check", "what it should be")],
}

if __name__ == "__main__":
    folder = kept.folder(__doc__)
    kept.make(folder, runs(), file, ring.collide, lambda run, result: f"{result['v_c'][-1] / run['speed']:.5f}")

    def load(law, speed, layers, **how):
        return dict(np.load(folder / file(law, speed, layers, **how)))

    tables.write(Path(__file__).parent, FIELDS, {"values": values(load), "checks": list(checks(load))})
