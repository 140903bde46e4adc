"""Computes the tables of this folder: `python compute.py --runs RUNS`. README.md says what."""

import argparse
from functools import cache
from pathlib import Path

import numpy as np

import dam
import tables
from tables import doubt, number

LEVELS, COURANT = (4, 5, 6), 0.5
ENDS = {4: 6.0, 5: 6.0, 6: 2.5}
RUNS = (4, COURANT), (4, COURANT / 2), (5, COURANT), (6, COURANT)
H, TIME, IMPULSE = "H", "(H/g)^(1/2)", "rho g H (H/g)^(1/2)"


def frames(folder, level):
    """Times, and water, velocity and pressure as rows from the floor and columns from the back wall."""
    dx = dam.BOX / 2**level
    for file in sorted(folder.glob("fields-*.txt")):
        x, y, _, water, u, v, p = np.loadtxt(file).T
        column, row = (np.rint((a + dam.BOX / 2) / dx - 0.5).astype(int) for a in (x, y))
        found = np.zeros((4, dam.ROWS * 2**level, dam.COLUMNS * 2**level))
        found[:, row, column] = np.clip(water, 0, 1), u, v, p
        yield float(file.stem[7:]), *found


def last_at_least(values, level, dx):
    """Where values at the middles of cells last fall through a level."""
    k = np.flatnonzero(values >= level)
    if len(k) == 0:
        return 0.0
    k = k[-1]
    if k + 1 == len(values):
        return len(values) * dx
    return dx * (k + 0.5 + (values[k] - level) / (values[k] - values[k + 1]))


@cache
def history(folder, level):
    dx = dam.BOX / 2**level
    low = round(0.25 / dx)
    middles = (np.arange(dam.COLUMNS * 2**level) + 0.5) * dx
    rows = []
    for t, water, u, v, p in frames(folder, level):
        near, depth = water[:low].sum(axis=0) * dx, water.sum(axis=0) * dx
        row = {"t": t, "front": max(last_at_least(line, 0.5, dx) for line in water[:low]),
               "front_depth_2": last_at_least(near, 0.02, dx), "front_depth_5": last_at_least(near, 0.05, dx),
               "kinetic": (water * (u * u + v * v)).sum() * dx * dx / dam.WIDTH}
        row |= {f"H{k + 1}": np.interp(place, middles, depth) for k, place in enumerate(dam.PROBES)}
        density, height = water + (1 - water) * dam.AIR, (np.arange(len(water)) + 0.5)[:, None] * dx
        row["momentum"] = (density * u).sum() * dx * dx
        row["energy"] = (density * ((u * u + v * v) / 2 + height)).sum() * dx * dx
        row["force"] = (1.5 * (p[:, 0] - p[:, -1]) - 0.5 * (p[:, 1] - p[:, -2])).sum() * dx
        rows.append(row)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def pressures(folder, level):
    """Times and P1 to P4: means over the disks of the sensors, then over blocks of 0.01."""
    dx = dam.BOX / 2**level
    data = np.loadtxt(folder / "sensors.txt", usecols=(0, 2, 4))
    y = np.unique(data[:, 1])
    t, p = data[::len(y), 0], data[:, 2].reshape(-1, len(y))
    middles = (np.arange(len(y)) + 0.5) * dx
    offset = np.linspace(-0.5, 0.5, 41)
    chord = np.sqrt(np.maximum(0.25 - offset**2, 0))
    edges = np.arange(0, t[-1], 0.01)
    out = []
    for sensor in dam.SENSORS:
        at = np.clip(sensor + dam.DIAMETER * offset, middles[0], middles[-1])
        weights = np.array([np.interp(at, middles, one) @ chord for one in np.eye(len(y))]) / chord.sum()
        value = p @ weights
        total = np.concatenate([[0], np.cumsum(np.diff(t) * (value[1:] + value[:-1]) / 2)])
        out.append(np.diff(np.interp(edges, t, total)) / 0.01)
    return edges[:-1] + 0.005, np.array(out)


def rising(t, values, level):
    k = int(np.argmax(values > level))
    return float(np.interp(level, values[k - 1:k + 1], t[k - 1:k + 1]))


