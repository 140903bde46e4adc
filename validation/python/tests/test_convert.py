"""Results of other codes, their damaged copies, and the files that the program reads."""

import gzip
import os
import struct
import zipfile

import numpy as np
import pytest
import touchstone_sph as ts

N = 5
COLUMNS = {name: np.linspace(k, k + 1, N) for k, name in enumerate(("x", "y", "u", "v", "rho"))}
IDS = np.arange(N, dtype=np.uint32)


def table(path):
    return np.genfromtxt(path, delimiter=",", names=True, deletechars="")


def legacy(is_binary, lines="VERTICES 1 2\n"):
    """A legacy file of ParaView with points, a vector, and ids."""
    points = np.stack([COLUMNS["x"], COLUMNS["y"], 0 * COLUMNS["x"]], axis=1)
    velocity = np.stack([COLUMNS["u"], COLUMNS["v"], 0 * COLUMNS["x"]], axis=1)

    def numbers(values, kind):
        return values.astype(kind).tobytes() if is_binary else " ".join(map(repr, values.ravel().tolist())).encode()

    cells = struct.pack(">2i", 1, 0) if is_binary else b"1 0"
    return b"".join(
        [
            b"# vtk DataFile Version 3.0\ntitle\n" + (b"BINARY" if is_binary else b"ASCII") + b"\nDATASET POLYDATA\n",
            b"FIELD FieldData 1\nTimeValue 1 1 double\n" + numbers(np.array([0.25]), ">f8"),
            b"\nPOINTS 5 double\n" + numbers(points, ">f8") + b"\n" + lines.encode() + cells,
            b"\nPOINT_DATA 5\nVECTORS velocity double\n" + numbers(velocity, ">f8"),
            b"\nFIELD more 2\nIdp 1 5 unsigned_int\n" + numbers(IDS, ">u4"),
            b"\na%20b 1 5 float\n" + numbers(COLUMNS["rho"], ">f4") + b"\n",
        ]
    )


@pytest.mark.parametrize("is_binary", [True, False])
def test_a_legacy_file_is_read_whole_or_not_at_all(tmp_path, is_binary):
    file, data = tmp_path / "a_0.vtk", legacy(is_binary)
    file.write_bytes(data)
    (path,) = ts.convert(file, tmp_path / "out")
    found = table(path)
    assert np.array_equal(found["y"], COLUMNS["y"]) and np.array_equal(found["velocity.x"], COLUMNS["u"])
    assert np.array_equal(found["Idp"], IDS) and set(found["TimeValue"] if "TimeValue" in found.dtype.names else found["t"]) == {0.25}
    assert "a b" in path.read_text().splitlines()[0]
    for k, wrong in enumerate(
        [data[: len(data) // 2], data[:-9], data.replace(b"POINTS 5", b"POINTS 99999999999"),
         data.replace(b"POINTS 5", b"POINTS -5"), data.replace(b"POINT_DATA 5", b"POINT_DATA 6"),
         data.replace(b"POINTS 5 double", b"POINTS 5 quad"), data.replace(b"POLYDATA", b"STRUCTURED_GRID"), b"hello", b""]
    ):
        file.write_bytes(wrong)
        with pytest.raises(ValueError, match="a_0.vtk"):
            ts.convert(file, tmp_path / f"wrong_{k}")
        assert not list((tmp_path / f"wrong_{k}").glob("*"))


def test_files_of_pysph_are_read_and_objects_of_a_pickle_are_not_made(tmp_path):
    arrays = {**COLUMNS, "gid": IDS, "tag": np.array([0, 0, 0, 0, 1])}
    particles = {"fluid": {"arrays": arrays}, "wall": {"arrays": arrays}}
    np.savez(tmp_path / "run_3.npz", version=2, particles=np.array(particles, dtype=object),
             solver_data=np.array({"t": 0.125}, dtype=object))
    with pytest.raises(ValueError, match="fluid, wall"):
        ts.convert(tmp_path / "run_3.npz", tmp_path / "out")
    found = table(ts.convert(tmp_path / "run_3.npz", tmp_path / "out", only="fluid")[0])
    assert set(found["t"]) == {0.125} and np.array_equal(found["x"], COLUMNS["x"][:4]), "a copy is left out"

    class Evil:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "made"),)

    np.savez(tmp_path / "evil.npz", version=2, solver_data=np.array({"t": 0.0}, dtype=object),
             particles=np.array({"fluid": {"arrays": {"x": Evil()}}}, dtype=object))
    with pytest.raises(ValueError, match="mkdir"):
        ts.convert(tmp_path / "evil.npz", tmp_path / "out", only="fluid")
    assert not (tmp_path / "made").exists()


