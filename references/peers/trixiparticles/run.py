"""Hands in what the authors of TrixiParticles.jl committed: python run.py CHECKOUT [SCHEME ROWS]

Their beam is the cantilever of Turek & Hron with the law of St. Venant and Kirchhoff, so the problem is that of the
variant `lagrangian-saint-venant`; the file holds the path of the end. Their dam break is the column in the tank of
Lobovsky et al., twice as large; the file holds the x of the foremost particle. There are no particles and no times.
"""
import json, os, sys

import numpy as np

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import Problem, describe, value

problem = Problem()
folder, end = os.path.join(sys.argv[1], "validation"), value(problem.json["end"])
spec = problem.json["spec"]["settings"]


def read(path):
    with open(os.path.join(folder, path)) as file:
        return json.load(file)


def write(names, times, *columns):
    with open("curve.csv", "w") as file:
        file.write(",".join(["t[s]", *(f"{name}[m]" for name in names)]) + "\n")
        for t, *row in zip(times, *columns):
            if t <= end * (1 + 1e-9):
                file.write(",".join(repr(number) for number in (t, *row)) + "\n")


if len(sys.argv) == 2:
    layers = spec["n"]
    found = read(f"oscillating_beam_2d/validation_reference_{layers}.json")
    x, y = (found[f"deflection_{axis}_structure_1"] for axis in "xy")
    write("xy", x["time"], x["values"], y["values"])
    scheme, settings = "total Lagrangian", {"layers": layers}
    changed = "the outermost particles are on the faces of the bar"
else:
    kind, rows = sys.argv[2], int(sys.argv[3])  # of the height
    found = read(f"dam_break_2d/validation_reference_{kind}_{rows}.json")
    front = found["max_x_coord_fluid_1"]
    size = spec["height"] / 0.6  # of their column
    places = [size * (x + 0.3 / rows) for x in front["values"]]  # half a spacing before the particle
    times = size**0.5 * np.array(front["time"])
    write(["front"], problem.times, np.interp(problem.times, times, places).tolist())
    scheme, settings = f"{kind.upper()}, H/dx = {rows}", {"H/dx": rows}
    changed = "sound speed 50 (g H)^(1/2); spray counts as front"
meta = found["meta"]
method = {"code": meta.get("simulation_info", meta)["solver_name"], "version": "commit a720b1d", "division": "open",
          "scheme": scheme, "settings": settings, "changed": changed}
describe(method, dict.fromkeys(("machine", "threads", "seconds", "steps", "interactions"), "unknown"))
