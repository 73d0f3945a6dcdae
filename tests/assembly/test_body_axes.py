"""Axes in which the constants of bodies have the most zeros."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody.analysis import equilibrium, linearize
from sebody.assembly.body_axes import ROUNDING, without_rounding
from sebody.assembly.body_constants import superelement_constants
from sebody.fem import rectangle
from sebody.model.model import Model
from sebody.parameters.table import handle

SECTION = rectangle(6.0, 4.0, youngs_modulus=2.1e5, poisson_ratio=0.3, density=7.85e-9)


@pytest.mark.parametrize("seed", range(12))
def test_constants_of_turned_bodies_are_in_proportion_to_their_mass(seed):
    """With a stiffness the mass has no effect on, zeros included, whatever the directions.

    Moments of inertia across a slender beam are nearly equal, and principal axes as uncertain as
    rounding over their difference; a factor must not move what rounding leaves across a limit.
    """
    turn = Rotation.random(random_state=seed).as_matrix()
    ends = np.array([[1.0, -3.0, 2.0], [1.0, -3.0, 2.0] + 310.0 * turn[0]])
    model = Model(units="mm t N s")
    model.beam("beam", [model.node("a", ends[0]), model.node("b", ends[1])], SECTION, elements=8,
               bodies=1, modes=5)
    factor, found = handle(model, "beam.mass"), []
    for value in (1.0, 3.0, 0.7):
        factor.set(np.array(value))
        found.append(superelement_constants(model.bodies["beam"]))
        factor.reset()
    one, *others = found
    for value, other in zip((3.0, 0.7), others, strict=True):
        for name in ("turn", "axes", "order", "stretched", "lam", "E"):
            scale = np.abs(one[name]).max()
            np.testing.assert_allclose(other[name], one[name], rtol=0, atol=1e-13 * scale)
        for name in ("Mz", "moment_columns", "J0"):
            scale = np.abs(one[name]).max()
            np.testing.assert_allclose(other[name], value * np.asarray(one[name]), rtol=0,
                                       atol=1e-13 * scale * value)


def bent(seed, **options):
    """A slender beam in any direction, clamped at one end and bent by 0.06 rad."""
    turn = Rotation.random(random_state=seed).as_matrix()
    model = Model()
    root, tip = model.node("root", turn[1]), model.node("tip", turn[1] + turn[0])
    section = rectangle(0.04, 0.03, youngs_modulus=4e8, poisson_ratio=0.3, density=3000.0)
    model.beam("beam", [root, tip], section, elements=8, bodies=1, modes=4, up=turn[2], **options)
    model.fix(root)
    model.force(tip, 0.12 * 4e8 * 0.04 * 0.03**3 / 12 * turn[1])
    return model


@pytest.mark.parametrize("seed", range(4))
def test_slaved_coordinates_whose_rates_have_no_rigid_part_wipe_nothing_out(seed):
    """Load modes of symmetric bodies have a mass of rounding there, and full displacements.

    Compared with such a mass all other integrals were rounding, and most became zeros.
    """
    beam = bent(seed).bodies["beam"]
    body = beam.invariants.rigidly_followed
    masses = body.Mbar.diagonal()
    assert masses[len(body.E):].min() < 1e-15 * masses.max()
    # a mass that is exactly zero, or one of rounding of either sign
    for rounding in (0.0, 1e-19, -1e-17):
        least = np.diag(np.where(np.abs(masses) < 1e-15, rounding, 0.0))
        given = replace(body, Mbar=np.where(np.abs(body.Mbar) < 1e-15, 0.0, body.Mbar) + least)
        cleared = without_rounding(given, ROUNDING, beam.reduced.stiffness)
        for name in ("K", "J2", "Mbar"):
            size = np.abs(getattr(given, name)).max()
            np.testing.assert_allclose(getattr(cleared, name), getattr(given, name), rtol=0,
                                       atol=10 * ROUNDING * size)


@pytest.mark.parametrize("seed", range(4))
def test_bent_beams_have_the_same_mass_in_mean_axes_as_in_the_mean_frame(seed):
    """Up to the square of their deflection, 4e-2 of the length; it was negative in mean axes."""
    least = [np.linalg.eigvalsh(linearize(equilibrium(bent(seed, frame=frame))).mass)[0]
             for frame in ("mean_axes", "converged_mean")]
    assert least[0] == pytest.approx(least[1], rel=0.01)