def test_columns_of_numpy_in_any_byte_order(tmp_path):
    np.savez(tmp_path / "a.npz", t=0.5, id=IDS, **{name: of.astype(">f8") for name, of in COLUMNS.items()})
    found = table(ts.convert(tmp_path / "a.npz", tmp_path / "out")[0])
    assert all(np.array_equal(found[name], of) for name, of in COLUMNS.items()) and set(found["t"]) == {0.5}
    with pytest.raises(FileExistsError, match="results.csv"):
        ts.convert(tmp_path / "a.npz", tmp_path / "out")
    with zipfile.ZipFile(tmp_path / "bomb.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("x.npy", bytes(1 << 29))
    (tmp_path / "cut.npz").write_bytes((tmp_path / "a.npz").read_bytes()[:300])
    np.savez(tmp_path / "short.npz", x=np.ones(3), y=np.ones(4), t=0.0)
    for name in ("bomb", "cut", "short"):
        with pytest.raises(ValueError, match=name):
            ts.convert(tmp_path / f"{name}.npz", tmp_path / name)


def test_groups_of_hdf5_are_frames_and_links_are_refused(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for k in (10, 9):
            group = file.create_group(f"frame_{k}")
            group["t"], group["id"] = float(k), IDS
            for name, of in COLUMNS.items():
                group[name] = of
    assert list(table(ts.convert(tmp_path / "a.h5", tmp_path / "out")[0])["t"]) == N * [9.0] + N * [10.0]
    with h5py.File(tmp_path / "link.h5", "w") as file:
        file["x"] = h5py.ExternalLink("a.h5", "frame_9/x")
    with h5py.File(tmp_path / "huge.h5", "w") as file:
        file.create_dataset("x", (1 << 40,), "f8", chunks=(1024,))
    for name, words in (("link", "x is a link"), ("huge", "more than")):
        with pytest.raises(ValueError, match=words):
            ts.convert(tmp_path / f"{name}.h5", tmp_path / name)


def test_dumps_in_other_units_are_converted_or_refused(tmp_path):
    dump = "ITEM: UNITS\n{}\nITEM: TIME\n2\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 10\n0 1\n-1 1\n"
    dump += "ITEM: ATOMS id xs y vx vy c_rho\n1 0.5 0.5 3 0 1\n"
    (tmp_path / "a.dump").write_text(dump.format("cgs"))
    (path,) = ts.convert(tmp_path / "a.dump", tmp_path / "out")
    lines = path.read_text().splitlines()
    assert lines[1] == "si" and [float(end) for end in lines[7].split()] == pytest.approx([0, 0.1])
    assert [float(cell) for cell in lines[-1].split()] == pytest.approx([1, 0.5, 0.005, 0.03, 0, 1000])
    for units, words in (("real", "its units are real"), ("cgs", "c_other")):
        text = dump.format(units)
        (tmp_path / "a.dump").write_text(text.replace("c_rho", "c_other") if units == "cgs" else text)
        with pytest.raises(ValueError, match=words):
            ts.convert(tmp_path / "a.dump", tmp_path / "wrong")


def test_a_collection_states_the_times_of_its_grids(tmp_path):
    grid = '<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="0"></Piece></PolyData></VTKFile>'
    (tmp_path / "a.vtp").write_text(grid)
    with gzip.open(tmp_path / "b.vtp.gz", "wt") as file:
        file.write(grid)

    def collection(*entries):
        sets = "".join(f'<DataSet timestep="{time}" file="{name}"/>' for time, name in entries)
        (tmp_path / "all.pvd").write_text(f'<VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')
        return tmp_path / "all.pvd"

    first, second = ts.convert(collection((1.0, "a.vtp"), (0.5, "b.vtp.gz")), tmp_path / "out")
    assert ">0.5<" in first.read_text() and ">1.0<" in second.read_text() and first.name == "frame_0.vtp"
    for entries, words in [
        ([(1.0, "a.vtp"), (1.0, "b.vtp.gz")], "one file for each time"),
        ([(1.0, "../a.vtp")], "outside its folder"),
        ([], "one file for each time"),
    ]:
        with pytest.raises(ValueError, match=words):
            ts.convert(collection(*entries), tmp_path / "wrong")
    (tmp_path / "cut.vtp.gz").write_bytes((tmp_path / "b.vtp.gz").read_bytes()[:-10])
    with pytest.raises(ValueError, match="cut.vtp.gz"):
        ts.convert(tmp_path / "cut.vtp.gz", tmp_path / "wrong")
