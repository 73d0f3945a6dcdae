"""Bodies in files: nothing is lost, and nothing else is taken for one."""

import json
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from sebody import InputError, Model, WriteError
from sebody.fem import Section, hexahedral_block, planar_beam, rectangle, straight_beam
from sebody.io import load_body, read_body_file, save_body
from sebody.reduction import RigidFace, craig_bampton

SECTION = Section(area=2.0, inertia_y=0.3, inertia_z=0.4, torsion=0.2, youngs_modulus=1e4,
                  poisson_ratio=0.25, density=1.5)


def block():
    model = hexahedral_block((1, 2, 3), (3, 1, 1), (3, 1, 1), 1e4, 0.25, 2.0)
    ends = [np.flatnonzero(np.isclose(model.coordinates[:, 0], x)) for x in (1, 4)]
    faces = [RigidFace((x, 2.5, 3.5), end) for x, end in zip((1, 4), ends, strict=True)]
    return craig_bampton(model, [(faces[0], "full"), (faces[1], "full")], 3)


def plane():
    model = planar_beam((1, 2), (4, 3), SECTION, 5)
    return craig_bampton(model, {0: "full", 3: "translation", 5: "rotation"}, 2).damped(0.02)


def same(one, other):
    if is_dataclass(one):
        return all(same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other if isinstance(one, dict | str) else np.array_equal(one, other)


@pytest.mark.parametrize("make", [block, plane])
def test_a_body_comes_back_as_it_was(make, tmp_path):
    body = make()
    names = tuple("abc"[:len(body.keeps)])
    save_body(body, tmp_path / "body.npz", names, units="mm, t, s", provenance={"source": "here"})
    body = replace(body, units="mm t N s")
    assert same(body, load_body(tmp_path / "body.npz"))
    file = read_body_file(tmp_path / "body.npz")
    assert (file.names, file.units, file.provenance) == (names, "mm t N s", {"source": "here"})
    np.testing.assert_array_equal(file.mesh[0], body.recovery.points)
    lean = load_body(save_body(body, tmp_path / "lean.npz", recovery=False))
    assert lean.recovery is None and same(lean.invariants, body.invariants)


def test_a_model_takes_the_file(tmp_path):
    body = block()
    path = save_body(body, tmp_path / "body.npz")
    model = Model()
    nodes = [model.node(f"n{k}", point) for k, point in enumerate(body.coordinates)]
    for k, name in enumerate((path, str(path))):
        placed = model.superelement(f"link {k}", name, nodes).reduced
        assert same(placed, body)


def test_any_program_can_read_it(tmp_path):
    body = block()
    with np.load(save_body(body, tmp_path / "body.npz")) as file:
        np.testing.assert_array_equal(file["stiffness"], body.stiffness)
        np.testing.assert_array_equal(file["invariants.J0"], body.invariants.J0)
        notes = json.loads(str(file["notes"]))
    assert notes["format"] == "sebody body"
    assert notes["names"] == ["node 0", "node 1"]


def changed(path, **notes):
    """The file with other notes."""
    with np.load(path) as file:
        arrays = dict(file)
    found = json.loads(str(arrays.pop("notes")))
    np.savez(path, notes=np.array(json.dumps(found | notes)), **arrays)


def test_other_versions_are_refused_in_words(tmp_path):
    path = save_body(block(), tmp_path / "body.npz")
    changed(path, version=2)
    with pytest.raises(InputError, match="is of version 2, this program reads 1: update sebody"):
        load_body(path)
    changed(path, version=0)
    with pytest.raises(InputError, match="is of version 0, .*: import the body again"):
        load_body(path)
    changed(path, format="other")
    with pytest.raises(InputError, match="is a file of another kind .'other'.: give one written"):
        load_body(path)


def test_a_defect_names_the_command_that_says_more(tmp_path):
    path = save_body(block(), tmp_path / "body.npz")
    with np.load(path) as file:
        arrays = dict(file)
    arrays["stiffness"] = arrays["stiffness"] + 50 * np.eye(len(arrays["stiffness"]))
    np.savez(path, **arrays)
    with pytest.raises(InputError, match=rf"body file {path}: stiffness resists rigid motion.*"
                                         rf"'sebody inspect {path}' says more"):
        load_body(path)


def test_loads_come_back_by_name(tmp_path):
    """Names may be any text."""
    body = block()
    random = np.random.default_rng(1)
    loads = {name: random.normal(size=len(body.mass)) for name in ("wind", "p.1/a b")}
    found = load_body(save_body(replace(body, loads=loads), tmp_path / "body.npz")).loads
    assert list(found) == list(loads)
    assert all(np.array_equal(found[name], loads[name]) for name in loads)


def test_damaged_files_are_refused(tmp_path):
    path = save_body(block(), tmp_path / "body.npz")
    whole = path.read_bytes()
    for spoilt in (whole[:len(whole) // 2], b"", whole.replace(b"PK", b"QK"), b"text"):
        path.write_bytes(spoilt)
        with pytest.raises(InputError, match="is damaged or no body file: give one written by"):
            load_body(path)
    with pytest.raises(InputError, match="none.npz does not exist"):
        load_body(tmp_path / "none.npz")


def test_a_failure_leaves_the_older_file(tmp_path, monkeypatch):
    path = save_body(block(), tmp_path / "body.npz")
    before = path.read_bytes()

    def full(*arguments, **arrays):
        raise OSError(28, "No space left on device")
    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(WriteError, match="No space left on device; the older file is unchanged"):
        save_body(plane(), path)
    assert path.read_bytes() == before and len(list(tmp_path.iterdir())) == 1
    with pytest.raises(InputError, match="names is .'a', 'a'.: give 2 different names"):
        save_body(block(), path, ("a", "a"))


def test_stresses_of_files_from_before_sections_differed_within_elements(tmp_path):
    """Fibres were those of both ends, and no flexibilities of sections were kept."""
    fe = straight_beam((0, 0, 0), (2.0, 0, 0), rectangle(0.1, 0.05, 2e11, 0.3, 7800.0), 3)
    body = craig_bampton(fe, [(0, "full"), (3, "full")], 1)
    new, old = tmp_path / "new.npz", tmp_path / "old.npz"
    save_body(body, new)
    with np.load(new) as file:
        arrays = {name: file[name] for name in file.files if name != "notes"}
        notes = json.loads(str(file["notes"]))
    for name in ("fibres", "offsets"):
        arrays[f"recovery.stress/0/{name}"] = arrays[f"recovery.stress/0/{name}"][:, 0]
    del arrays["recovery.stress/0/flexibility"]
    del notes["body"]["recovery.stress"][0]["fields"]["flexibility"]
    notes["checksums"] = {}
    np.savez(old, notes=np.array(json.dumps(notes)), **arrays)
    file = read_body_file(old)
    stress, wanted = file.parts["recovery"].stress[0], body.recovery.stress[0]
    assert np.array_equal(stress.fibres, wanted.fibres)
    assert np.array_equal(stress.offsets, wanted.offsets)
    u = np.random.default_rng(1).normal(size=(4, 6, 1))
    assert np.array_equal(stress.stress(u), wanted.stress(u))
    with pytest.raises(InputError, match="section strains are unknown: the body file was written"):
        stress.section_strains(u)
