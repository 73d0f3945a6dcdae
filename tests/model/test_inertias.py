"""The inertia option and the stiffening that a superelement gets from what its body knows."""

from dataclasses import replace

import numpy as np
import pytest

from sebody import InputError, Model
from sebody.assembly.batches import make_batches
from sebody.assembly.body_constants import superelement_constants
from sebody.assembly.numbering import number
from sebody.fem import FEModel, Section, frame, straight_beam
from sebody.reduction import craig_bampton

SECTION = Section(area=4e-4, inertia_y=1.3e-8, inertia_z=2.6e-8, torsion=2e-8,
                  youngs_modulus=2e11, poisson_ratio=0.3, density=7800.0, shear_factor=5 / 6)
ENDS = (0.3, -0.1, 0.2), (0.9, 0.4, 0.5)


def beam():
    return straight_beam(*ENDS, SECTION, 4)


def unstressed():
    """Nobody gave the geometric stiffness."""
    return replace(beam(), geometric_stiffness=None)


def matrices():
    """Nor what the mass is made of."""
    full = beam()
    return FEModel(full.stiffness, full.mass, full.coordinates, full.node_dofs)


def placed(fe_model, **options):
    model = Model()
    nodes = [model.node(name, end) for name, end in zip("ab", ENDS, strict=True)]
    body = craig_bampton(fe_model, [(0, "full"), (4, "full")], 2)
    return model.superelement("arm", body, nodes, **options)


@pytest.mark.parametrize("fe_model, options, expected", [
    (beam, {}, ("floating_field", True)),
    (unstressed, {}, ("floating_field", False)),
    (matrices, {}, ("rigid_part", False)),
    (beam, {"frame": "node"}, ("floating_field", True)),
    (beam, {"frame": "mean"}, ("material", False)),
    (beam, {"frame": "mean_small"}, ("material", False)),
    (beam, {"stiffening": False}, ("floating_field", False)),
    (beam, {"stiffening": True}, ("floating_field", True)),
    (beam, {"inertia": "material"}, ("material", False)),
    (beam, {"inertia": "frame_axes", "stiffening": False}, ("frame_axes", False)),
    (unstressed, {"inertia": "floating_field"}, ("floating_field", False)),
    (matrices, {"stiffening": False}, ("rigid_part", False)),
    (matrices, {"frame": "mean"}, ("material", False)),
    (matrices, {"inertia": "material"}, ("material", False))])
def test_what_a_body_gets(fe_model, options, expected):
    body = placed(fe_model(), **options)
    assert (body.inertia, body.stiffening) == expected


def test_a_body_on_positions_alone():
    points = np.array([[0.0, 0, 0], [0.6, 0, 0], [0.6, 0.4, 0]])
    body = craig_bampton(frame(points, [(0, 1), (1, 2)], SECTION, 4),
                         [(k, "translation") for k in range(3)], 1)
    model = Model()
    nodes = [model.node(f"n{k}", p, "translation") for k, p in enumerate(points)]
    body = model.superelement("arm", body, nodes, frame="positions")
    assert (body.inertia, body.stiffening) == ("floating_field", True)


@pytest.mark.parametrize("fe_model, options, message", [
    (unstressed, {}, "'arm': stiffening needs a geometric stiffness, and the FE model of the body "
                     r"has none, or a negligible one: give it as FEModel\(geometric_stiffness"),
    (matrices, {}, "'arm': stiffening needs the mass, modes and geometric stiffness of the FE "
                   "model, and the body has reduced matrices alone: reduce it from a model, or"),
    (beam, {"inertia": "material"}, "'arm': stiffening is a part of inertia 'floating_field', not "
                                    "of 'material': leave"),
    (beam, {"frame": "mean"}, "'arm': stiffening needs a frame that depends on the state alone, "
                              "which 'mean' does not: use one of converged_mean, mean_axes, node, "
                              "positions")])
def test_stiffening_that_cannot_be_had(fe_model, options, message):
    with pytest.raises(InputError, match=message):
        placed(fe_model(), stiffening=True, **options)


@pytest.mark.parametrize("elements, bodies, asked, expected", [
    (4, 4, None, False), (4, 2, None, True), (1, 1, None, False), (4, 4, True, True),
    (4, 1, False, False)])
def test_beams_of_one_element_do_not_stiffen_unless_asked(elements, bodies, asked, expected):
    model = Model()
    nodes = [model.node(name, end) for name, end in zip("ab", ENDS, strict=True)]
    model.beam("arm", nodes, SECTION, elements, bodies, stiffening=asked)
    assert [(b.inertia, b.stiffening)
            for b in model.bodies.values()] == [("floating_field", expected)] * bodies


def test_without_stiffening_a_body_is_one_without_geometric_stiffness():
    """The same constants, those of stiffening left out."""
    one, other = placed(beam(), stiffening=False), placed(unstressed())
    found, expected = superelement_constants(one), superelement_constants(other)
    assert superelement_constants(placed(beam()))["sizes"][:2] != [0, 0]
    assert found.keys() == expected.keys() and found["sizes"] == [0, 0, 0]
    for name, values in expected.items():
        assert np.shape(found[name]) == np.shape(values)
        # sums over the same points in another order
        largest = np.max(np.abs(values), initial=0.0)
        assert np.allclose(found[name], values, rtol=1e-12, atol=1e-12 * largest)


def test_equal_bodies_of_which_one_stiffens_have_constants_of_their_own():
    model = Model()
    body = craig_bampton(beam(), [(0, "full"), (4, "full")], 2)
    for k, stiffening in enumerate((True, False, True)):
        nodes = [model.node(f"{name}{k}", end) for name, end in zip("ab", ENDS, strict=True)]
        model.superelement(f"arm {k}", body, nodes, stiffening=stiffening)
    starts = [row[0] for batch in make_batches(model, number(model)).all for row in batch.rows]
    assert starts[0] == starts[2] != starts[1]
