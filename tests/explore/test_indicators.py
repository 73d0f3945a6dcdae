"""Indicators of advice against the errors that they predict: each of a case with one error alone.

They are estimates, so a predicted error is within a small factor of the true one; a term that is
missing, or a constant off by ten, is not.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody import Model, Simulation, simulate
from sebody.analysis import equilibrium, modes
from sebody.explore.advice.forms import parts_of
from sebody.explore.advice.indicators.omission import omission
from sebody.explore.advice.indicators.propagated import propagated
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.indicators.rigidity import rigidity
from sebody.explore.advice.indicators.stiffening import stiffening
from sebody.fem import Section, planar_beam
from sebody.generated.options import INERTIA_OPTIONS
from sebody.model.variants import keep_modes, rigid, with_options
from sebody.reduction import craig_bampton

SECTION = Section(area=2.0, inertia_y=0.3, inertia_z=0.4, torsion=0.2, youngs_modulus=1e6,
                  poisson_ratio=0.25, density=1.5)
BASE, TIP = np.array([1.0, -2.0]), np.array([13.0, 7.0])
LENGTH = float(np.linalg.norm(TIP - BASE))


def arm(count: int = 6, held: bool = True) -> Model:
    """A beam in a plane, clamped at its base or on a hinge."""
    model = Model(planar=True)
    base, tip = model.node("base", BASE), model.node("tip", TIP)
    body = craig_bampton(planar_beam(BASE, TIP, SECTION, 12), [(0, "full"), (12, "full")], count)
    model.superelement("arm", body, [base, tip])
    if held:
        model.fix(base)
    else:
        model.fix(base, "position")
    return model


def recorded_of(model: Model, h: float, t_end: float, quantities=(), frequencies=()) -> Recorded:
    """A run of a model, as the indicators see that of the reference model."""
    result = simulate(model, h, t_end)
    sizes = [float(np.linalg.norm(result[name] - result[name][0], axis=1).max())
             for name in quantities]
    return Recorded(model, result, list(quantities), sizes, list(frequencies), parts_of(model))


def first_of(model: Model) -> float:
    """Lowest angular frequency above zero."""
    omega = modes(Simulation(model, 0.01)).omega
    return float(omega[omega > 1e-4 * omega.max()].min())


def test_a_frequency_without_internal_modes():
    """A cantilever of one body without modes, against the same with six."""
    model = arm()
    part, = parts_of(model)
    true = abs(first_of(keep_modes(model, "arm", 0).model) / first_of(model) - 1)
    found = omission(recorded_of(model, 0.01, 0.02, frequencies=[first_of(model)]), part,
                     part.detailed._replace(modes=0))
    assert 4e-3 < true < 6e-3 and 0.5 < found / true < 2.0


@pytest.mark.parametrize("stiffness", [2e3, 2e2])
def test_a_frequency_of_a_rigid_arm(stiffness):
    """On a spring about its hinge: what the arm gives way goes with the square of the frequency."""
    model = arm(held=False)
    model.node("ground", BASE)
    model.fix("ground")
    model.torsion_spring("base", stiffness=stiffness, to="ground")
    part, = parts_of(model)
    flexible = first_of(model)
    true = abs(first_of(rigid(model, "arm").model) / flexible - 1)
    found = rigidity(recorded_of(model, 0.01, 0.02, frequencies=[flexible]), part, part.detailed)
    assert true < 0.01 and 0.5 < found / true < 4.0


def test_a_frequency_of_an_arm_that_turns_with_option_d():
    """By half of the share of the square of spin over frequency, which the indicator takes."""
    model, spin = arm(), 0.1 * first_of(arm())
    found = []
    for inertia in ("floating_field", "rigid_part"):
        own = with_options(model, "arm", inertia=inertia,
                           stiffening=inertia == "floating_field").model
        found.append(modes(equilibrium(own, 2, spin=spin), spin).omega.min())
    off = abs(found[1] / found[0] - 1) / (spin / found[0])**2
    assert 0.5 < INERTIA_OPTIONS["rigid_part"].softening / 2 / off < 2.0
    assert INERTIA_OPTIONS["floating_field"].softening == 0.0


def test_what_bends_shortens():
    """A slow load bends a cantilever by a sixth of its length; without stiffening it stretches."""
    model = arm(2)
    across = np.array([-(TIP - BASE)[1], (TIP - BASE)[0]]) / LENGTH
    push = 3 * 1e6 * 0.4 / LENGTH**3 * LENGTH / 6
    model.force("tip", push * across, [(0.0, 0.0), (2.0, 1.0)])
    part, = parts_of(model)
    reference = recorded_of(model, 0.02, 2.0, ["tip.position"])
    plain = simulate(with_options(model, "arm", stiffening=False).model, 0.02, 2.0)
    off = plain["tip.position"] - reference.result["tip.position"]
    true = np.linalg.norm(off, axis=1).max() / reference.sizes[0]
    found = stiffening(reference, part, part.detailed._replace(stiffening=False))
    assert 0.015 < true < 0.2 and 0.7 < found / true < 2.0
    assert stiffening(reference, part, part.detailed) == 0.0


@pytest.mark.parametrize("quantity, power", [("position", 0), ("velocity", 1), ("acceleration", 2)])
def test_an_error_that_oscillates(quantity, power):
    """Of a quantity the error is that of the displacement times a power of its frequency."""
    model = arm(2)
    model.force("tip", (0.0, 1.0), [(0.0, 0.0), (1.0, 5.0)])
    name, omega, size = f"tip.{quantity}", 7.0, 1e-3
    reference = recorded_of(model, 5e-3, 2.0, [name])
    part, = parts_of(model)
    t = reference.result.t[::reference.every]
    shifts, turns = np.zeros((len(t), 2, 2)), np.zeros((len(t), 2, 1))
    shifts[:, 1] = size * (2.0 + np.sin(omega * t))[:, None] * (0.6, 0.8)
    found = propagated(reference, part, shifts, turns) * reference.sizes[0]
    # differences of a grid of 1 / 30 of a radian
    assert_allclose(found, size * (omega**power if power else 3.0), rtol=2e-2)
