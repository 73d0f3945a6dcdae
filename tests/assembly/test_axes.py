"""Forces that hold positions are solved for in the axes of these: one factorization serves long."""

import numpy as np
import pytest

from sebody import Model, generalized_alpha, simulate
from sebody.fem import Section
from sebody.runs.simulation import Simulation

SECTION = Section(area=9e-4, inertia_y=6.75e-8, inertia_z=5e-8, torsion=1e-7, youngs_modulus=2.1e11,
                  poisson_ratio=0.3, density=7.8e3)
H = 2e-3


def arms(explicit, planar):
    """A beam in a hinge, and one hinged to its end, in general position, swinging."""
    model = Model(planar=planar)
    start, middle, end = np.array([[0.4, -1.1, 0.6], [1.1, -0.8, 0.9],
                                   [1.5, -0.1, 0.7]])[:, :2 if planar else 3]
    axis = (0, 0, 1) if planar else (0.3, -0.2, 0.9)
    model.fix(model.node("ground", start))
    base, tip = model.node("base", start), model.node("tip", middle)
    model.beam("upper", (base, tip), SECTION, 6, 1, 3)
    other, free = model.node("other", middle), model.node("free", end)
    model.beam("lower", (other, free), SECTION, 6, 1, 2)
    model.revolute(base, axis, to="ground", explicit=explicit, name="hinge")
    model.revolute(other, axis, to=tip, explicit=explicit, name="elbow")
    model.gravity((0.5, -9.81) if planar else (0.5, -9.81, 1.0))
    return model


def arm(explicit, planar, ground_first=True):
    """The first of these beams alone, spinning."""
    model = Model(planar=planar)
    start, middle = np.array([[0.4, -1.1, 0.6], [1.1, -0.8, 0.9]])[:, :2 if planar else 3]
    axis = np.array([0, 0, 1.0] if planar else [0.3, -0.2, 0.9])
    for name in ("ground", "base") if ground_first else ("base", "ground"):
        model.node(name, start)
    model.fix("ground")
    model.beam("upper", ("base", model.node("tip", middle)), SECTION, 6, 1, 3)
    model.revolute("base", axis, to="ground", explicit=explicit, name="hinge")
    spin = 6.0 * axis / np.linalg.norm(axis)
    model.rigid_velocity((0, 0) if planar else (0, 0, 0), spin[2] if planar else spin,
                         about=start)
    return model


@pytest.mark.parametrize("ground_first", [True, False])
@pytest.mark.parametrize("planar", [True, False])
def test_equations_of_a_hinge_take_no_more_matrices_than_a_shared_position(planar, ground_first):
    counts = []
    for explicit in (False, True):
        run = Simulation(arm(explicit, planar, ground_first), H)
        run.run_to(2.0)             # nearly two revolutions
        counts.append([run.numbering.free, run.state.control.iterations,
                       run.state.control.matrices])
    (few, fewest, shared), (many, iterations, matrices) = counts
    assert many > few
    assert iterations <= 1.15 * fewest
    assert matrices <= shared + 10


@pytest.mark.parametrize("planar", [True, False])
def test_the_force_of_the_equations_is_that_of_the_joint_in_global_axes(planar):
    scheme = generalized_alpha(tolerance=1e-12)     # forces, to a few digits less
    expected, found = (simulate(arms(explicit, planar), H, 0.4, scheme)
                       for explicit in (False, True))
    for name in ("hinge.force", "elbow.force", "free.position"):
        size = np.abs(expected[name]).max()
        assert np.abs(found[name] - expected[name]).max() < 1e-6 * size, name


def test_two_points_on_an_axis_share_the_force_along_it():
    """Multipliers of least norm, one in the axes of the beam and one in global axes."""
    axis = np.array([0.3, -0.2, 0.9]) / np.linalg.norm([0.3, -0.2, 0.9])
    start, middle = np.array([[0.4, -1.1, 0.6], [1.1, -0.8, 0.9]])
    model = Model()
    base, tip = model.node("base", start), model.node("tip", middle)
    model.beam("door", (base, tip), SECTION, 6, 1, 3)
    for k, point in enumerate((start, start + 0.4 * axis)):
        model.fix(model.node(f"ground {k}", point))
    model.spherical(base, "ground 0", name="lower")
    model.spherical(model.attach("upper point", start + 0.4 * axis, base), "ground 1",
                    name="upper")
    model.rigid_velocity((0, 0, 0), 3.0 * axis, about=start)
    model.gravity((0.5, -9.81, 1.0))
    result = simulate(model, H, 1.0)
    along = [result[f"{name}.force"] @ axis for name in ("lower", "upper")]
    assert np.abs(along[0]).min() > 1.0
    assert np.abs(along[0] - along[1]).max() < 1e-5 * np.abs(along[0]).max()


@pytest.mark.parametrize("planar", [True, False])
def test_velocities_are_fitted_where_the_axes_have_turned(planar):
    start, model = simulate(arms(True, planar), H, 0.4), arms(True, planar)
    given = np.array([0.3, 0.8, -0.5][:2 if planar else 3])
    model.initial_velocity("tip", given)
    result = simulate(model, H, H, start=start)
    before = np.linalg.norm(start["other.velocity"][-1] - given)
    assert before > 0.5         # what the elbow's equations have to change
    assert np.abs(result["tip.velocity"][0] - given).max() < 1e-6 * before
    assert np.abs(result["other.velocity"][0] - result["tip.velocity"][0]).max() < 1e-9 * before
