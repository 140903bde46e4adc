"""The columns of the tables."""

LAW = ("law", "string", "-", "constitutive law: hencky, neo_hookean, saint_venant or jaumann")
MESH = ("mesh", "integer", "-", "elements across the thickness")


def columns(layers):
    for axis, text in (("x", "along the plate, away from the clamp"), ("y", "across it")):
        about = f"mean of the last column of particles of a plate of {layers} layers"
        yield f"{axis}_{layers}", "number", "m", f"displacement {text}, {about}: at half a spacing from the end"


TABLES = {
    "series": [
        LAW,
        ("t", "number", "s", "time"),
        ("x", "number", "m", "displacement of the middle of the end along the plate, away from the clamp"),
        ("x_uncertainty", "number", "m", "uncertainty of x, see uncertainty"),
        ("y", "number", "m", "displacement of the middle of the end across the plate"),
        ("y_uncertainty", "number", "m", "uncertainty of y, see uncertainty"),
        *columns(5), *columns(10), *columns(20),
    ],
    "summary": [
        LAW,
        ("layers", "integer", "-", "place: last column of particles of a plate of so many layers; empty: the "
         "middle of the end"),
        ("quantity", "string", "-", "the README lists the names"),
        ("unit", "string", "-", "unit of the row"),
        ("value", "number", "see column unit", "on the finest mesh"),
        ("uncertainty", "number", "see column unit", "of value"),
        ("extrapolated", "number", "see column unit", "Richardson's, empty where the meshes show no order"),
        ("order", "number", "-", "observed order of the three meshes"),
        ("coarse", "number", "see column unit", "on 4 elements across the thickness"),
        ("middle", "number", "see column unit", "on 8"),
        ("fine", "number", "see column unit", "on 16"),
        ("whole_step", "number", "see column unit", "on 4"),
        ("half_step", "number", "see column unit", "on 4 with half the time step"),
    ],
    "clamps": [
        ("layers", "integer", "-", "particles through the thickness"),
        ("behind", "number", "m", "half a spacing: the plate is clamped so far behind x = 0"),
        ("period", "number", "s", "first period of the last column, hencky on 8 elements"),
        ("period_change", "number", "-", "over that of a plate that is clamped at x = 0, less 1"),
        ("extreme_1", "number", "m", "first extreme of the last column"),
        ("extreme_1_change", "number", "-", "over that of a plate that is clamped at x = 0, less 1"),
    ],
    "checks": [
        ("check", "string", "-", "what is checked, and what is expected"),
        ("law", "string", "-", "constitutive law, empty if the check needs none"),
        MESH,
        ("step", "number", "s", "time step, empty if the check needs none"),
        ("value", "number", "see column check", "as computed"),
        ("expected", "number", "see column check", "exact or of the other way"),
    ],
}
