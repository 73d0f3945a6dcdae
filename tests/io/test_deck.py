"""Decks as users write them: what they give stresses, stiffening and exact inertia, and why not.

The stiffness that CalculiX has computed tells whether mesh, materials, axes and ties were read
right: forces of our stresses must be those of its matrix.
"""

import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from sebody import InputError
from sebody.io import import_body, read_fe_model
from sebody.io.deck.materials import DeckMaterial, read_elastic, turned_law
from sebody.io.deck.reading import read_deck
from sebody.io.registry import read_source
from sebody.io.tied import tied_mass_field

DECKS = {"tied": [("hexahedron20", 6), ("wedge", 24)], "laminate": [("tetra10", 18)] * 2,
         "loose": [("hexahedron", 4)], "hole": [("tetra10", 108)]}
FACES = {"left": "rbe2:LEFT", "right": "rbe2:RIGHT"}


@pytest.mark.parametrize("name", DECKS)
def test_stresses_make_the_forces_of_the_matrix(decks, name):
    """Parts of several kinds and materials, sets of sets, ties, masses, orthotropic axes."""
    model = read_fe_model(decks / f"{name}.inp")
    assert [(one.kind, len(one.nodes)) for one in model.stress] == DECKS[name]
    assert not model.missing and model.mass_field is not None
    u = np.random.default_rng(3).standard_normal(model.stiffness.shape[0])
    wanted = model.stiffness @ u
    found = model.geometric_stiffness.forces(u)
    # coordinates have twelve digits, those of 1e4 eight behind the point
    np.testing.assert_allclose(found, wanted, atol=1e-7 * np.abs(wanted).max())


@pytest.mark.parametrize("name", DECKS)
def test_nodes_without_rows_follow_the_others(decks, name):
    """Of a rigid motion every node that an element has moves with the body."""
    model = read_fe_model(decks / f"{name}.inp")
    middle = model.coordinates.mean(axis=0)
    rng = np.random.default_rng(4)
    shift, turn = rng.standard_normal((2, 3))
    rigid = shift + np.cross(turn, model.coordinates - middle)
    dofs = np.zeros(model.stiffness.shape[0])
    own = model.rows >= 0
    whole = np.hstack([rigid, np.broadcast_to(turn, rigid.shape)])[:, :model.rows.shape[1]]
    dofs[model.rows[own]] = whole[own]
    moved = model.by_nodes(dofs[:, None]).reshape(len(rigid), -1)[:, :3]
    used = np.unique(np.concatenate([nodes.ravel() for _, nodes in model.cells]))
    assert name != "tied" or not own[used].all()
    np.testing.assert_allclose(moved[used], rigid[used], atol=1e-9)


def test_a_tied_body_has_everything(decks):
    body = import_body(decks / "tied.inp", FACES, 2)
    assert body.invariants.stiffens and body.recovery.stress and not body.cautions
    # of the drawing: 8 x 10 x 30 and 8 x 10 x 20, and the *MASS
    assert body.total_mass == pytest.approx(2400 * 7.85e-9 + 1600 * 2.7e-9 + 4e-6, rel=1e-9)
    assert "no " not in body.summary()


def test_rotations_of_nodes_that_calculix_makes(decks):
    """*RIGID BODY without ROT NODE, and *KINEMATIC: in another order than the cards."""
    reading = read_source(decks / "loose.inp")
    assert reading.rotation_nodes == {}
    body = import_body(decks / "loose.inp", {"left": 800, "right": 900})
    assert body.keeps == ("full", "full")
    with pytest.raises(InputError, match=r"loose\.dof, line 43: node 901 is not in the deck .*: "
                                         "give files of one run of ccx"):
        read_source(changed(decks, "loose", ("*RIGID BODY, NSET=RIGHT, REF NODE=900\n", ""),
                            ("*COUPLING", "*NONE"), ("*KINEMATIC\n", "*NONE\n")))


def changed(decks, name, *changes):
    """A deck with other texts beside the same matrices."""
    folder = decks.parent / "changed"
    folder.mkdir(exist_ok=True)
    for suffix in (".sti", ".mas", ".dof"):
        shutil.copy(decks / f"{name}{suffix}", folder)
    text = (decks / f"{name}.inp").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / f"{name}.inp"
    path.write_text(text)
    return path


SECTION = "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n"


