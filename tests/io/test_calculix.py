"""Bodies of CalculiX's matrices."""

import shutil
import subprocess

import numpy as np
import pytest
from scipy.linalg import eigh

from sebody import InputError
from sebody.io import import_body, load_body, read_fe_model
from sebody.io.registry import read_source

INTERFACES = {"root": "900001/900002", "tip": "900003/900004"}
# of an independent reduction of the same files
MASS = 9.9277
PAIRS = (2.5276, 6.9547, 13.633, 22.431)
WHOLE = (2.526497, 6.948004, 13.57536, 22.34396)    # CalculiX, full model: freq.dat


def hertz(body):
    squares = eigh(body.stiffness, body.mass, eigvals_only=True)
    return np.sqrt(np.abs(squares[6:])) / (2 * np.pi)


def test_the_beam_is_reduced_in_seconds(beam_import):
    body, path, seconds = beam_import
    assert seconds < 5.0
    assert body.total_mass == pytest.approx(MASS, abs=5e-5)         # as it is printed
    np.testing.assert_allclose(hertz(body)[:8:2], PAIRS, atol=5e-4)
    np.testing.assert_allclose(hertz(body)[:8:2], hertz(body)[1:8:2], rtol=1e-6)
    # from above: a reduction is stiffer than the model
    assert (hertz(body)[:8:2] > WHOLE).all()
    np.testing.assert_allclose(body.coordinates, [[0, 0, 0], [141.42, 0, 0]])
    np.testing.assert_array_equal(load_body(path).mass, body.mass)


def test_rigid_motion_is_as_free_as_the_digits_allow(beam_body):
    force = np.abs(beam_body.stiffness @ beam_body.rigid_modes).max()
    assert force / np.abs(beam_body.stiffness).max() == pytest.approx(2.5e-7, rel=0.1)


def test_rows_of_reference_nodes_are_theirs(beam_deck):
    reading = read_source(beam_deck)
    model = reading.model
    assert model.stiffness.shape == (2109, 2109)
    assert reading.rotation_nodes == {900002: 900001, 900004: 900003}
    # line 2104 of the .dof is 900001.1, the rotations follow as 900002.1 to 3
    node = model.node(900001)
    lines = (beam_deck.with_suffix(".dof")).read_text().split()
    assert [lines[row] for row in model.dofs(node)] == [
        "900001.1", "900001.2", "900001.3", "900002.1", "900002.2", "900002.3"]
    kind, cells = model.cells[0]
    assert (kind, cells.shape) == ("hexahedron20", (96, 20))
    assert len(model.node_set("FACEA")) == 21


def test_mass_of_tied_faces_has_points(beam_deck, beam_body):
    """The faces' 21 nodes are not in the matrices; their moments are."""
    model = read_fe_model(beam_deck)
    defect = abs(model.mass_field.matrix() - model.mass).max()
    assert defect < 1e-12 * abs(model.mass).max()
    inertia = beam_body.invariants.about((70.71, 0.0, 0.0)).J0
    # of a prism of square section about its middle; matrices of quadratic elements are exact
    side, length, mass = 3.0, 141.42, MASS
    along, across = mass * side**2 / 6, mass * (length**2 + side**2) / 12
    np.testing.assert_allclose(inertia, np.diag([along, across, across]), rtol=2e-6,
                               atol=1e-5 * along)


def test_faces_are_tied_here_as_well(beam_deck):
    """A mean of a face in the middle adds no stiffness: the free beam keeps its frequencies."""
    model = read_fe_model(beam_deck)
    x = model.coordinates[:, 0]
    middle = np.flatnonzero(np.isclose(x, 70.71) & (model.rows[:, 0] >= 0))
    deck = beam_deck.read_text()
    listed = ",\n".join(str(model.labels[node]) for node in middle)
    changed = beam_deck.with_name("se2.inp")
    changed.write_text(deck.replace("*STEP", f"*NSET, NSET=MID\n{listed}\n*STEP", 1))
    for suffix in (".sti", ".mas", ".dof"):
        shutil.copy(beam_deck.with_suffix(suffix), changed.with_suffix(suffix))
    body = import_body(changed, {**INTERFACES, "middle": "rbe3-equal:mid"}, 8)
    assert body.keeps == ("full",) * 3
    np.testing.assert_allclose(body.coordinates[2], (70.71, 0, 0), atol=1e-9)
    found = hertz(body)[:4:2]
    assert (found > WHOLE[:2]).all() and (found < PAIRS[:2]).all()


def test_beams_that_become_solids_are_refused(tmp_path):
    (tmp_path / "b.inp").write_text("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 2, 0, 0\n")
    # as ccx 2.20 begins the .dof of B32 elements: the nodes of their solids share labels
    (tmp_path / "b.dof").write_text("1.1\n1.2\n1.3\n1.1\n1.2\n1.3\n")
    with pytest.raises(InputError, match=r"b\.dof, line 4: label 1\.1 is that of line 1, too: "
                                         "CalculiX makes solids of beams and shells"):
        read_fe_model(tmp_path / "b.inp")


DECK = """*NODE, NSET=ALL
11, 0, 0, 0
12, 1, 0, 0
13, 1, 1, 0
14, 0, 1, 0
15, 0, 0, 2
16, 1, 0, 2
17, 1, 1, 2
18, 0, 1, 2
*NODE
1, 0.5, 0.5, 2
2, 0.5, 0.5, 2
*ELEMENT, TYPE=C3D8, ELSET=E
1, 11, 12, 13, 14, 15, 16, 17, 18
*NSET, NSET=TOP, GENERATE
15, 18
*RIGID BODY, NSET=TOP, REF NODE=1, ROT NODE=2
*MATERIAL, NAME=M
*ELASTIC
1E4, 0.3
*DENSITY
3.0
*SOLID SECTION, ELSET=E, MATERIAL=M
*STEP
*FREQUENCY, SOLVER=MATRIXSTORAGE
*END STEP
"""


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_a_fresh_run_of_calculix(tmp_path):
    (tmp_path / "job.inp").write_text(DECK)
    subprocess.run(["ccx", "-i", "job"], cwd=tmp_path, check=True, capture_output=True)
    body = import_body(tmp_path / "job.inp", {"top": "1/2", "corner": 11}, 2)
    assert body.keeps == ("full", "translation")
    assert body.total_mass == pytest.approx(6.0, rel=1e-12)
    np.testing.assert_allclose(body.centre_of_mass, (0.5, 0.5, 1.0), atol=1e-12)
