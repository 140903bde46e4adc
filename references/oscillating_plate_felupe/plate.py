"""The plate of `oscillating_plate` by felupe."""

import numpy as np

import felupe_motion

LENGTH, THICKNESS, DENSITY, YOUNG, POISSON = 0.2, 0.02, 1000.0, 2e6, 0.3975
ROOT = 1.8751040687119611  # cos q cosh q = -1


def speed_of_end(poisson=POISSON):
    """0.01 c0."""
    return 0.01 * np.sqrt(YOUNG / (3 * (1 - 2 * poisson)) / DENSITY)


def thin_plate_period(poisson=POISSON):
    bending = YOUNG * THICKNESS**3 / (12 * (1 - poisson**2))
    return 2 * np.pi * (LENGTH / ROOT) ** 2 * np.sqrt(DENSITY * THICKNESS / bending)


def mode(s):
    """First mode of a thin cantilever of length 1, 1 at the end: cosh - cos - sigma (sinh - sin), halved."""
    sigma = (np.cosh(ROOT) + np.cos(ROOT)) / (np.sinh(ROOT) + np.sin(ROOT))
    z = ROOT * s
    return (np.cosh(z) - np.cos(z) - sigma * (np.sinh(z) - np.sin(z))) / 2


def swing(law, layers, step, until, poisson=POISSON):
    def place(s, r):
        y = 0.5 * THICKNESS * np.tanh(1.4 * (2 * r - 1)) / np.tanh(1.4)
        return LENGTH * np.expm1(2.2 * s) / np.expm1(2.2), y

    bulk, shear = YOUNG / (3 * (1 - 2 * poisson)), YOUNG / (2 * (1 + poisson))
    body = felupe_motion.Body(layers, 4 * layers, place, felupe_motion.law(law, bulk, shear), DENSITY)
    body.hold(body.unit[:, 0] == 0)
    end = int(np.flatnonzero((body.unit[:, 0] == 1) & (np.abs(body.unit[:, 1] - 0.5) < 1e-12))[0])
    velocity = np.zeros(body.size)
    velocity[1::2] = speed_of_end(poisson) * mode(body.points[:, 0] / LENGTH)
    return body.move(step, until, end, velocity=velocity)