@pytest.mark.parametrize("sets", [
    "*ELSET, ELSET=ROD\n1, 2,\n3, 4\n",
    "*ELSET, ELSET=ROD, GENERATE\n1, 3, 2\n2, 4, 2\n",
    "*ELSET, ELSET=HALF\n1, 2\n*ELSET, ELSET=rod\nhalf, 3\n 4,\n",
    "*ELSET, ELSET=ROD\nLater, 1\n*ELSET, ELSET=LATER\nALL\n",
    "*ELSET, ELSET=\"ROD\"\nALL\n",
    "*ELSET,ELSET=ROD\nALL,\n** the section follows\n",
])
def test_sections_of_listed_elements(decks, sets):
    """As gmsh writes them: the elements in one set, the section on another that lists them."""
    path = changed(decks, "loose", ("ELSET=ALL\n1,", "ELSET=Volume1\n1,"), (
        SECTION, sets.replace("ALL", "VOLUME1") + "*SolidSection, MATERIAL=Steel ,\n ELSET=Rod\n"))
    body = import_body(path, {"left": 800, "right": 900})
    assert body.recovery.stress and body.invariants.stiffens and not body.cautions


@pytest.mark.parametrize(("old", "new", "what", "why"), [
    (SECTION, "", "stresses or stiffening", r"4 of 4 elements \(C3D8\) are in no \*SOLID SECTION"),
    (SECTION, "*ELSET, ELSET=SOME\n2, 3\n" + SECTION.replace("ALL", "SOME"),
     "stiffening", "2 of 4 elements"),
    (SECTION, SECTION.replace("STEEL", "IRON"), "stresses or stiffening",
     "4 of 4 elements have the material IRON, which the deck does not have"),
    ("*ELASTIC\n2.1E5, 0.3\n", "", "stresses or stiffening",
     r"have the material STEEL, which has no \*ELASTIC"),
    ("*ELASTIC\n2.1E5, 0.3\n", "*ELASTIC, TYPE=SHEAR\n1.\n", "stresses or stiffening",
     r"STEEL, which has \*ELASTIC, TYPE=SHEAR, which is not read"),
    ("2.1E5, 0.3\n", "2.1E5, 0.3, 20.\n1.9E5, 0.3, 200.\n", "stresses or stiffening",
     r"STEEL, which has an \*ELASTIC that depends on temperature"),
    (SECTION, SECTION.replace("STEEL", "STEEL, ORIENTATION=OR"), "stresses or stiffening",
     "have the orientation OR, which the deck does not have"),
    (SECTION, "*ELEMENT, TYPE=US3, ELSET=SHELL\n77, 1, 2, 3\n" + SECTION,
     "stiffening, and no stresses in some",
     "1 of 5 elements are US3, which are not known solids"),
    ("2.1E5, 0.3\n", "2.1E4, 0.3\n", "stresses or stiffening",
     r"differs from that of the stiffness by 90\.0%: the deck is not that of the matrices"),
    ("2.1E5, 0.3\n", "1.6E5, 0.3\n", "stresses or stiffening",
     r"differs from that of the stiffness by 23\.8%: the deck is not that of the matrices"),
    (SECTION, "*ELEMENT, TYPE=SPRINGA, ELSET=SP\n77, 1, 20\n" + SECTION
     + "*MATERIAL, NAME=STEEL\n*ELASTIC\n1.9E5, 0.3\n", "stiffening",
     r"by 9\.5%, as SPRINGA have a stiffness of their own"),
])
def test_what_is_missing_has_its_true_reason(decks, old, new, what, why):
    body = import_body(changed(decks, "loose", (old, new)), {"left": 800, "right": 900})
    said = " ".join(body.cautions)
    assert f"no {what}" in said
    assert re.search(why, said), said
    assert said in body.summary() and "correct the deck and import again" in said


def test_stresses_are_kept_where_they_are_known(decks):
    path = changed(decks, "loose", (SECTION, "*ELSET, ELSET=SOME\n2, 3\n"
                                    + SECTION.replace("ALL", "SOME")))
    body = import_body(path, {"left": 800, "right": 900})
    assert sum(len(one.nodes) for one in body.recovery.stress) == 2
    assert body.cautions[0].startswith("no stiffening, and no stresses in some elements: 2 of 4")


def test_stresses_of_masses_and_springs_are_not_missed(decks):
    """Elements that have no stress do not take that of others."""
    extra = ("*ELEMENT, TYPE=SPRINGA, ELSET=SP\n77, 1, 2\n*SPRING, ELSET=SP\n\n1E-9\n"
             "*ELEMENT, TYPE=MASS, ELSET=M\n78, 1\n*MASS, ELSET=M\n0.\n")
    body = import_body(changed(decks, "loose", (SECTION, extra + SECTION)),
                       {"left": 800, "right": 900})
    assert not body.cautions


