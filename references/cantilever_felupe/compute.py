"""Computes the tables of this folder: `python compute.py --runs RUNS`. README.md says what."""

from pathlib import Path

import numpy as np

import bar
import felupe_motion
import kept
import tables
from tables import doubt, number

LOADS, SHARED = (2.0, 0.2), "neo_hookean"  # SHARED tells what the time step changes
CASES = [("neo_hookean", 2.0), ("neo_hookean", 0.2), ("saint_venant", 2.0), ("saint_venant", 0.2), ("hencky", 2.0)]
COARSE, FINE, STEP, UNTIL = 8, 16, 0.0025, 4.0


def runs():
    listed = [dict(law=law, gravity=g, layers=n, step=STEP) for law, g in CASES for n in (COARSE, FINE)]
    listed[4:4] = [dict(law=SHARED, gravity=g, layers=COARSE, step=STEP / 2) for g in LOADS]
    listed.append(dict(law="saint_venant", gravity=2.0, layers=COARSE, step=0.005, arc=True, until=10.0))
    return listed


def file(law, gravity, layers, step, arc=False, until=UNTIL):
    return f"{law}_{gravity:g}_{layers}_{step:g}{'_arc' if arc else ''}.npz"


def simulate(law, gravity, layers, step, arc=False, until=UNTIL):
    body = bar.bar(layers, law, arc=arc)
    return body.move(step, until, body.end, load=bar.weight(body, gravity))


def quantities(run):
    """Of the definitions in the README of `cantilever`: name -> value."""
    t, (x, y) = run["t"], run["path"].T
    out = {}
    for name, path in (("x", x), ("y", y)):
        high, low = felupe_motion.peak(t, path)[0], -felupe_motion.peak(t, -path)[0]
        out[f"mean_{name}"], out[f"amplitude_{name}"] = (high + low) / 2, (high - low) / 2
    falls = felupe_motion.crossings(t, y - out["mean_y"], downwards=True)
    out["frequency"] = (len(falls) - 1) / (falls[-1] - falls[0])
    inside = np.r_[falls[0], t[(t > falls[0]) & (t < falls[-1])], falls[-1]]
    span = falls[-1] - falls[0]
    for name, path in (("x", x), ("y", y)):
        values = np.interp(inside, t, path)
        turn = 2 * np.pi * out["frequency"] * inside
        out[f"average_{name}"] = np.trapezoid(values, inside) / span
        parts = (np.trapezoid(values * f(turn), inside) for f in (np.cos, np.sin))
        out[f"harmonic_{name}"] = 2 / span * np.hypot(*parts)
    out["first_fall"], out["last_fall"] = falls[0], falls[-1]
    first = t < falls[1]
    out["first_least_y"] = -felupe_motion.peak(t[first], -y[first])[0]
    return out


def unit(name):
    return {"frequency": "Hz"}.get(name, "s" if name.endswith("fall") else "m")


def values(load):
    rows = []
    for law, g in CASES:
        base, half = (quantities(load(SHARED, g, COARSE, step)) for step in (STEP, STEP / 2))
        coarse, fine = (quantities(load(law, g, n, STEP)) for n in (COARSE, FINE))
        for name in fine:
            c, f, b, h = coarse[name], fine[name], base[name], half[name]
            u = abs(f - c) + 4 / 3 * abs(h - b)
            rows.append((g, law, "", name, unit(name), number(f, 7), doubt(u), *(number(v, 7) for v in (c, f, b, h))))
    return rows


PUBLISHED = {"CSM1": (1.4e6, -7.18767e-3, -66.1023e-3), "CSM2": (5.6e6, -0.469000e-3, -16.9739e-3)}
CSM3 = {"mean_x": -14.305e-3, "amplitude_x": 14.305e-3, "mean_y": -63.607e-3, "amplitude_y": 65.160e-3,
        "frequency": 1.0995}


def checks(load):
    rows = []
    for test, (young, *expected) in PUBLISHED.items():
        for layers in (4, 8, 16, 32):
            found = bar.sag(layers, young)
            for axis in (0, 1):
                rows.append((f"{test}: u_{'xy'[axis]} of the end at rest [m], expected: FeatFlow, level 5+1",
                             layers, "", number(found[axis], 7), number(expected[axis], 7)))
    run = load("saint_venant", 2.0, COARSE, 0.005, arc=True)
    t, (x, y) = run["t"], run["path"].T
    falls = felupe_motion.crossings(t, y - CSM3["mean_y"], downwards=True)
    last = (t > falls[-2]) & (t <= falls[-1])
    found = {"frequency": 1 / (falls[-1] - falls[-2])}
    for name, path in (("x", x), ("y", y)):
        high, low = path[last].max(), path[last].min()
        found[f"mean_{name}"], found[f"amplitude_{name}"] = (high + low) / 2, (high - low) / 2
    for name, expected in CSM3.items():
        rows.append((f"CSM3: {name} of the last whole period before 10 s [m, Hz], expected: Turek and Hron",
                     COARSE, 0.005, number(found[name], 7), number(expected, 7)))
    for g in LOADS:
        run = load("neo_hookean", g, FINE, STEP)
        least = bar.DENSITY * g * bar.LENGTH * bar.THICKNESS * abs(run["path"][:, 1].mean())
        rows.append((f"greatest change of the total energy over weight times mean fall of the end, {g} m/s^2",
                     FINE, STEP, number(np.ptp(run["energy"]) / least), "0"))
    return rows


MADE = [("coarse", "number", "see column unit", f"on {COARSE} elements across the thickness"),
        ("fine", "number", "see column unit", f"on {FINE}"),
        ("base", "number", "see column unit", f"{SHARED} on {COARSE}"),
        ("half_step", "number", "see column unit", f"{SHARED} on {COARSE} with half the time step")]
FIELDS = {
    "values": [
        ("gravity", "number", "m/s^2", "acceleration of gravity, towards -y, from t = 0"),
        ("law", "string", "-", "constitutive law"),
        ("layers", "integer", "-", "empty: the middle of the end"),
        ("quantity", "string", "-", "as in the summary of cantilever"),
        ("unit", "string", "-", "unit of the row"),
        ("value", "number", "see column unit", "on the fine mesh"),
        ("uncertainty", "number", "see column unit", "fine less coarse, plus 4/3 of half_step less base"), *MADE],
    "checks": [
        ("check", "string", "-", "what is checked, and what is expected"),
        ("mesh", "integer", "-", "elements across the thickness"),
        ("step", "number", "s", "time step, empty at rest"),
        ("value", "number", "see column check", "as computed"),
        ("expected", "number", "see column check", "published")],
}

if __name__ == "__main__":
    folder = kept.folder(__doc__)
    kept.make(folder, runs(), file, simulate, lambda run, result: f"end {result['path'][-1]}")

    def load(*which, **more):
        return dict(np.load(folder / file(*which, **more)))

    tables.write(Path(__file__).parent, FIELDS, {"values": values(load), "checks": checks(load)})
