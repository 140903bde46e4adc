"""The columns of the tables."""

SPEED, SHEAR = "U_b", "rho U_b^2"
RE = ("re", "number", "-", "Reynolds number U_b H/nu")


def value(name, unit, description):
    yield name, "number", unit, description
    yield f"{name}_uncertainty", "number", unit, f"uncertainty of {name}, see uncertainty"


TABLES = {
    "profiles": [
        RE,
        ("x", "number", "H", "station, from the crest along the flow"),
        ("y", "number", "H", "height over the foot of the hill"),
        *value("u", SPEED, "velocity along x"),
        *value("v", SPEED, "velocity along y"),
    ],
    "starts": [
        RE,
        ("x", "number", "H", "station, from the crest along the flow"),
        ("s", "number", "-", "share of the section below, from hill to lid"),
        ("u", "number", SPEED, "velocity along x, on the middle mesh: to start from, not to compare with"),
        ("v", "number", SPEED, "velocity along y, likewise"),
    ],
    "wall": [
        RE,
        ("x", "number", "H", "place, from the crest along the flow"),
        ("h", "number", "H", "height of the hill there"),
        *value("hill_shear", SHEAR, "shear stress of the fluid on the hill, along its tangent with x"),
        *value("lid_shear", SHEAR, "shear stress of the fluid on the lid, along x"),
    ],
    "line": [
        RE,
        ("x", "number", "H", "place, from the crest along the flow"),
        ("y", "number", "H", "height of the line between bubble and stream: no net flux below it"),
    ],
    "summary": [
        RE,
        ("quantity", "string", "-", "what; the README lists the names"),
        ("unit", "string", "-", "unit of the row"),
        ("value", "number", "see column unit", "extrapolated; where the meshes show no order, on the finest"),
        ("uncertainty", "number", "see column unit", "of value"),
        ("order", "number", "-", "observed order of the three finest meshes"),
        ("coarse", "number", "see column unit", "on the coarse mesh"),
        ("middle", "number", "see column unit", "on the middle mesh"),
        ("fine", "number", "see column unit", "on the finest mesh"),
    ],
    "checks": [
        ("check", "string", "-", "what is checked"),
        ("re", "number", "-", "Reynolds number, empty where there is no flow"),
        ("mesh", "integer", "-", "level: 66 x 12 elements times 2^level each way, empty for none"),
        ("value", "number", "see column check", "as computed"),
        ("expected", "number", "see column check", "exact, empty for a mere statement"),
    ],
}
