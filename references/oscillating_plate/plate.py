"""The oscillating plate of the case `oscillating_plate`, by finite elements: SI units, per unit of depth."""

import functools

import numpy as np

import beam
import plane_strain

RUBBER = plane_strain.Material.from_young(density=1000.0, young=2e6, poisson=0.3975)
YOUNG, POISSON = 2e6, 0.3975
LENGTH, THICKNESS = 0.2, 0.02
SPEED = 0.01 * RUBBER.sound_speed  # of the tip at the start
FIRST_MODE = 1.875104068711961
UNTIL, STEP = 0.8, 5e-4
LAYERS = (5, 10, 20)  # particles through the thickness of the case


def thin_plate_period():
    k = FIRST_MODE / LENGTH
    stiffness = YOUNG * THICKNESS**2 / (12 * (1 - POISSON**2))
    return 2 * np.pi / (k**2 * np.sqrt(stiffness / RUBBER.density))


def mode(x):
    """First mode of a thin cantilever at x/L, 1 at the tip."""
    q = FIRST_MODE

    def f(x):
        z = q * x
        return ((np.cos(q) + np.cosh(q)) * (np.cosh(z) - np.cos(z))
                + (np.sin(q) - np.sinh(q)) * (np.sinh(z) - np.sin(z)))
    return f(x) / f(1.0)


def start(body, behind=0.0, speed=SPEED):
    """Velocities along y of the nodes."""
    x = body.x0[0] - behind
    return np.where(x > 0, speed * mode(x / LENGTH), 0.0)


def points(layers):
    """Distance from the clamp and heights of the last column of so many particles through the thickness."""
    dx = THICKNESS / layers
    return LENGTH - dx / 2, [(k + 0.5) * dx - THICKNESS / 2 for k in range(layers)]


@functools.cache
def body(layers, behind=0.0):
    return beam.Beam(RUBBER, LENGTH + behind, THICKNESS, layers)


def run(law, layers, step, behind=0.0, speed=SPEED, until=UNTIL):
    """One plate, clamped at x = -`behind`. Displacements of the end and of the columns of LAYERS."""
    plate = body(layers, behind)
    columns = [(LENGTH, [0.0])] + [points(n) for n in LAYERS]
    stations = [plate.station(x + behind, heights) for x, heights in columns]
    result = beam.swing(plate, plane_strain.LAWS[law](RUBBER), step, until, stations,
                        speed=start(plate, behind, speed))
    return dict(result, path=result["path"] - result["path"][0])


def explicit(law, layers, until):
    """The same by central differences: times, and displacements of the middle of the end."""
    plate, law = body(layers), plane_strain.LAWS[law](RUBBER)
    station = plate.station(LENGTH)
    spacing = min(np.diff(plate.x0[0, 0]).min(), np.diff(plate.x0[1, :, 0]).min())
    step = 0.2 * spacing / RUBBER.p_wave
    steps = int(np.ceil(until / step))
    step = until / steps
    x, v = plate.x0.copy(), np.zeros_like(plate.x0)
    v[1] = start(plate)
    v[:, :, 0] = 0
    path = np.empty((steps + 1, 2))
    for n in range(steps + 1):
        path[n] = (station * x).sum(axis=(1, 2))
        a = plate.force(x, law) / plate.mass
        law.keep()
        a[:, :, 0] = 0
        v = v + (0.5 if n == 0 else 1.0) * step * a
        x = x + step * v
    return step * np.arange(steps + 1), path - path[0]
