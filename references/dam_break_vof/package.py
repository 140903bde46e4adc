"""Columns of the tables."""

LENGTH, TIME, PRESSURE, ENERGY = "H", "(H/g)^(1/2)", "rho g H", "M g H/2"
SCENE = ("scene", "string", "-", "lobovsky, martin_moyce or square: see the README")
MESH = ("mesh", "integer", "-", "cells along the shorter side of the column")
QUANTITY = [
    ("quantity", "string", "-", "what; the README lists the names"),
    ("unit", "string", "-", "unit of the row"),
]

CURVES = [
    ("front", LENGTH, "foremost point with half of water below 0.25 H, from the back wall"),
    ("front_depth_2", LENGTH, "foremost x where the water below 0.25 H is 0.02 H deep, from the back wall"),
    ("front_depth_5", LENGTH, "the same for a depth of 0.05 H"),
    (
        "height",
        LENGTH,
        "depth at 0.2 of the width of the column from the back wall, averaged with a hat function "
        "of half-width 0.05 of it",
    ),
    ("height_wall", LENGTH, "depth in the column of cells at the back wall"),
    (
        "kinetic",
        ENERGY,
        "kinetic energy of the water; M g H/2 is the potential energy of the column as released",
    ),
    ("potential", ENERGY, "potential energy of the water in the tank, over the floor"),
    ("lost", "water", "share of the water that has left the tank over the rim"),
]

PROBES = ("0.300", "0.865", "1.114", "1.3625")
LEVELS = [
    (f"H{k + 1}", LENGTH, f"depth of all water at {x} m from the back wall") for k, x in enumerate(PROBES)
]
LEVELS += [
    (f"top_H{k + 1}", LENGTH, f"height of the topmost point with half of water at {x} m from the back wall")
    for k, x in enumerate(PROBES)
]
HEIGHTS = (3, 15, 30, 80)
SENSORS = [
    (f"P{k + 1}", PRESSURE, f"pressure over the disk of the sensor {y} mm over the floor")
    for k, y in enumerate(HEIGHTS)
]


def with_doubt(columns):
    """Each column and its uncertainty."""
    for name, unit, description in columns:
        yield name, "number", unit, description
        yield f"{name}_uncertainty", "number", unit, f"uncertainty of {name}, see uncertainty"


TABLES = {
    "series": [SCENE, ("t", "number", TIME, "time since the release"), MESH, *with_doubt(CURVES)],
    "levels": [("t", "number", TIME, "time since the release"), MESH, *with_doubt(LEVELS)],
    "pressure": [
        ("t", "number", TIME, "middle of the block of 0.01 that the row is the mean of"),
        MESH,
        *with_doubt(SENSORS),
    ],
    "summary": [SCENE, *QUANTITY]
    + [
        ("value", "number", "see column unit", "on the finest mesh that has the number"),
        ("uncertainty", "number", "see column unit", "of value, from meshes and time step"),
        ("mesh", "integer", "-", "of value: cells along the shorter side of the column"),
        ("extrapolated", "number", "see column unit", "Richardson's, empty where the meshes show no order"),
        ("order", "number", "-", "observed order of the three meshes, empty where there is none"),
        ("coarse", "number", "see column unit", "on the coarse mesh: 30 cells, 20 of the columns"),
        ("middle", "number", "see column unit", "on the middle mesh: 60 cells, 40 of the columns"),
        ("fine", "number", "see column unit", "on the finest mesh: 120 cells, 80 of the columns"),
    ],
    "spread": [
        SCENE,
        ("variant", "string", "-", "mules, tension, double_step or high_rim: see the README"),
        MESH,
        *QUANTITY,
        ("value", "number", "see column unit", "of the variant on that mesh"),
        ("less_base", "number", "see column unit", "less that of the base run on the same mesh"),
    ],
    "checks": [
        ("check", "string", "-", "what is checked"),
        ("scene", "string", "-", "lobovsky, martin_moyce, square, or rest: a tank filled to H"),
        MESH,
        ("value", "number", "see column check", "as computed"),
        ("expected", "number", "see column check", "exact"),
    ],
}