def quantities(folder, level):
    """Of the definitions in the README of `dam_break_vof`: name -> (unit, value)."""
    run = history(folder, level)
    t = run["t"]
    out = {}
    for name in ("front", "front_depth_2", "front_depth_5"):
        for at in (1, 1.5, 2, 2.3):
            out[f"{name}_at_{at:g}"] = H, np.interp(at, t, run[name])
    part = (t > 0.999) & (t < 2.301)
    out["front_speed"] = "(g H)^(1/2)", np.polyfit(t[part], run["front"][part], 1)[0]
    clock, p = pressures(folder, level)
    start = rising(clock, p[0], 0.1)
    out["arrival"] = TIME, start
    reached = [at for at in (2, 3, 4, 5) if t[-1] > at - 1e-6]
    for k in range(4):
        for at in reached:
            if k < 2 or at > 2:
                out[f"H{k + 1}_at_{at}"] = H, np.interp(at, t, run[f"H{k + 1}"])
    for window in (1, 2.5):
        fine = np.linspace(start, start + window, 2001)
        for k in range(4):
            if clock[-1] > start + window:
                out[f"impulse_P{k + 1}_{window:g}"] = IMPULSE, np.trapezoid(np.interp(fine, clock, p[k]), fine)
    for at in reached:
        out[f"kinetic_at_{at}"] = "M g H/2", np.interp(at, t, run["kinetic"])
    return out


def checks(folder):
    """What is known exactly, as `dam_break_vof` has it: momentum and energy at t = 2."""
    for level, courant in RUNS:
        run = history(folder / f"{level}_{courant:g}", level)
        part = run["t"] < 2.001
        t, force = run["t"][part], run["force"][part]
        force[0] = force[1]  # there is no pressure yet
        impulse = np.trapezoid(force, t)
        of = f"{dam.BOX / 2**level:.4f}", f"{courant:g}"
        yield "momentum at t = 2 over impulse of the side walls, less 1", *of, number(
            run["momentum"][part][-1] / impulse - 1), 0
        yield "energy of water and air at t = 2 over that at the release", *of, number(
            run["energy"][part][-1] / run["energy"][0]), 1


def values(folder):
    coarse, middle, fine = (quantities(folder / f"{level}_{COURANT:g}", level) for level in LEVELS)
    half = quantities(folder / f"{LEVELS[0]}_{COURANT / 2:g}", LEVELS[0])
    for name, (unit, m) in middle.items():
        c, h, f = (run[name][1] if name in run else None for run in (coarse, half, fine))
        value, error = (m, abs(m - c)) if f is None else (f, abs(f - m))
        cells = ("" if one is None else number(one) for one in (c, m, f, h))
        yield "lobovsky", name, unit, number(value), doubt(error + abs(h - c)), *cells


FIELDS = {"values": [
    ("scene", "string", "-", "as in the summary of dam_break_vof"),
    ("quantity", "string", "-", "as in the summary of dam_break_vof"),
    ("unit", "string", "-", "unit of the row"),
    ("value", "number", "see column unit", "on the finest mesh that has the number"),
    ("uncertainty", "number", "see column unit", "finest mesh less the next, plus half_step less coarse"),
    *((name, "number", "see column unit", f"cells of {dam.BOX / 2**level:.4f} H")
      for name, level in zip(("coarse", "middle", "fine"), LEVELS, strict=True)),
    ("half_step", "number", "see column unit", "on the coarse mesh at half the Courant number")],
    "checks": [
        ("check", "string", "-", "as in the checks of dam_break_vof"), ("cell", "number", "H", "side of a cell"),
        ("courant", "number", "-", "Courant number"), ("value", "number", "-", "as computed"),
        ("expected", "number", "-", "exact value")]}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=Path, required=True, help="folder of raw results")
    folder = parser.parse_args().runs
    for level, courant in RUNS:
        own = folder / f"{level}_{courant:g}"
        if not (own / "done").exists():
            dam.run(own, level, courant, ENDS[level])
            (own / "done").touch()
            print(own.name, flush=True)
    tables.write(Path(__file__).parent, FIELDS, {"values": list(values(folder)), "checks": list(checks(folder))})
