"""Results in formats of other codes, as the files that ``touchstone submit`` reads.

The program reads tables, dumps of LAMMPS, and ``.vtu`` and ``.vtp`` with any byte order, base64 or appended data.
Files of the other formats become one table, whose columns keep their names: `submit` knows usual ones, and
``--map`` names others.
"""

from __future__ import annotations

import csv
import gzip
import io
import pickle
import re
import tempfile
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, Optional, Union
from xml.etree import ElementTree

import numpy as np

from . import _legacy_vtk

#: More than these are no results of a laptop: bytes of a file, and rows in all.
MOST_BYTES = 1 << 28
MOST_ROWS = 3_000_000
#: Units of LAMMPS in SI: length, time, mass.
UNITS = {
    "si": (1.0, 1.0, 1.0),
    "cgs": (1e-2, 1.0, 1e-3),
    "micro": (1e-6, 1e-6, 1e-15),
    "nano": (1e-9, 1e-9, 1e-21),
}
#: Columns of dumps by quantity, as powers of length, time and mass; others have no known unit.
POWERS = {
    **dict.fromkeys(("x", "y", "z", "xu", "yu", "zu"), (1, 0, 0)),
    **dict.fromkeys(("vx", "vy", "vz"), (1, -1, 0)),
    **dict.fromkeys(("rho", "c_rho", "density", "rhop", "c_rho_peratom"), (-3, 0, 1)),
    "mass": (-1, 0, 1),  # per unit depth
    **dict.fromkeys(("id", "type", "xs", "ys", "zs", "xsu", "ysu", "zsu", "ix", "iy", "iz"), (0, 0, 0)),
}
#: Names of ids, in small letters without signs between them.
IDS = re.compile(r"(particle|original|global|g|u)?ids?|idp|index")

Columns = dict[str, np.ndarray]


class Frame(NamedTuple):
    """Columns of a file by name, each of shape (N,), and their time [s]; None if the file states none."""

    time: Optional[float]
    columns: Columns


def convert(
    path: Union[str, Path],
    folder: Union[str, Path],
    times: Optional[Sequence[float]] = None,
    only: Optional[str] = None,
) -> list[Path]:
    """Converts results to files that ``touchstone submit`` reads, and replaces no file.

    It reads ``.vtu``, ``.vtp``, their collections ``.pvd``, legacy ``.vtk``, ``.npz``, ``.h5`` and ``.hdf5`` (one
    array a column, or as PySPH writes them), ``.dump`` in units of LAMMPS, ``.csv``, each also as ``.gz``.

    Args:
        path: a file, or a folder with files of one format, in the order of the last number in their names.
        folder: where the files are written, usually the folder of the submission.
        times: times of the files [s], where these state none.
        only: name of the array of particles, where a file of PySPH has several.

    Returns:
        The files that were written.

    Raises:
        ValueError: if a file is damaged, too large, or has what cannot be read; the text names it.
        FileExistsError: if there is a file with the name of one that is to be written.
        ModuleNotFoundError: if a package is missing; the text names it.
    """
    sources = _sources(Path(path), times)
    written: dict[str, bytes] = {}
    frames: list[Frame] = []
    for place, (file, time) in enumerate(sources):
        name, data = _unpacked(file)
        kind = Path(name).suffix.lower()
        try:
            if kind in (".vtu", ".vtp"):
                written[f"frame_{place}{kind}"] = _timed(data, time, times is not None)
            elif kind == ".dump" or data.startswith(b"ITEM:"):
                written[f"frame_{place}.dump"] = _in_si(data.decode("utf-8"))
            elif kind == ".csv":
                written["results.csv"] = data
            elif kind in READERS:
                found = READERS[kind](data, only)
                frames += [_at(frame, time, times is not None) for frame in found]
            else:
                raise ValueError(f"its ending is {kind or 'missing'}; expected {', '.join(ENDINGS)} or .gz of one")
            if sum(_count(frame) for frame in frames) > MOST_ROWS:
                raise ValueError(f"there are more than {MOST_ROWS} rows; expected fewer particles or times")
        except (ValueError, KeyError, OSError, EOFError, IndexError, TypeError, zipfile.BadZipFile, zlib.error) as error:
            raise ValueError(f"{file.name}: {error}") from error
    if frames:
        if written:
            raise ValueError("there are results in several formats; convert each")
        written["results.csv"] = _table(frames)
    return _write(written, Path(folder))


