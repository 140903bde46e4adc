"""The columns of the tables."""

RUN = [
    ("gravity", "number", "m/s^2", "acceleration of gravity, towards -y, from t = 0"),
    ("law", "string", "-", "constitutive law: saint_venant, neo_hookean or hencky"),
]

TABLES = {
    "series": RUN + [
        ("t", "number", "s", "time"),
        ("x", "number", "m", "displacement of the middle of the end along the bar, away from the wall"),
        ("x_uncertainty", "number", "m", "uncertainty of x, see uncertainty"),
        ("y", "number", "m", "displacement of the middle of the end, upwards"),
        ("y_uncertainty", "number", "m", "uncertainty of y, see uncertainty"),
    ],
    "summary": RUN + [
        ("layers", "integer", "-", "place: last column of particles of a bar of so many layers, at half a "
         "spacing from the end, mean over the layers; empty: the middle of the end"),
        ("quantity", "string", "-", "the README lists the names"),
        ("unit", "string", "-", "unit of the row"),
        ("value", "number", "see column unit", "on the fine mesh"),
        ("uncertainty", "number", "see column unit", "of value"),
        ("coarse", "number", "see column unit", "on 4 elements across the thickness"),
        ("fine", "number", "see column unit", "on 8"),
        ("half_step", "number", "see column unit", "on 4 with half the time step"),
    ],
    "checks": [
        ("check", "string", "-", "what is checked, and what is expected"),
        ("gravity", "number", "m/s^2", "acceleration of gravity, empty if the check needs none"),
        ("law", "string", "-", "constitutive law, empty if the check needs none"),
        ("mesh", "integer", "-", "elements across the thickness"),
        ("step", "number", "s", "time step, empty if the check needs none"),
        ("value", "number", "see column check", "as computed"),
        ("expected", "number", "see column check", "published, of theory or of the other way"),
    ],
}
