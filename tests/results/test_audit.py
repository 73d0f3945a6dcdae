"""The audit: momenta against the impulse of all forces, and verdicts that follow the run."""

import numpy as np
import pytest

from sebody import Model, Result, simulate
from sebody.results.audit import audit, momentum_defect
from sebody.results.energy_balance import LIMIT
from sebody.scenes import heavy_top, hinged_beam, squeezer


def verdicts(result):
    return {one.what: one.verdict for one in audit(result)}


def falling(planar):
    """A free body with a force off its centre, and a weight on a link; forces of known impulse."""
    d = 2 if planar else 3
    model = Model(planar=planar)
    hub = model.node("hub", [3.0, -1.0, 0.5][:d])
    model.rigid_body("wheel", hub, 2.0, 0.4 if planar else (0.3, 0.4, 0.5),
                     centre=[3.2, -1.1, 0.5][:d])
    end = model.attach("end", [4.0, 0.0, 0.5][:d], hub)
    model.point_mass("weight", end, 0.5)
    model.force(end, [0.0, 1.0, 0.0][:d], [(0.0, 0.0), (1.0, 3.0)])
    model.gravity([0.3, -9.81, 0.0][:d])
    return simulate(model, 1e-3, 1.0)


@pytest.mark.parametrize("planar", [False, True])
def test_momenta_follow_the_forces(planar):
    """The momentum itself is m g t plus the impulse of the force, t^2 3/2."""
    result = falling(planar)
    t = result.t[:, None]
    exact = 2.5 * np.array([[0.3, -9.81]]) * t + np.column_stack([0 * t, 1.5 * t**2])
    np.testing.assert_allclose(result["momentum"][:, :2], exact, atol=1e-4 * 2.5 * 9.81)
    for angular in (False, True):
        defect, _ = momentum_defect(result, angular)
        # trapezoids of steps of 1e-3, and the integrator's own error of second order
        assert np.abs(defect).max() < 1e-4 * 2.5 * 9.81
    assert set(verdicts(result).values()) == {"good"}


def test_supports_joints_and_springs_take_part():
    for result in (simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 3.0),
                   simulate(squeezer.build().model, 3e-5, 0.006)):
        found = verdicts(result)
        assert {found["momentum"], found["angular momentum"], found["energy"]} == {"good"}


def test_long_steps_are_found_bad_and_few_states_are_not_judged():
    scene = heavy_top.build()
    coarse = simulate(scene.model, 4e-3, 1.0)
    assert verdicts(coarse)["momentum"] == "bad"
    fine = simulate(heavy_top.build().model, 1e-4, 1.0, output_every=2500)
    found = verdicts(fine)
    assert {found["momentum"], found["angular momentum"]} == {"not judged"}


def test_energy_and_constraints(tmp_path):
    result = simulate(heavy_top.build(explicit=True).model, 1e-3, 0.2)
    found = verdicts(result)
    assert found["constraints"] == "good"
    assert found["rates of constraints"] in ("good", "acceptable")      # of index 3
    again = Result.load(result.save(tmp_path / "top.npz"))
    assert audit(again) == audit(result)
    lossy = simulate(hinged_beam.build(modes=2, elements=4).model, 0.5, 30.0)
    energy = next(one for one in audit(lossy) if one.what == "energy")
    assert (energy.verdict == "bad") == (lossy.energy_balance() > LIMIT)
    assert energy.value == f"{lossy.energy_balance():.2e}"