def _sources(path: Path, times: Optional[Sequence[float]]) -> list[tuple[Path, Optional[float]]]:
    """The files to convert, with the times that a collection or the caller states."""
    if path.suffix.lower() == ".pvd":
        if times is not None:
            raise ValueError(f"{path.name} states the times; leave out times")
        return _collection(path)
    files = [path]
    if path.is_dir():
        files = [file for file in path.iterdir() if set(file.suffixes[-2:]) & set(ENDINGS) and file.is_file()]
        files.sort(key=lambda file: (int((re.findall(r"\d+", file.name) or ["0"])[-1]), file.name))
        if len({tuple(file.suffixes[-1:]) for file in files}) > 1:
            raise ValueError(f"{path} has results in several formats; name one file or .pvd")
    if not files:
        raise ValueError(f"{path} has no results; expected {', '.join(ENDINGS)}, or .gz of one")
    if times is not None and len(times) != len(files):
        raise ValueError(f"there are {len(times)} times; expected one for each of {len(files)} files")
    return list(zip(files, times if times is not None else [None] * len(files)))


def _collection(path: Path) -> list[tuple[Path, Optional[float]]]:
    """The files of a collection of ParaView in the order of their times."""
    try:
        root = ElementTree.fromstring(_limited(path))
    except ElementTree.ParseError as error:
        raise ValueError(f"{path.name}: {error}") from error
    if root.get("type") != "Collection":
        raise ValueError(f"{path.name}: its type is {root.get('type')}; expected Collection")
    files = []
    for entry in root.iter("DataSet"):
        name, time = entry.get("file"), float(entry.get("timestep", "nan"))
        if not name or not np.isfinite(time):
            raise ValueError(f"{path.name}: a DataSet lacks file, or timestep is no number")
        file = path.parent / name
        if not file.resolve().is_relative_to(path.parent.resolve()):
            raise ValueError(f"{path.name}: {name} is outside its folder")
        files.append((file, time))
    files.sort(key=lambda of: of[1])
    if not files or any(a[1] == b[1] for a, b in zip(files, files[1:])):
        raise ValueError(f"{path.name}: expected one file for each time; parts of one time are not joined")
    return files


def _limited(path: Path) -> bytes:
    """The bytes of a file, of a limited number."""
    with open(path, "rb") as file:
        return _at_most(file, path.name)


def _at_most(file: Any, name: str) -> bytes:
    data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise ValueError(f"{name}: it has more than {MOST_BYTES} bytes")
    return bytes(data)


def _unpacked(path: Path) -> tuple[str, bytes]:
    """Name and bytes of a file; of one in gzip those inside."""
    if path.suffix.lower() != ".gz":
        return path.name, _limited(path)
    try:
        with gzip.open(path, "rb") as file:
            return path.stem, _at_most(file, path.name)
    except (EOFError, gzip.BadGzipFile, OSError) as error:
        raise ValueError(f"{path.name}: {error}") from error


def _timed(data: bytes, time: Optional[float], is_given: bool) -> bytes:
    """A grid of ParaView that states its time. The program decodes and checks all else."""
    head = data.partition(b"<AppendedData")[0]
    if re.search(rb"""Name\s*=\s*["']TimeValue["']""", head):
        if is_given:
            raise ValueError("it states its time; leave out times")
        return data
    grid = re.search(rb"<(UnstructuredGrid|PolyData)\b[^>]*[^/]?>", head)
    if time is None or grid is None:
        return data
    array = f'<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time!r}</DataArray>'
    if b"<FieldData" in head:
        raise ValueError("it has FieldData without TimeValue; expected one with it, or none")
    return data[: grid.end()] + f"<FieldData>{array}</FieldData>".encode() + data[grid.end() :]


def _in_si(text: str) -> bytes:
    """A dump of LAMMPS in SI; one without stated units, or in ``lj``, is left as it is."""
    lines = text.splitlines()
    stated = {lines[k + 1].strip() for k, line in enumerate(lines[:-1]) if line.startswith("ITEM: UNITS")}
    if len(stated) > 1:
        raise ValueError(f"its units are {' and '.join(sorted(stated))}; expected one system")
    (units,) = stated or {"lj"}
    if units in ("si", "lj"):
        return text.encode()
    if units not in UNITS:
        raise ValueError(f"its units are {units}; expected {', '.join(UNITS)} or lj")
    if not text.endswith("\n"):
        raise ValueError("its last line does not end: the file was cut short")
    length, second, _ = UNITS[units]
    result, item, factors, box = [], "", [], 0
    for number, line in enumerate(lines, 1):
        if line.startswith("ITEM:"):
            words = line.split()
            item, box = words[1], 0
            if item == "ATOMS":
                unknown = [name for name in words[2:] if name not in POWERS]
                if unknown:
                    raise ValueError(f"the units of {', '.join(unknown)} are not known; leave them out of the dump")
                factors = [_factor(units, POWERS[name]) for name in words[2:]]
        elif item == "UNITS":
            line = "si"
        elif item == "TIME":
            line = repr(float(line) * second)
        elif item == "BOX":
            box += 1
            line = " ".join(repr(float(end) * length) for end in line.split())
        elif item == "ATOMS":
            cells = line.split()
            if len(cells) != len(factors):
                raise ValueError(f"line {number} has {len(cells)} values; expected {len(factors)}")
            line = " ".join(c if f == 1 else repr(float(c) * f) for c, f in zip(cells, factors))
        result.append(line + "\n")
    return "".join(result).encode()


