"""The bar of the case `cantilever`, by finite elements: SI units, per unit of depth.

Shape, material and the larger load are those of the test CSM3 of Turek and Hron (2006), whose bar is
clamped to a cylinder of radius RADIUS; that of the case is clamped to a straight wall.
"""

import functools

import numpy as np

import beam
import plane_strain

LENGTH, THICKNESS = 0.35, 0.02
DENSITY, YOUNG, POISSON = 1000.0, 1.4e6, 0.4
SOLID = plane_strain.Material.from_young(DENSITY, YOUNG, POISSON)
LAWS = ("saint_venant", "neo_hookean", "hencky")
LARGE, SMALL = 2.0, 0.2
UNTIL = 4.0
LAYERS = (5, 10, 20)  # particles through the thickness of the case
RADIUS = 0.05


@functools.cache
def body(layers, radius=None):
    return beam.Beam(SOLID, LENGTH, THICKNESS, layers, radius)


def columns():
    """Distance from the wall and heights: the middle of the end, then the last columns of LAYERS."""
    yield LENGTH, [0.0]
    for layers in LAYERS:
        dx = THICKNESS / layers
        yield LENGTH - dx / 2, [(k + 0.5) * dx - THICKNESS / 2 for k in range(layers)]


def run(law, gravity, layers, step, radius=None, until=UNTIL):
    """From rest. Displacements of the places of `columns`; with an arc, of the middle of the end only."""
    bar = body(layers, radius)
    if radius is None:
        stations = [bar.station(x, heights) for x, heights in columns()]
    else:
        middle = np.zeros(bar.mass.shape)
        middle[layers, -1] = 1
        stations = [middle]
    result = beam.swing(bar, plane_strain.LAWS[law](SOLID), step, until, stations, gravity=gravity)
    return dict(result, path=result["path"] - result["path"][0])


def sag(layers, law="saint_venant", gravity=2.0, radius=None, young=YOUNG):
    """Displacement of the middle of the end at rest under its weight."""
    bar = body(layers, radius)
    solid = plane_strain.Material.from_young(DENSITY, young, POISSON)
    x = beam.at_rest(bar, plane_strain.LAWS[law](solid), gravity)
    return (x - bar.x0)[:, layers, -1]


# --- Numbers of one run -------------------------------------------------------------------------------

def extremes(y):
    """Greatest and least value, by a parabola through three samples where it is not at an end."""
    for n in (np.argmax(y), np.argmin(y)):
        if n in (0, len(y) - 1):
            yield y[n]
            continue
        a, b, c = y[n - 1 : n + 2]
        yield b - (a - c) ** 2 / 8 / (a - 2 * b + c)


def falls(t, y, level):
    """Times at which y passes the level downwards."""
    k = np.flatnonzero((y[:-1] > level) & (y[1:] <= level))
    return t[k] + (t[k + 1] - t[k]) * (y[k] - level) / (y[k] - y[k + 1])


def summary(t, x, y):
    """Quantities of summary.csv of a place: name -> value; the README says what they are."""
    out = {}
    for name, path in (("x", x), ("y", y)):
        high, low = extremes(path)
        out[f"mean_{name}"], out[f"amplitude_{name}"] = 0.5 * (high + low), 0.5 * (high - low)
    times = falls(t, y, out["mean_y"])
    out["frequency"] = (len(times) - 1) / (times[-1] - times[0])
    whole = np.linspace(times[0], times[-1], 8001)[:-1]
    turn = np.exp(2j * np.pi * out["frequency"] * whole)
    for name, path in (("x", x), ("y", y)):
        values = np.interp(whole, t, path)
        out[f"average_{name}"], out[f"harmonic_{name}"] = values.mean(), 2 * abs((values * turn).mean())
    out["first_fall"], out["last_fall"] = times[0], times[-1]
    first = t < times[1]
    out["first_least_y"] = list(extremes(y[first]))[1]
    return out
