"""The rotor that runs up and the box on a shaker: runs against analyses in the frequency domain."""

import numpy as np
import pytest

from sebody import simulate
from sebody.analysis import critical_speeds, equilibrium, random_response
from sebody.scenes import rotor, shaker


def test_a_run_up_swells_behind_its_critical_speeds():
    """Its drive turns it by ``a t^2 / 2``; the largest orbit comes after the second one."""
    scene = rotor.build()
    result = simulate(scene.model, scene.h, scene.t_end)
    speed = result["n0.angular_velocity.x"]
    assert speed[-1] == pytest.approx(rotor.ACCELERATION * rotor.END, rel=1e-3)
    exact = critical_speeds(rotor.rotor(), fastest=130.0, count=6)
    whirl = [str(one) for one in exact.whirl]
    assert whirl == ["backward", "forward"]
    size = np.linalg.norm((result["disc 2.position"] - scene.model.nodes["disc 2"].point)[:, 1:],
                          axis=1)
    assert exact.speeds[1] < speed[np.argmax(size)] < 1.15 * exact.speeds[1]
    assert size[speed > 125.0].max() < 0.5 * size.max()


def test_a_box_shakes_as_its_response_says():
    """An rms of a run of 8 s in a band of 10 Hz about a resonance scatters by a tenth."""
    scene = shaker.build(seed=3, length=8.0)
    result = simulate(scene.model, scene.h, scene.t_end)
    found = random_response(equilibrium(scene.model, 1), {"shaker": shaker.SPECIFICATION},
                            ["lid.acceleration", "table.acceleration"])
    settled = result.t > 1.0
    for name in ("lid.acceleration.x", "table.acceleration.x"):
        assert np.std(result[name][settled]) == pytest.approx(found.rms[name], rel=0.2)
