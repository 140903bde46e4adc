"""Checks of hill.py against what is known exactly. Rows of checks.csv: check, re, mesh, value, expected."""

import numpy as np

import hill

SECTIONS = (0.05, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)


def geometry():
    """The six pieces meet with their slopes, the hill ends at 0, and it is 1 high."""
    eps = 1e-9
    jump = slope = 0.0
    for k, at in enumerate(hill.BREAKS[1:-1]):
        a, b = (np.polynomial.Polynomial(hill.PIECES[i]) for i in (k, k + 1))
        jump = max(jump, abs(a(at) - b(at)))
        slope = max(slope, abs(a.deriv()(at) - b.deriv()(at)))
    yield "largest jump of h at a break [mm]", "", "", jump, 0.0
    yield "largest jump of dh/dx at a break", "", "", slope, 0.0
    yield "height of the crest", "", "", float(hill.Hill()(np.array(0.0))[0]), 1.0
    yield "height at the foot, 54 mm", "", "", float(hill.Hill()(np.array(54 / 28 - eps))[0]), 0.0
    below, above = (float(hill.Hill()(np.array(hill.KINK / 28 + d))[1]) for d in (-eps, eps))
    yield "kink that the clip at 28 mm leaves in dh/dx", "", "", above - below, ""


def flat(level):
    """Without the hill the flow is Poiseuille's, which the elements hold exactly."""
    flow, re = hill.Flow(level, hill.Hill(0.0)), 50.0
    flow.solve(re)
    x, s = (a.ravel() for a in np.meshgrid(np.linspace(0.1, 8.9, 23), np.linspace(0.01, 0.99, 33)))
    force = 12 * hill.FLUX / (re * hill.LID**3)
    y = s * hill.LID
    parabola = 0.5 * re * force * y * (hill.LID - y)
    error = np.abs(flow.at(flow.u, x, s) - parabola).max() / parabola.max()
    yield "error of u without hill over the largest u", re, level, error, 0.0
    yield "largest v without hill", re, level, np.abs(flow.at(flow.v, x, s)).max(), 0.0
    yield "force without hill over that of Poiseuille flow, less 1", re, level, flow.force / force - 1, 0.0


def creeping(level):
    """At Re -> 0 the flow is its own mirror image about the crest, and the force is odd in the flux."""
    flow, tiny = hill.Flow(level), 1e-6
    flow.solve(tiny)
    x, s = (a.ravel() for a in np.meshgrid(np.linspace(0.03, 4.4, 29), np.linspace(0.01, 0.99, 33)))
    u, v = (flow.at(f, x, s) for f in (flow.u, flow.v))
    u_mirror, v_mirror = (flow.at(f, hill.LENGTH - x, s) for f in (flow.u, flow.v))
    yield "largest |u(x) - u(9 - x)| at Re -> 0", tiny, level, np.abs(u - u_mirror).max(), 0.0
    yield "largest |v(x) + v(9 - x)| at Re -> 0", tiny, level, np.abs(v + v_mirror).max(), 0.0
    forward = flow.force * tiny
    flow.solve(tiny, -hill.FLUX)
    yield "force of the reversed flow over that of the flow at Re -> 0", tiny, level, \
        flow.force * tiny / forward, -1.0
    excess = []
    for re in (1.0, 0.5):
        flow.solve(re)
        excess.append(flow.force * re / forward - 1)
    yield "excess of Re times force over its limit, at Re 0.5 over at Re 1", 0.5, level, \
        excess[1] / excess[0], 0.25


def balances(flow, re):
    """What holds of every solution."""
    level, driven = flow.level, flow.force * flow.area
    drag = flow.drag(re)
    yield "drag of the walls over force times area", re, level, sum(drag) / driven, 1.0
    power = flow.dissipation(re) / (flow.force * hill.FLUX * hill.LENGTH)
    yield "dissipation over power of the force", re, level, power, 1.0
    # Half of the domain, where convection carries momentum through the ends.
    middle = 0.5 * hill.LENGTH
    part = flow.force * half_area() - sum(flow.drag(re, middle))
    gained = flow.momentum(middle, re) - flow.momentum(0.0, re)
    yield "momentum gained from crest to trough, less force, plus drag, over drag of the walls", re, level, \
        (gained - part) / driven, 0.0
    fluxes = np.array([flow.flux(x) for x in SECTIONS])
    yield "largest error of the flux through ten sections", re, level, \
        np.abs(fluxes / hill.FLUX - 1).max(), 0.0
    columns = flow.column_fluxes()
    yield "largest error of the mean flux of a column of elements", re, level, \
        np.abs(columns / hill.FLUX - 1).max(), 0.0


def half_area():
    x, weight = hill.gauss(hill.ENDS, 5)
    return weight @ (hill.LID - hill.Hill()(x)[0])
