"""Computes the tables of this folder: `python compute.py`. README.md says what."""

import csv
from pathlib import Path

import ngsolve as ng
import numpy as np

import hill
import tables
from tables import doubt, number

REYNOLDS, ORDER = (10, 50, 100), 4
MESHES = {"coarse": (0.5, 0.15, 0.02), "middle": (0.35, 0.1, 0.01), "fine": (0.25, 0.06, 0.004)}
WALL = 0.025 * np.arange(361)
UNITS = {"force": "U_b^2/H", "separation": "H", "reattachment": "H"}


def quantities(flow, re):
    """Of the definitions in the README of `periodic_hill`: name -> value."""
    pressure, shear, lid = flow.drags(re)
    out = {"force": flow.fields[2], "hill_pressure_drag": pressure, "hill_shear_drag": shear, "lid_shear_drag": lid}
    turns = sorted(flow.turns(re))
    if turns:
        out["separation"], out["reattachment"] = turns[:2]
    wall = flow.shear(re, WALL)
    out["hill_shear_max"], out["hill_shear_min"] = wall.max(), wall.min()
    return out


def unit(name):
    return UNITS.get(name, "rho U_b^2 H" if name.endswith("drag") else "rho U_b^2")


def profiles(flow, re):
    """Root mean square and greatest distance of u and v from profiles.csv of `periodic_hill`."""
    with open(Path(__file__).parent / "../periodic_hill/profiles.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if float(row["re"]) == re]
    x, y = (np.array([float(row[name]) for row in rows]) for name in "xy")
    velocity = flow.fields[0](flow.mesh(x, y))
    for k, name in enumerate("uv"):
        apart = np.abs(velocity[:, k] - [float(row[name]) for row in rows])
        yield name, np.sqrt((apart**2).mean()), apart.max()


def main():
    numbers, checks = {}, []
    for name, sizes in MESHES.items():
        flow = hill.Flow(hill.mesh(*sizes), ORDER)
        for re in REYNOLDS:
            flow.solve(re)
            found = numbers[re, name] = quantities(flow, re)
            print(name, re, found, flush=True)
            walls = sum(found[f"{wall}_drag"] for wall in ("hill_pressure", "hill_shear", "lid_shear"))
            checks.append(("drag of the walls, integrated, over force times area, less 1", re, name, flow.mesh.ne,
                           number(walls / (found["force"] * flow.area) - 1, 3), "0"))
            if name == "fine":
                for field, rms, most in profiles(flow, re):
                    checks += [(f"{what} distance of {field} from the profiles of periodic_hill [U_b]", re, name,
                                flow.mesh.ne, number(value, 3), "0")
                               for what, value in (("root mean square", rms), ("greatest", most))]
    rows = []
    for re in REYNOLDS:
        coarse, middle, fine = (numbers[re, name] for name in MESHES)
        for name, value in fine.items():
            rows.append((re, name, unit(name), f"{value:.8f}", doubt(abs(value - middle[name]), 8),
                         *(f"{run[name]:.8f}" for run in (coarse, middle, fine))))
    tables.write(Path(__file__).parent, FIELDS, {"values": rows, "checks": checks})


FIELDS = {
    "values": [
        ("re", "integer", "-", "Reynolds number U_b H/nu"),
        ("quantity", "string", "-", "as in the summary of periodic_hill"),
        ("unit", "string", "-", "unit of the row"),
        ("value", "number", "see column unit", "on the fine mesh"),
        ("uncertainty", "number", "see column unit", "fine less middle mesh"),
        *((name, "number", "see column unit", f"on triangles of {a} H, {b} H at the hill, {c} H at its kinks")
          for name, (a, b, c) in MESHES.items())],
    "checks": [
        ("check", "string", "-", "what is checked"),
        ("re", "integer", "-", "Reynolds number"),
        ("mesh", "string", "-", "coarse, middle or fine"),
        ("triangles", "integer", "-", "of the mesh"),
        ("value", "number", "see column check", "as computed"),
        ("expected", "number", "see column check", "what it should be")],
}

if __name__ == "__main__":
    ng.SetNumThreads(1)
    main()
