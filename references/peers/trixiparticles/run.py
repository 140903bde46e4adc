"""Hands in what the authors of TrixiParticles.jl committed of their oscillating beam: python run.py CHECKOUT

The beam is the cantilever of Turek & Hron with the law of St. Venant and Kirchhoff, so the problem is that of the
variant `lagrangian-saint-venant`. The files hold the path of the end, and neither particles nor run times.
"""
import json, os, sys

sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
from common import describe

with open("problem.json") as file:
    problem = json.load(file)
layers, end = problem["spec"]["settings"]["n"], problem["end"]["value"]
path = f"validation/oscillating_beam_2d/validation_reference_{layers}.json"
with open(os.path.join(sys.argv[1], path)) as file:
    found = json.load(file)
x, y = (found[f"deflection_{axis}_structure_1"] for axis in "xy")
with open("curve.csv", "w") as file:
    file.write("t[s],x[m],y[m]\n")
    for t, *place in zip(x["time"], x["values"], y["values"]):
        if t <= end * (1 + 1e-9):
            file.write(f"{t!r},{place[0]!r},{place[1]!r}\n")
method = {"code": found["meta"]["solver_name"], "version": "commit a720b1d", "division": "open",
          "scheme": "total Lagrangian", "settings": {"layers": layers},
          "changed": "the outermost particles are on the faces of the bar"}
describe(method, dict.fromkeys(("machine", "threads", "seconds", "steps", "interactions"), "unknown"))