def _factor(units: str, powers: tuple[int, int, int]) -> float:
    """A unit of LAMMPS in SI."""
    length, time, mass = (float(base) ** power for base, power in zip(UNITS[units], powers))
    return length * time * mass


def _count(frame: Frame) -> int:
    return max((values.size for values in frame.columns.values()), default=0)


def _at(frame: Frame, time: Optional[float], is_given: bool) -> Frame:
    """A frame at the time that it states, or else at the given one."""
    if frame.time is not None and is_given:
        raise ValueError("it states its time; leave out times")
    return frame if frame.time is not None else Frame(time, frame.columns)


def _frame(arrays: dict[str, Any]) -> Frame:
    """Named arrays as columns: vectors by component, the time apart, all of one length."""
    time, columns = None, {}
    for name, values in arrays.items():
        values = np.asarray(values)
        if values.dtype.kind not in "fiu":
            continue
        if name.lower() in ("t", "time", "timevalue") and values.size == 1:
            time = float(values.ravel()[0])
        elif values.ndim == 2 and 2 <= values.shape[1] <= 3:
            names = "xyz" if name == "Points" else [f"{name}.{axis}" for axis in "xyz"]
            columns.update(zip(names, values.T))
        elif values.ndim == 1 and values.size > 1 or values.shape == (1,):
            columns[name] = values
    counts = {values.size for values in columns.values()}
    if len(counts) > 1:
        sizes = ", ".join(f"{name}: {values.size}" for name, values in columns.items())
        raise ValueError(f"its columns have other lengths: {sizes}")
    if not columns:
        raise ValueError("it has no columns of numbers")
    ghosts = columns.pop("vtkGhostType", np.zeros(1))
    if ghosts.any():
        raise ValueError("vtkGhostType marks points of other parts; expected one whole grid")
    return Frame(time, columns)


