"""The scene of an arm that throws a load: a latch opens, then a grip at an angle or a force."""

import numpy as np
import pytest

from sebody import simulate
from sebody.cli.entry import main
from sebody.scenes.thrower import build


def test_the_load_flies_on_a_parabola():
    scene = build()
    run = simulate(scene.model, scene.h, scene.t_end)
    latch, grip = run.events
    assert (latch.what, latch.time) == ("latch let go", 0.1) and grip.what == "grip let go"
    flies = run.t > grip.time
    t, x, v = run.t[flies], run["load.position"][flies], run["load.velocity"][flies]
    s = (t - t[0])[:, None]
    np.testing.assert_allclose(x, x[0] + v[0] * s + np.array([0.0, -9.81]) * s**2 / 2, atol=1e-9)
    np.testing.assert_allclose(run["load.rotation"][flies][-1], run["load.rotation"][flies][0]
                               + run["load.angular_velocity"][flies][0] * s[-1, 0], atol=1e-9)
    assert run["hinge.angle"][flies][0] == pytest.approx(1.0, abs=2e-3)
    assert not run["grip.force"][flies].any() and not run["latch.force"][run.t >= 0.1].any()
    assert np.abs(run["tip.position"][run.t < 0.1][:, 1]).max() < 1e-8
    assert run.energy_balance() < 1e-4


def test_a_weak_grip_breaks_when_the_latch_opens():
    """What the latch has borne jumps to the load: at the same time, before any step."""
    scene = build(strength=100.0)
    run = simulate(scene.model, scene.h, 0.2)
    assert [event[:2] for event in run.events] == [(0.1, "latch let go"), (0.1, "grip broke")]
    assert run["grip.force.norm"].max() < 20.0 and not run["grip.force"][run.t >= 0.1].any()


def test_on_the_command_line(tmp_path, capsys):
    output = tmp_path / "run.npz"
    assert main(["run", "thrower", "--t-end", "0.12", "--output", str(output)]) == 0
    assert "latch let go; energy lost" in capsys.readouterr().out and output.exists()
    state = str(tmp_path / "state.npz")
    assert main(["run", "thrower", "--t-end", "0.11", "--save", state]) == 0
    assert main(["run", "thrower", "--t-end", "0.12", "--resume", state]) == 0
    said = capsys.readouterr().out
    assert "latch let go; energy lost" in said and "to t = 0.12" in said
