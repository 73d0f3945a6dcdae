"""Even motions of a symmetric body are those of a body reduced in the plane."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from sebody import InputError
from sebody.fem import Section, frame, hexahedral_block, planar_beam, straight_beam
from sebody.reduction import RigidFace, craig_bampton
from sebody.reduction.plane import planar_body

TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
SHAPE = {"area": 9.0, "torsion": 9.0, "youngs_modulus": 2.1e6, "poisson_ratio": 0.3,
         "density": 7.8e-3, "shear_factor": 5 / 6}
# bending frequencies of the first are pairs, of the second not, and the third bends easily out of
# the plane
SECTIONS = {name: Section(inertia_y=y, inertia_z=6.75, **SHAPE)
            for name, y in (("square", 6.75), ("flat", 4.0), ("thin", 0.05))}
ENDS = np.array([[1.0, -2.0], [90.0, 60.0]])


def close(found: np.ndarray, expected: np.ndarray, limit: float) -> bool:
    return np.abs(found - expected).max(initial=0.0) <= limit * np.abs(expected).max(initial=1e-300)


@pytest.mark.parametrize("section", SECTIONS)
def test_a_beam_is_one_reduced_in_the_plane(section):
    """In any position, with its load modes and resultants of second order."""
    section, lift = SECTIONS[section], np.array([0.0, 0.0, 7.0])
    ends = [TURN @ (*end, 0.0) + lift for end in ENDS]
    spatial = straight_beam(*ends, section, 10, up=TURN @ (-1, 1, 0))
    load = np.zeros(spatial.stiffness.shape[0])
    load[spatial.rows[4]] = [*(TURN @ (3.0, 5.0, 0.0)), *(TURN @ (0.0, 0.0, 40.0))]
    body = craig_bampton(spatial, [(0, "full"), (10, "full")], 6, loads={"wind": load}).damped(0.02)
    made = planar_body(body, TURN)

    plane = planar_beam(*ENDS, section, 10)
    load = np.zeros(plane.stiffness.shape[0])
    load[plane.rows[4]] = 3.0, 5.0, 40.0
    expected = craig_bampton(plane, [(0, "full"), (10, "full")], made.body.modes,
                             loads={"wind": load}).damped(0.02)
    assert made.body.keeps == expected.keeps and 0 < made.body.modes < 6
    shift = made.body.coordinates - ENDS
    assert close(shift, shift[:1], 1e-12)
    held = 6                            # signs of modes are free: they are compared by size
    for name in ("stiffness", "mass"):
        assert close(np.abs(getattr(made.body, name)), np.abs(getattr(expected, name)), 1e-10), name
    assert close(made.body.damping[:held, :held], expected.damping[:held, :held], 1e-8)
    assert close(made.body.loads["wind"][:held], expected.loads["wind"][:held], 1e-10)
    own, others = made.body.invariants.about(made.body.coordinates[0]), (
        expected.invariants.about(ENDS[0]))
    for name in ("mass", "c0", "S1", "J0", "g", "h"):
        found, wanted = (np.atleast_1d(getattr(one, name)) for one in (own, others))
        assert close(found[..., :held], wanted[..., :held], 1e-9), name
    assert own.slaved >= others.slaved and own.resultants >= others.resultants
    # what a stretch changes; which weak resultants are left out differs between the two
    stretch = np.array([*(ENDS[0] - ENDS[1]), *(ENDS[1] - ENDS[0]), 0, 0]) * 1e-3

    def softened(one):
        force = one.lam * (one.E[:held].T @ stretch)
        return np.tensordot(force, one.Ghat[:, :held, :held], 1)
    assert close(softened(own), softened(others), 1e-3)
    shapes, wanted = (one.recovery.shapes[:, :held] for one in (made.body, expected))
    assert close(shapes, wanted, 1e-9)


@pytest.mark.parametrize("normal", [1, 2])
def test_a_solid_has_the_frequencies_of_its_even_modes(normal):
    """In both planes of symmetry of a block: together the even and odd ones are all there are."""
    fe_model = hexahedral_block((0, 0, 0), (30.0, 4.0, 3.0), (5, 2, 2), 2.1e6, 0.3, 7.8e-3)
    x = fe_model.coordinates[:, 0]
    faces = [(RigidFace((end, 2.0, 1.5), np.flatnonzero(np.isclose(x, end))), "full")
             for end in (0.0, 30.0)]
    body = craig_bampton(fe_model, faces, 6)
    axes = np.roll(np.eye(3), -1 - normal, axis=1)       # columns; the last one is the normal
    assert np.array_equal(axes[:, 2], np.eye(3)[normal])
    made = planar_body(body.rotated(TURN), TURN @ axes).body
    values, shapes = eigh(body.stiffness, body.mass)
    mirror = np.ones(12)
    mirror[[normal, 3 + normal]] = -1.0                  # displacements along the normal
    mirror[[6 + k for k in range(3) if k != normal]] = -1.0
    mirror[[9 + k for k in range(3) if k != normal]] = -1.0
    odd = [np.abs(shape[:12][mirror < 0]).max() for shape in shapes.T]
    even = [np.abs(shape[:12][mirror > 0]).max() for shape in shapes.T]
    expected = values[np.array(even) > 1e3 * np.array(odd)][-len(made.mass) + 3:]
    found = eigh(made.stiffness, made.mass, eigvals_only=True)[3:]
    assert np.allclose(found, expected[-len(found):], rtol=1e-8)


def test_a_body_off_its_plane_is_refused():
    """A block held at its edge: the plane through these nodes is none of symmetry."""
    fe_model = hexahedral_block((0, 0, 0), (30.0, 4.0, 3.0), (5, 2, 2), 2.1e6, 0.3, 7.8e-3)
    x = fe_model.coordinates[:, 0]
    faces = [(RigidFace((end, 2.0, 0.0), np.flatnonzero(np.isclose(x, end))), "full")
             for end in (0.0, 30.0)]
    body = craig_bampton(fe_model, faces, 4)
    with pytest.raises(InputError, match="couples .* of node ., in the plane, with .* out of it"):
        planar_body(body, np.eye(3))
    assert planar_body(body, np.roll(np.eye(3), -2, axis=1)).body.modes > 0


def test_load_modes_depend_on_no_axes():
    """A frame of whose load cases those of little strain energy are left out, in any FE axes."""
    section = Section(area=4e-4, inertia_y=1.3e-8, inertia_z=1.8e-8, torsion=2.3e-8,
                      youngs_modulus=2e9, poisson_ratio=0.3, density=3000.0)
    points = np.array([[0.0, 0.0, 0.0], [1.1, 0.0, 0.0], [1.2, 1.2, 0.0]])
    made = []
    for axes in (np.eye(3), TURN):
        fe_model = frame(points @ axes.T, [(0, 2), (2, 1)], section, 3, up=axes[:, 2])
        body = craig_bampton(fe_model, [(0, "full"), (1, "full")], 4)
        assert body.invariants.slaved == 9          # of 12, of which one has no strain energy
        made.append(planar_body(body, axes).body.invariants)
    n = 6                                           # boundary coordinates: modes have either sign
    second = [np.einsum("aij,ab,bkl->ijkl", i.Q[:, :n, :n], i.Mbar[-i.slaved:, -i.slaved:],
                        i.Q[:, :n, :n]) for i in made]
    assert close(second[1], second[0], 1e-8)
