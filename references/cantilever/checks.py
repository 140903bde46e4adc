"""Checks of bar.py against published numbers and theory. Rows of checks.csv.

Published: the tests CSM1 to CSM3 of Turek and Hron, at rest from their finest mesh on the page of FeatFlow,
in time from their paper. Their bar is clamped to a cylinder.
"""

import numpy as np

import bar

AT_REST = {bar.YOUNG: (-7.18767e-3, -66.1023e-3), 4 * bar.YOUNG: (-0.469000e-3, -16.9739e-3)}
IN_TIME = {"mean_x": -14.305e-3, "amplitude_x": 14.305e-3, "mean_y": -63.607e-3, "amplitude_y": 65.160e-3,
           "frequency": 1.0995}


def rows():
    """check, gravity, law, mesh, step, value, expected."""
    out = []
    law, gravity = "saint_venant", 2.0
    for young, published in AT_REST.items():
        for layers in (4, 8):
            found = bar.sag(layers, radius=bar.RADIUS, young=young)
            for axis, value, expected in zip("xy", found, published, strict=True):
                name = "CSM1" if young == bar.YOUNG else "CSM2"
                check = f"{axis} of the end at rest, clamped to the cylinder, against {name} [m]"
                out.append((check, gravity, law, layers, "", value, expected))
    step = 0.005
    swing = bar.run(law, gravity, 4, step, radius=bar.RADIUS, until=10.0)
    for begin, words in ((0.0, "0 to 10 s"), (8.0, "8 to 10 s")):
        kept = swing["t"] >= begin
        found = bar.summary(swing["t"][kept], *swing["path"][kept, 0].T)
        for key, expected in IN_TIME.items():
            check = f"{key} in {words}, clamped to the cylinder, against CSM3 [m, Hz]"
            out.append((check, gravity, law, 4, step, found[key], expected))
    straight, kept = bar.run(law, gravity, 4, step), swing["t"] < bar.UNTIL + step / 2
    of = [bar.summary(straight["t"], *straight["path"][:, 0].T),
          bar.summary(swing["t"][kept], *swing["path"][kept, 0].T)]
    for key in ("average_x", "harmonic_x", "average_y", "harmonic_y", "frequency"):
        check = f"{key} in 0 to 4 s, clamped to the straight wall, expected: to the cylinder [m, Hz]"
        out.append((check, gravity, law, 4, step, of[0][key], of[1][key]))
    finest = bar.sag(16)
    for layers in (4, 8):
        check = "y of the end at rest, expected: on 16 elements [m]"
        out.append((check, gravity, law, layers, "", bar.sag(layers)[1], finest[1]))
    small = 1e-3
    thin = bar.DENSITY * small * bar.LENGTH**4 / 8 * 12 * (1 - bar.POISSON**2) / bar.YOUNG / bar.THICKNESS**2
    sheared = bar.DENSITY * small * bar.LENGTH**2 / 2 / (5 / 6 * bar.SOLID.shear)
    check = "y of the end at rest under a small weight, expected: Timoshenko's beam [m]"
    out.append((check, small, law, 8, "", bar.sag(8, gravity=small)[1], -(thin + sheared)))
    # A particle method has the last two columns: their line goes on to the end.
    body = bar.body(8)
    x = bar.beam.at_rest(body, bar.plane_strain.SaintVenant(bar.SOLID), gravity)
    for layers in bar.LAYERS:
        dx = bar.THICKNESS / layers
        last, before = ((body.station(bar.LENGTH - k * dx / 2) * x[1]).sum() for k in (1, 3))
        end = (body.station(bar.LENGTH) * x[1]).sum()
        check = f"end from the line through the last two columns of {layers} layers, at rest [m]"
        out.append((check, gravity, law, 8, "", 1.5 * last - 0.5 * before, end))
    out.append(("mass of the bar [kg/m]", "", "", 8, "", body.mass.sum(),
                bar.DENSITY * bar.LENGTH * bar.THICKNESS))
    assert np.isfinite([row[5] for row in out]).all()
    return out


if __name__ == "__main__":
    for row in rows():
        print(*row, sep=", ", flush=True)
