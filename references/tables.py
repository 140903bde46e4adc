"""Numbers as text, uncertainties, and the tables of a package with their description."""

import csv
import hashlib
import io
import json
from importlib.metadata import version

import numpy as np


def richardson(coarse, middle, fine):
    """Extrapolation and order, if the differences shrink monotonically; of order 4 at most."""
    first, second = middle - coarse, fine - middle
    if second == 0 or first / second < 1.5:
        return None, None
    ratio = first / second
    return fine + second / (min(ratio, 16) - 1), np.log2(ratio)


def widest(u, around=4):
    """Greatest uncertainty within so many rows: differences of curves vanish where they cross."""
    padded = np.pad(u, around, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * around + 1).max(axis=1)


def number(value, digits=6):
    return "" if value is None else f"{value:.{digits}g}"


def fixed(value, decimals):
    text = f"{value:.{decimals}f}"
    return text.lstrip("-") if float(text) == 0 else text


def doubt(u, decimals=None):
    """Not below half a unit of the last printed decimal."""
    return f"{u if decimals is None else max(u, 0.5 * 10.0**-decimals):.1e}"


def write(folder, described, tables):
    """Writes the tables and lists them in datapackage.json, whose texts stay; checks both."""
    resources = []
    for name, rows in tables.items():
        fields = [dict(name=field, type=kind, unit=unit, description=text)
                  for field, kind, unit, text in described[name]]
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow([field["name"] for field in fields])
        writer.writerows(rows)
        path = f"{name}.csv"
        (folder / path).write_text(out.getvalue(), newline="\n")
        schema = {"fields": fields, "missingValues": [""]}
        resources.append({"name": name, "path": path, "hash": "", "schema": schema})
    description = folder / "datapackage.json"
    package = json.loads(description.read_text())
    for line in (folder / "requirements.txt").read_text().split():
        used = line.split("==")[0]
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
    allowed = {"profile", "name", "title", "description", "grade", "licenses", "sources", "resources", "method",
               "uncertainty", "caveats"}
    assert set(package) <= allowed, set(package) - allowed
    assert all(package[key].strip() for key in ("title", "description", "method", "uncertainty"))
    assert package["licenses"] and all(one["name"] for one in package["licenses"])
    assert package["sources"] and all(one["title"] and (one.get("doi") or one.get("place"))
                                      for one in package["sources"])
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
