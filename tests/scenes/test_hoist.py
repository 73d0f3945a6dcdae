"""The scene of a hoist: statics of its ropes by their geometry, energy of its winch."""

import numpy as np
import pytest

from sebody import simulate
from sebody.basics.errors import InputError
from sebody.cli.entry import main
from sebody.scenes import hoist
from sebody.scenes.hoist import build

LATE = slice(2000, None)        # the winch stands still, and the load swings a little
STILL = 5e-3                    # mean values of what still swings


def tangent(a, r, b, s):
    """Unit vector along a rope from circle a to circle b, both passed clockwise."""
    d = b - a
    lean = np.arctan2(d[1], d[0]) + np.arcsin((s - r) / np.linalg.norm(d))
    return np.array([np.cos(lean), np.sin(lean)])


def turn(place, force):
    """Moment about the origin."""
    return place[0] * force[1] - place[1] * force[0]


@pytest.mark.parametrize("falls", [1, 3, 4])
def test_ropes_carry_the_load(falls):
    """Falls share the weight; moments about the foot give the tension of the stay."""
    load, scene = 800.0, build(falls, 800.0)
    result = simulate(scene.model, scene.h, scene.t_end)
    weight = load * hoist.G
    pull, stay = result["hoist.tension"][LATE].mean(axis=0), result["stay.tension"][LATE].mean()
    assert pull == pytest.approx(np.full(falls + 1, pull[0]), rel=1e-12)
    assert falls * pull[0] == pytest.approx(weight, rel=STILL)
    assert not result["ground.normal_force"][LATE].any() and result["ground.normal_force"].any()

    tip, hook = (result[f"{name}.position"][LATE].mean(axis=0) for name in ("tip", "hook"))
    boom = 0.2 * 0.1 * hoist.STEEL["density"] * np.hypot(*hoist.TIP) * hoist.G
    lead = tangent(np.array(hoist.DRUM), hoist.WINDING, tip, hoist.SHEAVES[0])
    away = (np.array(hoist.MAST) - tip) / np.linalg.norm(np.array(hoist.MAST) - tip)
    held = stay * turn(tip, away) - pull[0] * (turn(tip, lead) - hoist.SHEAVES[0])
    assert held == pytest.approx(weight * hook[0] + boom * tip[0] / 2, rel=STILL)


@pytest.mark.parametrize("falls", [1, 4])
def test_the_work_of_the_winch_is_the_energy(falls):
    scene = build(falls)
    result = simulate(scene.model, scene.h, scene.t_end)
    assert result.energy_balance() < 1e-6
    lifted = result["hook.position.y"][-1] - hoist.HOOK
    assert 0.9 * hoist.LIFTED < lifted <= hoist.LIFTED + 0.02
    wound = result["axle.angle"][-1] * hoist.WINDING
    assert wound == pytest.approx(falls * hoist.LIFTED, rel=1e-9)
    assert result["motor.work"][-1] == pytest.approx(1000.0 * hoist.G * lifted, rel=0.03)


def test_on_the_command_line(tmp_path):
    output = tmp_path / "run.npz"
    words = ["run", "hoist", "--set", "falls=2", "--t-end", "0.1", "--output", str(output)]
    assert main(words) == 0 and output.exists()
    with pytest.raises(InputError, match="falls is 0"):
        build(0)
