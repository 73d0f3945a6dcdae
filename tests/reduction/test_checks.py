"""Every fault of imported matrices is named together with its place and a remedy."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody.basics.errors import InputError, SebodyError
from sebody.fem import Section, straight_beam
from sebody.reduction import ReducedBody, craig_bampton

SECTION = Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 7.8e-3)


@pytest.fixture(scope="module")
def body():
    model = straight_beam([0, 0, 0], [100, 80, 60], SECTION, 10)
    # imported matrices come without constants of inertia, which belong to one mass
    return replace(craig_bampton(model, {0: "full", 10: "full"}, 2), invariants=None)


def changed(matrix, *entries):
    matrix = matrix.copy()
    for row, column, value in entries:
        matrix[row, column] = value
    return matrix


def rounded(matrix, digits):
    """Entries as printed with `digits` significant digits."""
    return np.array([[float(f"{v:.{digits - 1}e}") for v in row] for row in matrix])


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda b: {"stiffness": np.eye(13)}, r"stiffness has shape \(13, 13\); the layout has 14"),
        (lambda b: {"mass": np.zeros(14)}, r"mass has shape \(14,\)"),
        (lambda b: {"coordinates": np.zeros(3)}, r"coordinates have shape \(3,\)"),
        (lambda b: {"coordinates": [[0, 0, 0], [0, np.inf, 0]]}, "coordinates of node 1 are not"),
        (lambda b: {"keeps": ("full",)}, "keeps has 1 entries for 2 boundary nodes"),
        (lambda b: {"keeps": ("full", "both")}, r"keeps\[1\] is 'both'; choose one of full"),
        (lambda b: {"keeps": ("rotation",) * 2}, "no boundary node keeps its position"),
        (lambda b: {"modes": -1}, "modes is -1"),
        (
            lambda b: {"stiffness": changed(b.stiffness, (2, 3, np.nan))},
            r"stiffness\[2, 3\] is nan",
        ),
        (
            lambda b: {"mass": changed(b.mass, (1, 12, 7.0))},
            r"mass is not symmetric: mass\[1, 12\] = 7 .*position y of node 0, mode 0.*mirror",
        ),
        (
            lambda b: {"stiffness": changed(b.stiffness, (8, 8, 1.1 * b.stiffness[8, 8]))},
            r"resists rigid motion: \|K R\| is .* row 8 \(rotation z of node 0\); as of supports",
        ),
        (
            lambda b: {"coordinates": b.coordinates[::-1]},
            "resists rigid motion.*places of nodes, axes .* or the order of rows that are not",
        ),
        (lambda b: {"stiffness": -b.stiffness}, "stiffness has a negative eigenvalue"),
        (
            lambda b: {"stiffness": changed(b.stiffness, (13, 13, -4.0))},
            r"negative eigenvalue, .* of the largest, mostly in row 13 \(mode 1\)",
        ),
        (
            lambda b: {"mass": changed(b.mass, (5, 5, -b.mass[5, 5]))},
            r"mass is indefinite: eigenvalue .* row 5 \(position z of node 1\)",
        ),
        (lambda b: {"mass": np.zeros((14, 14))}, "the body has no mass.*give the FE model"),
        (lambda b: {"mass": np.diag([0.0] * 12 + [1, 1])}, "the body has no mass"),
    ],
)
def test_fault_is_named(body, change, text):
    with pytest.raises(InputError, match=text):
        replace(body, **change(body))


def test_verdict_does_not_depend_on_units(body):
    # Lengths in thousandths, forces unchanged: positions scale by 1e3, rotations do not.
    scale = np.repeat([1e3, 1.0, 1e3], [6, 6, 2])
    grid = np.outer(scale, scale)
    in_millimetres = replace(
        body,
        stiffness=body.stiffness / grid,
        mass=body.mass / grid,
        coordinates=1e3 * body.coordinates,
    )
    # the reduced mass has the rounding of its condensation, EPS times a condition of 2e4
    assert_allclose(in_millimetres.centre_of_mass, [5e4, 4e4, 3e4], rtol=1e-10)


def test_enough_digits_pass_and_too_few_are_reported(body):
    replace(body, stiffness=rounded(body.stiffness, 10))
    with pytest.raises(InputError, match="resists rigid motion.*few digits; export .* 14 digits"):
        replace(body, stiffness=rounded(body.stiffness, 5))


def test_free_point_mass_and_massless_rotation_are_accepted():
    point = ReducedBody(np.zeros((6, 6)), np.diag([2.0] * 3 + [0.0] * 3), [[1, 2, 3]], ("full",))
    assert point.total_mass == 2.0
    assert_allclose(point.centre_of_mass, [1, 2, 3])
    flat = ReducedBody(np.zeros((3, 3)), np.diag([2.0, 2.0, 1.0]), [[1, 2]], ("full",))
    assert flat.planar
    assert_allclose(flat.rigid_modes, [[1, 0, -2], [0, 1, 1], [0, 0, 1]])


def test_matrices_are_copied_symmetrised_and_locked(body):
    source = body.stiffness.copy()
    source[0, 1] *= 1 + 1e-12
    other = replace(body, stiffness=source)
    source[:] = 0.0
    assert np.array_equal(other.stiffness, other.stiffness.T)
    with pytest.raises(ValueError, match="read-only"):
        other.mass[0, 0] = 1.0


def test_what_follows_from_the_matrices_is_locked_and_belongs_to_one_body(body):
    for array in (body.rigid_modes, body.centre_of_mass):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    double = replace(body, mass=2.0 * body.mass)
    assert double.total_mass == 2.0 * body.total_mass
    moved = replace(body, coordinates=body.coordinates + [0.0, 0.0, 7.0])
    assert_allclose(moved.centre_of_mass, body.centre_of_mass + [0.0, 0.0, 7.0], rtol=1e-12)


def test_errors_can_be_caught_as_value_errors():
    assert issubclass(InputError, SebodyError)
    assert issubclass(InputError, ValueError)