def _npz(data: bytes, only: Optional[str]) -> list[Frame]:
    """Arrays of NumPy, one a column, or as PySPH writes them."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        if sum(entry.file_size for entry in archive.infolist()) > MOST_BYTES:
            raise ValueError(f"its arrays have more than {MOST_BYTES} bytes")
        arrays = {entry.filename[:-4]: _array(archive.read(entry)) for entry in archive.infolist()}
    if not {"particles", "solver_data"} <= set(arrays):
        return [_frame(arrays)]
    particles = {name: of["arrays"] for name, of in arrays["particles"].item().items()}
    return [_of_pysph(particles, arrays["solver_data"].item(), only)]


class _Arrays(pickle.Unpickler):
    """Reads arrays and plain data, and calls nothing else: a pickle can name any function."""

    ALLOWED = {("multiarray", "_reconstruct"), ("multiarray", "scalar"), ("numeric", "_frombuffer")}

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) in (("numpy", "ndarray"), ("numpy", "dtype")):
            return getattr(np, name)
        parts = module.split(".")
        if parts[0] == "numpy" and parts[1] in ("core", "_core") and (parts[-1], name) in self.ALLOWED:
            return super().find_class(module, name)
        if (module, name) == ("_codecs", "encode"):
            return super().find_class(module, name)
        raise ValueError(f"it has an object of {module}.{name}; expected arrays and plain data")


def _array(data: bytes) -> np.ndarray:
    """An array of NumPy, which may hold plain objects."""
    file = io.BytesIO(data)
    version = np.lib.format.read_magic(file)
    read_head = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, is_fortran, kind = read_head(file)
    if not kind.hasobject:
        return np.load(io.BytesIO(data), allow_pickle=False)
    try:
        value = _Arrays(file).load()
    except (pickle.UnpicklingError, AttributeError, TypeError) as error:
        raise ValueError(f"its objects cannot be read: {error}") from error
    return np.asarray(value, dtype=object)


def _hdf5(data: bytes, only: Optional[str]) -> list[Frame]:
    """Datasets, one a column, at the root or in one group a frame; or as PySPH writes them."""
    h5py = _package("h5py")
    with h5py.File(io.BytesIO(data), "r") as file:
        if {"particles", "solver_data"} <= set(file):
            groups = {name: _datasets(h5py, of["arrays"]) for name, of in file["particles"].items()}
            return [_of_pysph(groups, dict(file["solver_data"].attrs), only)]
        groups = [of for of in file.values() if isinstance(of, h5py.Group)]
        if len(groups) < len(file):
            return [_frame(_datasets(h5py, file))]
        groups.sort(key=lambda of: (int((re.findall(r"\d+", of.name) or ["0"])[-1]), of.name))
        return [_frame(_datasets(h5py, of)) for of in groups]


def _datasets(h5py: Any, group: Any) -> dict[str, np.ndarray]:
    """The datasets of a group. Data in other files are refused."""
    arrays, count = {}, 0
    for name in group:
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise ValueError(f"{name} is a link; expected datasets in the file itself")
        of = group[name]
        if not isinstance(of, h5py.Dataset) or of.dtype.kind not in "fiu" or not of.attrs.get("stored", True):
            continue
        if of.external or of.is_virtual:
            raise ValueError(f"{name} has its data in another file; expected datasets in the file itself")
        count += of.size
        if 8 * count > MOST_BYTES:
            raise ValueError(f"its datasets have more than {MOST_BYTES} bytes")
        if of.attrs.get("stride", 1) == 1:
            arrays[name] = of[()]
    return arrays


def _of_pysph(groups: dict[str, Any], solver: dict[str, Any], only: Optional[str]) -> Frame:
    """One array of particles of PySPH; copies of particles for other processes are left out."""
    names = [only] if only is not None else list(groups)
    if len(names) != 1 or names[0] not in groups:
        raise ValueError(f"its arrays of particles are {', '.join(groups)}; expected only= with the name of one")
    arrays = {name: np.asarray(values) for name, values in groups[names[0]].items()}
    count = arrays["x"].size
    arrays = {name: values for name, values in arrays.items() if values.shape == (count,)}
    real = arrays.pop("tag", np.zeros(count)) == 0
    frame = _frame({name: values[real] for name, values in arrays.items()})
    return Frame(float(solver["t"]), frame.columns)


def _vtk(data: bytes, _: Optional[str]) -> list[Frame]:
    return [_frame(_legacy_vtk.arrays(data))]


#: Readers of formats that become a table.
READERS = {".npz": _npz, ".h5": _hdf5, ".hdf5": _hdf5, ".vtk": _vtk}
ENDINGS = [*READERS, ".vtu", ".vtp", ".dump", ".csv"]


def _package(name: str) -> Any:
    """A package that is needed for one format only."""
    try:
        return __import__(name)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"this format needs the package {name}: pip install {name}") from error


def _table(frames: list[Frame]) -> bytes:
    """Frames as a table, in the order of their times."""
    names = list(frames[0].columns)
    lines: list[str] = []
    head = io.StringIO()
    has_time = any(name.lower() in ("t", "time", "timevalue") for name in names)
    heads = [*([] if has_time else ["t"]), *names]
    without_ids = not any(IDS.fullmatch(re.sub("[-_.: ]", "", name.lower())) for name in names)
    if without_ids:
        whole = [name for name in names if frames[0].columns[name].dtype.kind in "iu"]
        if whole:
            raise ValueError(
                f"it has no ids, and {', '.join(whole)} may be them; rename one to id, or leave them out if "
                "particles are in the order of the problem"
            )
        heads.append("id")
    csv.writer(head, lineterminator="\n").writerow(heads)
    for frame in sorted(frames, key=lambda of: np.inf if of.time is None else of.time):
        if list(frame.columns) != names:
            differ = set(frame.columns) ^ set(names)
            raise ValueError(f"{', '.join(sorted(differ))} are not in all files; expected the same columns")
        columns = [frame.columns[name] for name in names]
        count = columns[0].size
        if not has_time:
            if frame.time is None:
                raise ValueError("a file states no time; expected times= with one for each file")
            columns.insert(0, np.full(count, frame.time))
        if without_ids:
            columns.append(np.arange(count))
        texts = [[_text(value) for value in values.tolist()] for values in columns]
        lines += [",".join(row) + "\n" for row in zip(*texts)]
    return (head.getvalue() + "".join(lines)).encode("utf-8")


def _text(value: Union[int, float]) -> str:
    return repr(value)


def _write(files: dict[str, bytes], folder: Path) -> list[Path]:
    """Writes files, all or none, and replaces none."""
    folder.mkdir(parents=True, exist_ok=True)
    targets = [folder / name for name in files]
    taken = [target for target in targets if target.exists()]
    if taken:
        raise FileExistsError(f"{taken[0]} exists; convert into another folder, or remove it")
    with tempfile.TemporaryDirectory(dir=folder) as temporary:
        for name, data in files.items():
            Path(temporary, name).write_bytes(data)
        for target in targets:
            Path(temporary, target.name).replace(target)
    return targets


