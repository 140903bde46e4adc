"""Writes the tables and lists them in datapackage.json, whose texts stay; checks both as the loader does."""

import csv
import hashlib
import io
import json
from importlib.metadata import version

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
        ("variant", "string", "-", "mules, tension, half_step or high_rim: see the README"),
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


def text(value):
    """A cell of a number that is not yet text."""
    return f"{value:.6g}" if isinstance(value, float) else value


def write(folder, tables):
    """Writes the tables and the resources of datapackage.json."""
    resources = []
    for name, rows in tables.items():
        fields = [
            dict(name=field, type=kind, unit=unit, description=about)
            for field, kind, unit, about in TABLES[name]
        ]
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow([field["name"] for field in fields])
        writer.writerows([[text(value) for value in row] for row in rows])
        path = f"{name}.csv"
        (folder / path).write_text(out.getvalue(), newline="\n")
        schema = {"fields": fields, "missingValues": [""]}
        resources.append({"name": name, "path": path, "hash": "", "schema": schema})
    description = folder / "datapackage.json"
    package = json.loads(description.read_text())
    for used in ("numpy", "scipy"):
        assert f"{used} {version(used)}" in package["method"], f"the method names another version of {used}"
    package["resources"] = resources
    for resource in resources:
        digest = hashlib.sha256((folder / resource["path"]).read_bytes()).hexdigest()
        resource["hash"] = f"sha256:{digest}"
    description.write_text(json.dumps(package, indent=2, ensure_ascii=False) + "\n")
    check(folder)


def check(folder):
    """The rules of validation/base/src/reference.rs."""
    package = json.loads((folder / "datapackage.json").read_text())
    assert package["name"] == folder.resolve().name
    allowed = {
        "profile",
        "name",
        "title",
        "description",
        "licenses",
        "sources",
        "resources",
        "method",
        "uncertainty",
        "caveats",
        "errata",
    }
    assert set(package) <= allowed, set(package) - allowed
    assert all(package[key].strip() for key in ("title", "description", "method", "uncertainty"))
    assert package["licenses"] and all(one["name"] for one in package["licenses"])
    assert package["sources"] and all(
        one["title"] and (one.get("doi") or one.get("place")) for one in package["sources"]
    )
    for resource in package["resources"]:
        content = (folder / resource["path"]).read_bytes()
        assert resource["hash"] == "sha256:" + hashlib.sha256(content).hexdigest()
        fields = resource["schema"]["fields"]
        assert all(field["unit"].strip() and field["description"].strip() for field in fields)
        header, *rows = csv.reader(io.StringIO(content.decode()))
        assert header == [field["name"] for field in fields] and rows, resource["path"]
        for row in rows:
            assert len(row) == len(fields), row
            for field, cell in zip(fields, row, strict=True):
                if field["type"] == "number" and cell:
                    assert abs(float(cell)) < float("inf"), (resource["path"], row)
                if field["type"] == "integer" and cell:
                    int(cell)
        print(f"{resource['path']}: {len(rows)} rows, {len(content)} bytes")
