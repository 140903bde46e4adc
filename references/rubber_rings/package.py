"""The columns of the tables."""

ENERGY, FORCE, IMPULSE, TIME = "rho c0^2 L^2", "rho c0^2 L", "rho c0 L^2", "L/c0"

RUN = [
    ("speed", "number", "c0", "initial speed V of the ring towards the plane"),
    ("law", "string", "-", "constitutive law: hencky, neo_hookean, saint_venant or jaumann"),
]

CURVES = [
    ("x_c", "L", "distance of the centre of mass from the plane"),
    ("v_c", "c0", "velocity of the centre of mass, away from the plane"),
    ("width", "L", "outer extent across the plane: greatest less least x of the ring"),
    ("height", "L", "outer extent along the plane: twice the greatest y of the ring"),
    ("gap", "L", "least distance of the ring from the plane; negative: penetration"),
    ("pole_gap", "L", "distance from the plane of the outer point at y = 0 that faces it"),
    ("hole", "L", "distance of the two inner points at y = 0; the faces of the hole meet at 0"),
    ("force", FORCE, "contact force on the whole ring, mean over about one time unit"),
    ("impulse", IMPULSE, "impulse of the contact on the whole ring since t = 0; its uncertainty is that of "
                         "v_c times the mass 7 pi"),
    ("kinetic", ENERGY, "kinetic energy of the whole ring"),
    ("strain", ENERGY, "strain energy of the whole ring"),
]

TOUCHES = [
    ("first_touch", TIME, "first touch of the phase"),
    ("impulse_1", TIME, "time when 1 % of the impulse of the phase has passed"),
    ("impulse_50", TIME, "time when 50 % of the impulse of the phase has passed"),
    ("impulse_99", TIME, "time when 99 % of the impulse of the phase has passed"),
    ("last_touch", TIME, "last touch of the phase"),
    ("impulse", IMPULSE, "impulse of the phase on the whole ring"),
    ("greatest_force", FORCE, "greatest force as in column force of series.csv"),
]

QUANTITY = [
    ("quantity", "string", "-", "t_ before a name: the time of that extreme; the README lists the names"),
    ("unit", "string", "-", "unit of the row"),
]


def with_doubt(columns, without=()):
    for name, unit, description in columns:
        yield name, "number", unit, description
        if name not in without:
            yield f"{name}_uncertainty", "number", unit, f"uncertainty of {name}, see uncertainty"


TABLES = {
    "series": RUN + [("t", "number", TIME, "time")] + list(with_doubt(CURVES, ["impulse"])),
    "summary": RUN + QUANTITY + [
        ("value", "number", "see column unit", "on the finest mesh"),
        ("uncertainty", "number", "see column unit", "of value"),
        ("extrapolated", "number", "see column unit", "Richardson's, empty where the meshes show no order"),
        ("order", "number", "-", "observed order of the three meshes"),
        ("coarse", "number", "see column unit", "on the coarse mesh"),
        ("middle", "number", "see column unit", "on the middle mesh"),
        ("fine", "number", "see column unit", "on the finest mesh"),
        ("shared", "number", "see column unit", "hencky, 16 elements across the thickness"),
        ("half_step", "number", "see column unit", "the same with half the time step"),
        ("rigid_contact", "number", "see column unit", "the same with rigid contact instead of the penalty"),
        ("range_of_starts", "number", "see column unit", "greatest less least of six runs whose starts "
         "differ by 1e-12 L, hencky, 8 elements"),
    ],
    "phases": RUN + [("phase", "integer", "-", "number of the contact phase")] + list(with_doubt(TOUCHES)),
    "laws": RUN + [("mesh", "integer", "-", "elements across the thickness")] + QUANTITY + [
        ("value", "number", "see column unit", "on that mesh, empty for a _greatest_difference"),
        ("less_hencky", "number", "see column unit", "less that of hencky on the same mesh; for a "
         "_greatest_difference the greatest over time of the magnitude"),
    ],
    "outlines": RUN + [
        ("mesh", "integer", "-", "elements across the thickness"),
        ("t", "number", TIME, "time"),
        ("face", "string", "-", "outer or inner: the face of the ring that the point lies on"),
        ("x", "number", "L", "distance of the point from the plane"),
        ("y", "number", "L", "height of the point; rows go from the far pole at y = 0 to the near one, and the "
         "other half of the ring is the mirror image"),
    ],
    "checks": [
        ("check", "string", "-", "what is checked"),
        ("speed", "number", "c0", "initial speed, empty for a check without collision"),
        ("law", "string", "-", "constitutive law, empty if the check names it or needs none"),
        ("mesh", "integer", "-", "elements across the thickness"),
        ("value", "number", "see column check", "as computed, in units of the ring"),
        ("expected", "number", "see column check", "exact, empty for a mere statement"),
    ],
}
