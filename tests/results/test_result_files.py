"""Results in files of other programs: HDF5, tables, VTK; what is written is what the result has."""

import importlib.util
import json
import os
import resource

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody import InputError, Model, Result, WriteError, simulate
from sebody.cli.entry import main
from sebody.fem import hexahedral_block, rectangle
from sebody.reduction import RigidFace, craig_bampton
from sebody.scenes import hinged_beam

h5py = pytest.importorskip("h5py")
pytest.importorskip("meshio")
pytest.importorskip("pandas")
pytest.importorskip("xarray")


@pytest.fixture(scope="module")
def result():
    return simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.2)


def test_hdf5(result, tmp_path):
    path = result.save(tmp_path / "run.h5")
    with h5py.File(path) as file:
        assert np.array_equal(file["tip.position"], result["tip.position"])
        assert file["tip.velocity"].attrs["units"] == "length/time"
        assert file["energy.kinetic"].attrs["units"] == "force length"
        assert file["t"].attrs["units"] == "time" and file.attrs["superelements"] == "beam"
        assert file.attrs["program"].startswith("sebody ")
    loaded = Result.load(path)
    for name in ("tip.acceleration", "beam.node2.velocity", "energy.strain"):
        assert np.array_equal(loaded[name], result[name])
    assert loaded.summary() == result.summary()
    other = loaded.save(tmp_path / "again.npz")
    assert np.array_equal(Result.load(other)["tip.position"], result["tip.position"])


def test_damaged_and_foreign_hdf5_files(result, tmp_path):
    path = result.save(tmp_path / "run.h5")
    data = path.read_bytes()
    path.write_bytes(data[:len(data) // 2])
    with pytest.raises(InputError, match="run.h5 is damaged or no results file: give one written"):
        Result.load(path)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["t"] = np.zeros(3)
    with pytest.raises(InputError, match="other.h5 is damaged or no results file"):
        Result.load(tmp_path / "other.h5")
    path = result.save(tmp_path / "run.h5")
    with h5py.File(path) as file, h5py.File(tmp_path / "older.h5", "w") as older:
        file.copy("sebody", older)
        del older["sebody/notes"]
        older["sebody/notes"] = json.dumps({"version": 1})
    with pytest.raises(InputError, match="older.h5 is of version 1, this program reads 8"):
        Result.load(tmp_path / "older.h5")
    with h5py.File(path, "r+") as file:
        file["sebody/rows"][1, 3] += 1e-9
    with pytest.raises(InputError, match="run.h5 is damaged or no results file.*its checksum is "
                                         "not that of its content"):
        Result.load(path)


@pytest.mark.parametrize("name", ["run.h5", "run.npz"])
def test_a_full_disk_leaves_the_older_file(result, tmp_path, name):
    path = result.save(tmp_path / name)
    older = path.read_bytes()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5_000, limits[1]))
    try:
        with pytest.raises(WriteError, match=f"output file .*{name} cannot be written: File too "
                                             "large; the older file is unchanged"):
            result.save(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == older and os.listdir(tmp_path) == [name]


def test_the_command_writes_hdf5(tmp_path, capsys):
    path = tmp_path / "run.h5"
    assert main(["run", "planar-hinged-beam", "--t-end", "0.1", "--output", str(path)]) == 0
    assert f"histories            {path}" in capsys.readouterr().out
    loaded = Result.load(path)
    assert loaded.field("beam").velocity().shape[1] == 2
    # motion in a plane, in space
    points, _, data = read_by_vtk(series(loaded.save_vtk(tmp_path / "run.pvd", every=5))[-1][1])
    assert np.array_equal(points[:, 2], np.zeros(len(points)))
    assert_allclose(points[:loaded.field("beam").count, :2], loaded.field("beam").position())
    assert np.isnan(data["von_mises"]).all()        # of a section without fibres


def test_tables(result):
    frame = result.to_pandas()
    assert frame.index.name == "t" and np.array_equal(frame.index, result.t)
    assert np.array_equal(frame["tip.position.y"], result["tip.position"][:, 1])
    assert np.array_equal(frame["tip.rotation.zx"], result["tip.rotation"][:, 2, 0])
    assert np.array_equal(frame["energy.kinetic"], result["energy.kinetic"])
    own = result.to_pandas(["beam.modes", "beam.node1.velocity"])
    assert list(own) == ["beam.modes.0", "beam.modes.1", *(f"beam.node1.velocity.{a}"
                                                           for a in "xyz")]
    data = result.to_xarray(["tip.velocity", "tip.rotation", "beam.modes"])
    assert data["tip.velocity"].attrs["units"] == "length/time"
    assert_allclose(data["tip.velocity"].sel(axis="y"), result["tip.velocity"][:, 1])
    assert_allclose(data["tip.rotation"].sel(row="z", column="x", t=0.1, method=None),
                    result["tip.rotation"][10, 2, 0])
    assert data["beam.modes"].shape == (21, 2)
    with pytest.raises(InputError, match="did you mean 'tip.velocity'"):
        result.to_pandas(["tip.velocty"])


@pytest.mark.parametrize("package, call, message", [
    ("h5py", lambda r, p: r.save(p / "r.h5"), r'need h5py: pip install "sebody\[hdf5\]", or take'),
    ("pandas", lambda r, p: r.to_pandas(), r'need pandas: pip install "sebody\[tables\]"'),
    ("xarray", lambda r, p: r.to_xarray(), r'need xarray: pip install "sebody\[tables\]"'),
])
def test_what_is_missing_is_named(result, tmp_path, monkeypatch, package, call, message):
    found = importlib.util.find_spec
    for module in ("hdf5", "dataframes"):
        monkeypatch.setattr(f"sebody.results.{module}.find_spec",
                            lambda name: None if name == package else found(name))
    with pytest.raises(InputError, match=message):
        call(result, tmp_path)
    assert not list(tmp_path.iterdir())


def series(path):
    """Times and files of a series, by vtk's own reader of XML."""
    from xml.etree import ElementTree
    return [(float(one.get("timestep")), path.parent / one.get("file"))
            for one in ElementTree.parse(path).iter("DataSet")]


def read_by_vtk(path):
    pytest.importorskip("vtkmodules.vtkIOXML")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    data = grid.GetPointData()
    return (vtk_to_numpy(grid.GetPoints().GetData()), grid,
            {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k))
             for k in range(data.GetNumberOfArrays())})


