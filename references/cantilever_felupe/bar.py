"""The bar of `cantilever` by felupe, clamped to a straight wall, or to the cylinder of the test of Turek and Hron."""

import numpy as np

import felupe_motion

LENGTH, THICKNESS, DENSITY, RADIUS = 0.35, 0.02, 1000.0, 0.05


def bar(layers, law, young=1.4e6, poisson=0.4, arc=False):
    def place(s, r):
        y = 0.5 * THICKNESS * np.tanh(1.4 * (2 * r - 1)) / np.tanh(1.4)
        x = LENGTH * np.expm1(2.2 * s) / np.expm1(2.2)
        start = np.sqrt(RADIUS**2 - y**2) - RADIUS if arc else 0 * y
        return start + (LENGTH - start) * x / LENGTH, y

    bulk, shear = young / (3 * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    body = felupe_motion.Body(layers, 6 * layers, place, felupe_motion.law(law, bulk, shear), DENSITY)
    body.hold(body.unit[:, 0] == 0)
    body.end = int(np.flatnonzero((body.unit[:, 0] == 1) & (np.abs(body.unit[:, 1] - 0.5) < 1e-12))[0])
    return body


def weight(body, gravity):
    down = np.zeros(body.size)
    down[1::2] = -gravity
    return body.mass @ down


def sag(layers, young, gravity=2.0, arc=True):
    body = bar(layers, "saint_venant", young, arc=arc)
    u = None
    for share in (0.25, 0.5, 0.75, 1.0):
        u = body.at_rest(share * weight(body, gravity), u)
    return u.reshape(-1, 2)[body.end]
