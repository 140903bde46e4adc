"""Checks of the runs against what is known exactly. Rows of checks.csv."""

import numpy as np

import dam
import read

ENERGIES = ("kinetic", "potential", "kinetic_air")


def momentum_gap(kept, until):
    """Momentum along x less impulse of the side walls up to a time, over that impulse."""
    inside = kept["t"] < until + 1e-6
    force = (kept["force_back"] - kept["force_far"])[inside]
    # The middle of each interval by a parabola through three samples: Simpson's rule.
    assert force.size % 2 == 1
    step = kept["t"][1] - kept["t"][0]
    impulse = step / 3.0 * (force[0] + force[-1] + 4.0 * force[1::2].sum() + 2.0 * force[2:-1:2].sum())
    return kept["momentum"][inside][-1] / impulse - 1.0


def rows(folder):
    """check, scene, mesh, value, expected."""
    still = read.load(folder, dam.Run("rest", dam.REST.meshes[0]))
    if still is not None:
        n, air = dam.REST.meshes[0], dam.DENSITY["air"] / dam.DENSITY["water"]
        yield "largest kinetic energy of water at rest [M g H/2]", "rest", n, still["kinetic"].max(), 0.0
        for k in range(1, 4):
            depth = 1.0 - dam.SENSORS[k] / dam.REST.height
            expected = depth + air * (dam.REST.rim / dam.REST.height - 1.0)
            yield f"pressure on P{k + 1} of water at rest [rho g H]", "rest", n, still["p"][k][-1], expected
    for scene in dam.SCENES.values():
        until = 2.0 if scene.is_tank else 1.5
        released = dam.released_force(scene.width, scene.height)
        for n, kept in read.meshes(folder, scene.name):
            first = kept["force_back"][1:3]
            yield (
                "force on the back wall just after the release over the weight of the column",
                scene.name,
                n,
                (4.0 * first[0] - first[1]) / 3.0,
                released,
            )
            yield (
                f"momentum at t = {until:g} over impulse of the side walls, less 1",
                scene.name,
                n,
                momentum_gap(kept, until),
                0.0,
            )
            energy = sum(np.interp(until, kept["t"], kept[name]) for name in ENERGIES)
            yield (
                f"energy of water and air at t = {until:g} over that at the release",
                scene.name,
                n,
                energy,
                1.0,
            )
            whole = kept["water"][np.maximum.accumulate(kept["run_up"]) < 1.9]
            yield (
                "largest change of the volume of the water before any reaches the rim",
                scene.name,
                n,
                np.abs(whole - 1.0).max(),
                0.0,
            )