def test_vtk(tmp_path):
    """Two bodies, one of hexahedra, as another program reads them."""
    pytest.importorskip("vtkmodules.vtkIOXML")
    model = Model()
    fe = hexahedral_block((0, 0, 0), (2, 1, 1), (2, 1, 1), 7e10, 0.3, 2700.0)
    ends = [tuple(np.flatnonzero(fe.coordinates[:, 0] == x)) for x in (0.0, 2.0)]
    faces = [(RigidFace((x, 0.5, 0.5), nodes), "full")
             for x, nodes in zip((0.0, 2.0), ends, strict=True)]
    a, b = model.node("a", (0, 0.5, 0.5)), model.node("b", (2, 0.5, 0.5))
    c = model.node("c", (5, 0.5, 0.5))
    model.superelement("block", craig_bampton(fe, faces, 1), [a, b])
    model.beam("beam", (b, c), rectangle(0.3, 0.2, 7e10, 0.3, 2700.0), 3, bodies=1, modes=1)
    model.fix(a)
    model.force(c, (0, 0, -1e4), [(0, 1), (1, 1)])
    result = simulate(model, 1e-3, 4e-3)
    path = result.save_vtk(tmp_path / "run.pvd", every=2)
    found = series(path)
    assert [t for t, _ in found] == [0.0, 0.002, 0.004]
    points, grid, data = read_by_vtk(found[-1][1])
    block, beam = result.field("block"), result.field("beam")
    expected = np.concatenate([block.position(), beam.position(),
                               [result[f"{n}.position"][-1] for n in "abc"]])
    assert_allclose(points, expected, rtol=0, atol=1e-14)
    assert_allclose(data["von_mises"][:12], block.von_mises(), rtol=1e-14)
    assert_allclose(data["von_mises"][12:16], beam.von_mises(), rtol=1e-14)
    assert_allclose(data["velocity"][12:16], beam.velocity(), rtol=1e-14)
    assert list(data["body"]) == [0] * 12 + [1] * 4 + [-1] * 3
    assert [grid.GetCell(k).GetCellType() for k in range(grid.GetNumberOfCells())] == (
        [12] * 2 + [3] * 3 + [1] * 3)       # hexahedra, lines, vertices
    for name, message in (("run.vtu", "VTK series .*run.vtu must end in .pvd"),
                          ("none/run.pvd", "folder .*none of the VTK series does not exist")):
        with pytest.raises(InputError, match=message):
            result.save_vtk(tmp_path / name)
    (tmp_path / "taken").write_text("")
    with pytest.raises(InputError, match="taken is a file, so the states of VTK series"):
        result.save_vtk(tmp_path / "taken.pvd")
