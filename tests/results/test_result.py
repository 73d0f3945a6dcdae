"""Results by name, and the file they go to."""

from functools import cache

import numpy as np
import pytest

from sebody import InputError, Model, SimulationError, simulate
from sebody.fem import planar_beam, straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes import heavy_top
from sebody.scenes.hinged_beam import SECTION, build


@cache
def spatial():
    return simulate(build(modes=2, elements=4).model, 0.01, 0.5)


@cache
def planar():
    fe_model = planar_beam((0, 0), (100, 0), SECTION, 4)
    model = Model(planar=True)
    nodes = [model.node("base", (0, 0)), model.node("tip", (100, 0))]
    model.superelement("beam", craig_bampton(fe_model, [(0, "full"), (4, "full")], 1), nodes)
    model.revolute("base")
    model.force("tip", (0, 10), [(0.0, 0.0), (0.5, 1.0)])
    return simulate(model, 0.01, 0.5)


SPATIAL = {
    "t": (51,), "energy.kinetic": (51,), "energy.strain": (51,), "energy.potential": (51,),
    "energy.external_work": (51,),
    "momentum": (51, 3), "angular_momentum": (51, 3), "beam.modes": (51, 2),
    **{f"{node}.{quantity}": shape for node in ("base", "tip") for quantity, shape in (
        ("position", (51, 3)), ("rotation", (51, 3, 3)), ("velocity", (51, 3)),
        ("angular_velocity", (51, 3)), ("acceleration", (51, 3)))}}
PLANAR = SPATIAL | {
    "beam.modes": (51, 1),
    **{f"{node}.{quantity}": shape for node in ("base", "tip") for quantity, shape in (
        ("position", (51, 2)), ("rotation", (51,)), ("velocity", (51, 2)),
        ("angular_velocity", (51,)), ("acceleration", (51, 2)))}}


@pytest.mark.parametrize("run, shapes", [(spatial, SPATIAL), (planar, PLANAR)])
def test_shapes_by_name(run, shapes):
    result = run()
    assert {name: result[name].shape for name in shapes} == shapes


def test_time_is_the_output_grid():
    assert np.allclose(spatial()["t"], np.arange(51) * 0.01, rtol=0, atol=1e-12)    # products


def test_fixed_positions_are_constant():
    assert (spatial()["base.position"] == 0.0).all()
    assert (spatial()["base.velocity"] == 0.0).all()
    assert (planar()["base.position"] == 0.0).all()


def test_velocity_is_the_rate_of_position():
    for result in (spatial(), planar()):
        rate = (result["tip.position"][2:] - result["tip.position"][:-2]) / 0.02
        velocity = result["tip.velocity"]
        assert np.abs(rate - velocity[1:-1]).max() < 0.02 * np.abs(velocity).max()


def test_angular_velocity_is_the_rate_of_rotation_in_global_axes():
    """A thrown body about an oblique axis: Rdot R^T by central differences."""
    body = craig_bampton(straight_beam((0, 0, 0), (10, 0, 0), SECTION, 4), [(0, "full"),
                                                                          (4, "full")], 0)
    model = Model()
    model.superelement("beam", body, [model.node("a", (0, 0, 0)), model.node("b", (10, 0, 0))])
    model.rigid_velocity((0, 0, 0), (3.0, 1.0, 2.0))
    result = simulate(model, 0.002, 0.5)
    R, omega = result["b.rotation"], result["b.angular_velocity"]
    # made orthogonal every eighth step: rounding of products, a few EPS
    assert np.allclose(R @ R.transpose(0, 2, 1), np.eye(3), rtol=0, atol=1e-12)
    assert np.abs(R[-1] - np.eye(3)).max() > 1.0
    spin = ((R[2:] - R[:-2]) / 0.004) @ R[1:-1].transpose(0, 2, 1)
    rate = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
    assert np.abs(rate - omega[1:-1]).max() < 0.02 * np.abs(omega).max()


@pytest.mark.parametrize("run", [spatial, planar])
def test_energy_is_the_work_done(run):
    assert run()["energy.kinetic"][-1] > 0
    assert run().energy_balance() < 1e-3