@pytest.mark.parametrize(("old", "new", "said"), [
    (SECTION, SECTION + "*BOUNDARY\nRIGHT, 1, 3\n",
     r"loose\.inp, line \d+: \*BOUNDARY holds nodes, .*: take it out and run ccx again"),
    ("TYPE=C3D8,", "TYPE=C3D8I,", r"line 22: CalculiX gives the incompatible modes of C3D8I rows "
                                  r"and masses .*: use C3D20R, C3D20 or C3D10"),
    ("TYPE=C3D8,", "TYPE=S8R,", r"line 22: CalculiX makes solids of beams, shells and plane "
                                r"elements \(S8R\), .*: use solids"),
    ("TYPE=C3D8,", "TYPE=B31,", r"makes solids of beams, shells and plane elements \(B31\)"),
    ("TYPE=C3D8,", "TYPE=CPS6,", "delete elements of surfaces and lines that the mesher has"),
    ("*NSET, NSET=RIGHT\n", "*NSET, NSET=RIGHT\nRIGHT, ", "node set RIGHT has itself as a member"),
    ("*NSET, NSET=RIGHT\n", "*NSET, NSET=RIGHT\nFAR, ", "'FAR' is neither a label nor a set of "
                                                        "nodes"),
    ("*SURFACE, NAME=LEFT\n1, S6\n", "*SURFACE, NAME=LEFT\n1, S7\n",
     "there is no face 'S7' of the element: give S1 to S6"),
    ("*SURFACE, NAME=LEFT\n1, S6\n", "*SURFACE, NAME=LEFT\n9, S1\n",
     "element 9 of the surface is not a solid of the deck"),
    ("2.1E5, 0.3\n", "2.1E5, 0.5\n", r"has the numbers 210000, 0\.5, which give some strain"),
    ("*ELASTIC\n", "*ELASTIC, TYPE=ORTHO\n", r"\*ELASTIC, TYPE=ORTHO has 2 numbers: give 9"),
    (SECTION, "*ORIENTATION, NAME=O\n1,0,0,2,0,0\n" + SECTION, "which define no axes: give two"),
    (SECTION, "*ELSET, ELSET=A, GENERATE\n1, 4, 0\n" + SECTION, "the step of GENERATE is 0"),
    (SECTION, "*ELSET, ELSET=A, GENERATE\n1, 2000000000\n" + SECTION,
     "GENERATE from 1 to 2000000000 makes 2000000000 labels, more than"),
    ("3, 9, 13, 15, 11, 10, 14, 16, 12", "3, 9, 11, 15, 13, 10, 12, 16, 14",
     "element 3 of the deck is inverted or has no volume: correct the order"),
    (SECTION, "*TIE, NAME=T\nLEFT, NEAR\n" + SECTION, r"\*TIE of surface NEAR, which does not "
                                                      r"exist"),
])
def test_refused_with_the_true_reason(decks, old, new, said):
    with pytest.raises(InputError, match=said):
        import_body(changed(decks, "loose", (old, new)), {"left": 800, "right": 900})


def test_included_data(decks):
    """Data lines in a file of their own, and more data behind *INCLUDE."""
    folder = decks.parent / "included"
    folder.mkdir()
    text = (decks / "loose.inp").read_text()
    head, rest = text.split("*ELEMENT", 1)
    lines = head.splitlines()[1:]
    (folder / "nodes.txt").write_text("\n".join(lines[:9]) + "\n")
    (folder / "part.inp").write_text('*INCLUDE, INPUT="nodes.txt"\n' + "\n".join(lines[9:]) + "\n")
    path = folder / "loose.inp"
    path.write_text("*NODE\n*include, input = part.inp\n*ELEMENT" + rest)
    assert read_deck(path).nodes == read_deck(decks / "loose.inp").nodes
    path.write_text("*NODE\n*INCLUDE, INPUT=nodes.txt\n" + "\n".join(lines[9:])
                    + "\n*ELEMENT" + rest)
    assert read_deck(path).nodes == read_deck(decks / "loose.inp").nodes
    (folder / "nodes.txt").write_text("1, 2, secret, 3\n")     # of it no text is shown
    with pytest.raises(InputError, match=r"nodes\.txt, line 1: a word is not a number") as caught:
        read_deck(path)
    assert "secret" not in str(caught.value)


def test_files_that_include_others(decks):
    """Twelve deep, with the mark of their byte order before the first line; a circle is refused."""
    folder = decks.parent / "deep"
    folder.mkdir()
    text = (decks / "loose.inp").read_text()
    for k in range(12):
        (folder / f"part{k}.inp").write_bytes(b"\xef\xbb\xbf" + (
            f"*INCLUDE, INPUT=part{k + 1}.inp\n".encode() if k < 11 else text.encode()))
    assert read_deck(folder / "part0.inp").nodes == read_deck(decks / "loose.inp").nodes
    (folder / "part11.inp").write_text("*INCLUDE, INPUT=part4.inp\n")
    with pytest.raises(InputError, match=r"part4\.inp is included by itself: remove the circular"):
        read_deck(folder / "part0.inp")


