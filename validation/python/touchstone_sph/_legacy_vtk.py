"""Arrays of the points of a legacy ``.vtk`` file, in letters or as bytes, whose most significant byte is first."""

from __future__ import annotations

from urllib.parse import unquote

import numpy as np

#: Types of numbers, as bytes.
KINDS = {
    "double": ">f8",
    "float": ">f4",
    "char": ">i1",
    "unsigned_char": ">u1",
    "short": ">i2",
    "unsigned_short": ">u2",
    "int": ">i4",
    "unsigned_int": ">u4",
    "long": ">i8",
    "unsigned_long": ">u8",
    "vtktypeint64": ">i8",
    "vtktypeuint64": ">u8",
    "vtkIdType": ">i4",
}
#: Numbers of a point.
SIZES = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9}
#: More than these are no numbers of a file.
MOST = 1 << 28


class _Text:
    """A file between its begin and its end."""

    def __init__(self, data: bytes):
        self.data, self.at = data, 0

    def line(self) -> str:
        """The next line that is not empty; an empty text at the end."""
        while self.at < len(self.data):
            end = self.data.find(b"\n", self.at)
            end = len(self.data) if end < 0 else end
            line = self.data[self.at : end].decode("latin-1").strip()
            self.at = end + 1
            if line:
                return line
        return ""

    def word(self) -> bytes:
        rest = self.data[self.at : self.at + 256]
        word = rest.split(maxsplit=1)[0] if rest.split() else b""
        self.at += rest.find(word) + len(word)
        return word

    def numbers(self, count: int, kind: str, is_binary: bool) -> np.ndarray:
        if kind not in KINDS:
            raise ValueError(f"the type {kind} of numbers is not known; expected {', '.join(KINDS)}")
        if not 0 <= count <= MOST:
            raise ValueError(f"it says {count} numbers")
        of = np.dtype(KINDS[kind])
        if is_binary:
            part = self.data[self.at : self.at + count * of.itemsize]
            if len(part) < count * of.itemsize:
                raise ValueError("it ends before the numbers that its heads say: it was cut short")
            self.at += len(part)
            return np.frombuffer(part, of)
        if count > len(self.data):
            raise ValueError("it ends before the numbers that its heads say: it was cut short")
        words = [self.word() for _ in range(count)]
        if words and not words[-1]:
            raise ValueError("it ends before the numbers that its heads say: it was cut short")
        return np.array(words).astype(of)


def _whole(word: str) -> int:
    if not word.isdigit():
        raise ValueError(f"{word[:20]!r} is no whole number")
    return int(word)


def arrays(data: bytes) -> dict[str, np.ndarray]:
    """``Points`` of shape (N, 3), the arrays of points by name, and those of the whole file.

    Raises:
        ValueError: if the file is damaged, or has a part that is not known.
    """
    text = _Text(data)
    if not text.line().startswith("# vtk DataFile Version"):
        raise ValueError("it does not begin with # vtk DataFile Version")
    text.line()  # the title
    form = text.line().upper()
    if form not in ("ASCII", "BINARY"):
        raise ValueError(f"its third line is {form[:20]!r}; expected ASCII or BINARY")
    is_binary, found, count, size, of_points = form == "BINARY", {}, 0, 0, False
    while line := text.line():
        word, *rest = line.split()
        word = word.upper()
        if word == "DATASET":
            if rest[0] not in ("POLYDATA", "UNSTRUCTURED_GRID"):
                raise ValueError(f"it is of {rest[0]}; expected POLYDATA or UNSTRUCTURED_GRID")
        elif word == "POINTS":
            count = _whole(rest[0])
            found["Points"] = text.numbers(3 * count, rest[1], is_binary).reshape(-1, 3)
        elif word in ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS"):
            _skip_cells(text, rest, is_binary)
        elif word == "CELL_TYPES":
            text.numbers(_whole(rest[0]), "int", is_binary)
        elif word in ("POINT_DATA", "CELL_DATA"):
            of_points = word == "POINT_DATA"
            if of_points and _whole(rest[0]) != count:
                raise ValueError(f"it has {count} points, and data of {rest[0]}")
            size = _whole(rest[0])
        elif word == "SCALARS":
            width = _whole(rest[2]) if len(rest) > 2 else 1
            if not text.line().upper().startswith("LOOKUP_TABLE"):
                raise ValueError(f"LOOKUP_TABLE does not follow SCALARS {rest[0]}")
            _keep(found, rest[0], text.numbers(width * size, rest[1], is_binary), width, of_points)
        elif word in SIZES:
            width = SIZES[word]
            _keep(found, rest[0], text.numbers(width * size, rest[1], is_binary), width, of_points)
        elif word == "FIELD":
            for _ in range(_whole(rest[1])):
                name, width, many, kind = _field(text)
                values = text.numbers(width * many, kind, is_binary)
                if of_points and many != count:
                    raise ValueError(f"the array {name} has {many} tuples; expected {count}, one a point")
                _keep(found, name, values, width, of_points or "Points" not in found)
        elif word == "METADATA":
            while text.at < len(data) and data[text.at : text.at + 1] not in (b"\n", b"\r"):
                text.at = (data.find(b"\n", text.at) + 1) or len(data)
        else:
            raise ValueError(f"its part {word[:20]!r} is not known, or an earlier part has another length")
    if "Points" not in found:
        raise ValueError("it has no POINTS")
    return found


def _keep(found: dict[str, np.ndarray], name: str, values: np.ndarray, width: int, is_kept: bool) -> None:
    """Adds an array of points; one name twice would hide one of them."""
    name = unquote(name)
    if is_kept:
        if name in found:
            raise ValueError(f"the array {name} is there twice")
        found[name] = values.reshape(-1, width) if width > 1 else values


def _field(text: _Text) -> tuple[str, int, int, str]:
    line = text.line()
    while line.upper().startswith("METADATA"):
        while text.data[text.at : text.at + 1] not in (b"\n", b"\r", b""):
            text.at = (text.data.find(b"\n", text.at) + 1) or len(text.data)
        line = text.line()
    words = line.split()
    if len(words) != 4:
        raise ValueError(f"an array of a FIELD begins {line[:40]!r}; expected name, components, tuples, type")
    return words[0], _whole(words[1]), _whole(words[2]), words[3]


def _skip_cells(text: _Text, rest: list[str], is_binary: bool) -> None:
    """Cells: numbers of points each, or in version 5 offsets and connectivity."""
    first, second = _whole(rest[0]), _whole(rest[1])
    start = text.at
    line = text.line()
    if not line.startswith("OFFSETS"):
        text.at = start
        text.numbers(second, "int", is_binary)
        return
    text.numbers(first, line.split()[1], is_binary)
    line = text.line()
    if not line.startswith("CONNECTIVITY"):
        raise ValueError("CONNECTIVITY does not follow OFFSETS")
    text.numbers(second, line.split()[1], is_binary)
