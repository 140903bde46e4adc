"""Measures what the authors of TrixiParticles.jl committed of their oscillating beam: python measure.py CHECKOUT

The beam is the cantilever of Turek & Hron, material of St. Venant and Kirchhoff; reference: finite elements of
`references/cantilever`. Quantities are those of the case `cantilever`, of the first 4 s. `run.py` hands the paths in.
"""
import csv, json, os, sys

import numpy as np

here = os.path.dirname(os.path.abspath(__file__))
with open(os.path.join(here, "../../cantilever/summary.csv")) as file:
    rows = [row for row in csv.DictReader(file)
            if (row["gravity"], row["law"], row["layers"]) == ("2.0", "saint_venant", "")]
exact = {row["quantity"]: float(row["value"]) for row in rows}
names = ("frequency", "average_y", "harmonic_y", "mean_y", "amplitude_y", "first_least_y")
print("| particles across | " + " | ".join(names) + " |\n|---|" + "---|" * len(names))
for count in (5, 9, 17, 33, 65):
    path = f"validation/oscillating_beam_2d/validation_reference_{count}.json"
    with open(os.path.join(sys.argv[1], path)) as file:
        series = json.load(file)["deflection_y_structure_1"]
    t, y = (np.array(series[name]) for name in ("time", "values"))
    t, y = t[t <= 4.0 + 1e-9], y[t <= 4.0 + 1e-9]

    def extreme(y, k):
        if not 0 < k < len(y) - 1:
            return y[k]
        a, b, c = y[k - 1:k + 2]
        return b - (a - c) ** 2 / (8 * (a - 2 * b + c))

    high, low = extreme(y, np.argmax(y)), extreme(y, np.argmin(y))
    found = {"mean_y": 0.5 * (high + low), "amplitude_y": 0.5 * (high - low)}
    at = np.flatnonzero((y[:-1] > found["mean_y"]) & (y[1:] <= found["mean_y"]))
    falls = t[at] + (t[at + 1] - t[at]) * (y[at] - found["mean_y"]) / (y[at] - y[at + 1])
    swing = y[t < falls[1]]
    found["first_least_y"] = extreme(swing, np.argmin(swing))
    found["frequency"] = (len(falls) - 1) / (falls[-1] - falls[0])
    times = falls[0] + (falls[-1] - falls[0]) * np.arange(8000) / 8000
    values, angle = np.interp(times, t, y), 2 * np.pi * found["frequency"] * times
    found["average_y"] = values.mean()
    found["harmonic_y"] = 2 * np.hypot((values * np.cos(angle)).mean(), (values * np.sin(angle)).mean())
    errors = [f"{100 * (found[name] / exact[name] - 1):+.2f} %" for name in names]
    print(f"| {count} | " + " | ".join(errors) + " |")