def test_surfaces_are_node_sets(decks):
    """By faces, by sets of elements with a face or their free surface, by nodes."""
    path = changed(decks, "loose", (SECTION, "*SURFACE, NAME=SKIN\nALL,\n*SURFACE, NAME=TOP\n"
                                    "ALL, S2\n*SURFACE, TYPE=NODE, NAME=POINTS\nRIGHT\n1,\n"
                                    "*NSET, NSET=BLOCK, ELSET=ALL\n" + SECTION))
    model = read_fe_model(path)
    labels = {name: {int(model.labels[node]) for node in nodes}
              for name, nodes in model.node_sets.items()}
    grid = np.arange(1, 21).reshape(5, 2, 2)
    assert labels["TOP"] == set(grid[:, :, 1].ravel())
    assert labels["SKIN"] == labels["BLOCK"] == set(grid.ravel())
    assert labels["LEFT"] == set(grid[0].ravel())
    assert labels["POINTS"] == {1} | set(grid[4].ravel())


def test_anisotropic_laws():
    """Numbers of laws and of engineering constants give each other; a turn is one of tensors."""
    rng = np.random.default_rng(8)
    random = rng.standard_normal((6, 6))
    law = random @ random.T + 6 * np.eye(6)
    order = [0, 1, 2, 5, 4, 3]              # ours of (11, 22, 33, 12, 13, 23)
    decks = law[np.ix_(order, order)]
    material = DeckMaterial()
    read_elastic(material, card("ANISO", [decks[i, j] for j in range(6) for i in range(j + 1)]))
    np.testing.assert_allclose(material.law, law)
    axes = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    axes *= np.sign(np.linalg.det(axes))
    strain = rng.standard_normal((3, 3))
    strain = strain + strain.T
    local = stress_of(law, axes @ strain @ axes.T)
    np.testing.assert_allclose(stress_of(turned_law(law, axes[None])[0], strain),
                               axes.T @ local @ axes)
    E, nu, G = np.array([3.0, 2.0, 1.0]), np.array([0.1, 0.2, 0.3]), np.array([0.5, 0.6, 0.7])
    read_elastic(material, card("ENGINEERING CONSTANTS", [*E, *nu, *G]))
    compliance = np.linalg.inv(material.law)
    np.testing.assert_allclose(np.diag(compliance), 1 / np.array([*E, *G[::-1]]))
    np.testing.assert_allclose(-compliance[[0, 0, 1], [1, 2, 2]] * E[[0, 0, 1]], nu)
    assert material.law is not None and replace(material).lack


def card(kind, numbers):
    from pathlib import Path

    from sebody.io.deck.cards import Card, Row
    rows = [Row(Path("deck"), k, [repr(float(x)) for x in numbers[8 * k:8 * k + 8]])
            for k in range(-(-len(numbers) // 8))]
    return Card(rows[0], "ELASTIC", {"TYPE": kind}, rows)


def stress_of(law, strain):
    pairs = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))
    values = law @ [strain[i, j] * (1 if i == j else 2) for i, j in pairs]
    result = np.zeros((3, 3))
    for value, (i, j) in zip(values, pairs, strict=True):
        result[i, j] = result[j, i] = value
    return result


def test_masses_of_two_rigid_parts_that_share_an_element():
    """Moments of order zero to two of all nodes, from the matrix of free and reference nodes."""
    rng = np.random.default_rng(3)
    places, references = rng.normal(size=(6, 3)), rng.normal(size=(2, 3))
    factor = rng.normal(size=(6, 6))
    masses = factor @ factor.T                  # of two free nodes, then of two parts of two nodes
    T = np.zeros((6, 3, 18))
    T[0, :, :3] = T[1, :, 3:6] = np.eye(3)
    for node in range(2, 6):
        own, arm = 6 * (node // 2), places[node] - references[node // 2 - 1]
        T[node, :, own:own + 3] = np.eye(3)
        T[node, :, own + 3:own + 6] = np.cross(np.eye(3), arm).T
    whole = np.einsum("pin,pq,qim->nm", T, masses, T)
    rows = np.full((4, 6), -1)
    rows[:2, :3], rows[2:] = np.arange(6).reshape(2, 3), np.arange(6, 18).reshape(2, 6)
    field = tied_mass_field(sparse.csc_array(whole), np.vstack([places[:2], references]), rows)
    np.testing.assert_allclose(field.matrix().toarray(), whole, atol=1e-12 * np.abs(whole).max())
    shapes = field.translation.toarray().reshape(-1, 3, 18)
    found = np.einsum("pi,pq,qjn->ijn", field.points, field.mass.toarray(), shapes)
    wanted = np.einsum("pi,pq,qjn->ijn", places, masses, T)
    np.testing.assert_allclose(found, wanted, atol=1e-12 * np.abs(wanted).max())