@pytest.mark.parametrize("name, message", [
    ("top.position", "'top.position' is unknown: did you mean 'tip.position'. nodes are base, "
                     "tip; of bodies .beam. there are modes, mode_rates and forces; of "
                     "<body>.<node> force and moment; of joints multipliers, force, moment, "
                     "local_force, local_moment, angle, rate, displacement and speed; of drives "
                     "torque and thrust; of springs and loads force and "
                     "moment; of torque on base.rotation work and power; of the model t, "),
    ("position", "'position' is unknown: did you mean 'tip.position' or 'base.position'. nodes"),
    ("energy.total", "energy.kinetic, energy.strain, momentum, angular_momentum"),
    ("tip.speed", "'speed' is unknown: a node has position, rotation, velocity, "),
])
def test_unknown_names(name, message):
    with pytest.raises(InputError, match=message):
        spatial()[name]


def test_a_rigid_body_has_no_modes():
    result = simulate(heavy_top.build().model, 1e-3, 0.01)
    name = next(iter(result.model.rigid_bodies))
    with pytest.raises(InputError, match=f"body '{name}' is rigid: it has forces, but no modes"):
        result[f"{name}.modes"]


def hinged(explicit):
    model = Model(planar=True)
    model.rigid_body("bob", model.node("pin", (0.0, 0.0)), 2.0, 0.1, centre=(1.0, 0.0))
    model.revolute("pin", explicit=explicit, name="hinge")
    model.gravity((0.0, -9.81))
    return simulate(model, 0.001, 0.01)


def test_multipliers_of_a_joint_by_its_name():
    """They are the force of the support, whose reaction is that where the pin is fixed instead."""
    multipliers, reaction = hinged(True)["hinge.multipliers"], hinged(False)["pin.reaction"]
    assert multipliers.shape == (11, 2)
    # a pendulum let go from the horizontal: m g (1 - m l^2 / (m l^2 + I))
    assert reaction[0] == pytest.approx([0.0, 2.0 * 9.81 * (1 - 2.0 / 2.1)], abs=1e-9)
    assert np.abs(multipliers[0]) == pytest.approx(np.abs(reaction[0]), abs=1e-9)


def test_a_joint_without_equations_has_no_multipliers():
    with pytest.raises(InputError, match="joint 'hinge' has no equations and so no "
                                         "multipliers, since its nodes share coordinates or "
                                         "are fixed; the force on a fixed node is its reaction"):
        hinged(False)["hinge.multipliers"]


def test_a_half_node_has_no_rotation():
    half = planar_beam((0, 0), (100, 0), SECTION, 4)
    body = craig_bampton(half, [(0, "full"), (2, "full"), (4, "full")], 0)
    model = Model(planar=True)
    model.superelement("beam", body, [model.node("a", (0, 0)), model.node("b", (50, 0)),
                                      model.node("c", (100, 0))])
    model.node("mark", (100, 0), keeps="translation", at=model.nodes["c"])
    model.fix("a")
    result = simulate(model, 0.01, 0.02)
    assert np.array_equal(result["mark.position"], result["c.position"])
    with pytest.raises(InputError, match="node 'mark' has no rotation"):
        result["mark.rotation"]


def test_save_and_read_back(tmp_path):
    path = spatial().save(tmp_path / "out.npz")
    with np.load(path) as file:
        saved = {name: file[name] for name in file if not name.startswith("sebody/")}
        assert set(saved) == {name for name in SPATIAL
                              if not name.endswith((".acceleration", ".modes"))}
        assert all(np.array_equal(saved[name], spatial()[name]) for name in saved)


def test_save_refuses_other_files(tmp_path):
    with pytest.raises(InputError, match="out.txt must end in .npz"):
        spatial().save(tmp_path / "out.txt")
    with pytest.raises(InputError, match="folder .*nowhere of the output file does not exist"):
        spatial().save(tmp_path / "nowhere" / "out.npz")


def test_summary_says_what_matters():
    text = spatial().summary()
    assert "unknowns             13" in text
    assert "steps                50 (0 rejected), to t = 0.5" in text
    for line in ("iterations per step", "time per step", "energy balance"):
        assert line in text
    assert "FAILED" not in text


def test_a_failed_run_is_saved(tmp_path):
    scene = build(modes=2, elements=4)
    scene.model.force("tip", (0, 0, 1e12), [(0.1, 0.0), (0.11, 1.0), (0.12, 0.0)])
    with pytest.raises(SimulationError) as caught:
        simulate(scene.model, 0.01, 0.5)
    kept = caught.value.result
    with np.load(kept.save(tmp_path / "kept.npz")) as saved:
        assert saved["t"].size == len(kept.t) >= 10
        assert all(np.isfinite(saved[name]).all() for name in saved
                   if not name.startswith("sebody/"))
