"""What advice calls confirmed: loads between steps, unstable motion, a reference in doubt."""

import numpy as np
import pytest
from advised_crane import SOFT, STIFF, T_END, H, crane

from sebody import Model, harmonic, simulate, with_corners
from sebody.analysis import advise
from sebody.cli.entry import main
from sebody.explore.advice import Advice
from sebody.explore.advice.loads import missed
from sebody.fem import Section
from sebody.model.histories import time_function

ROOT, TIP = np.array([12.0, 9.0]), np.array([50.0, 2.0])


def triangle(t: float) -> float:
    """A blow of 0.8 ms as a function, of whose course between steps nothing is known."""
    return max(0.0, 400.0 - 1e6 * abs(t - 0.1036))


def arm(load: str, bodies: int = 1, modes: int = 2) -> Model:
    """A hinged arm with a weight, which is struck for 0.8 ms, or shaken with 400 Hz.

    The blow is a function, or a table, whose close rows keep their impulse in all steps.
    """
    model = Model(planar=True)
    tip, root = model.node("tip", TIP), model.node("root", ROOT)
    model.beam("arm", (root, tip), SOFT, elements=max(16, bodies), bodies=bodies, modes=modes)
    model.point_mass("weight", tip, 0.02)
    model.revolute(root, name="hinge")
    if load == "pulse":
        model.force(tip, (0.3, 1.0), triangle)
    elif load == "rows":
        model.force(tip, (0.3, 1.0), [(0, 0), (0.1032, 0), (0.1036, 400.0), (0.104, 0)])
    else:
        model.torque(root, 1.0, [(0, 0), (0.1, 6.0), (0.3, -6.0), (0.4, 0.0)])
        # four whole periods in a step of 10 ms, one in a quarter of it
        model.force(tip, (0.3, 1.0), harmonic(20.0, 2 * np.pi * 400))
    return model


def true_error(advice: Advice, exact: Model, h: float, quantity: str = "tip.position") -> float:
    """Of what was chosen, against an exact beam with short steps, at all of its own steps."""
    every = round(advice.step / h)
    one = simulate(advice.model, advice.step, T_END)[quantity]
    whole = simulate(exact, advice.step / every, T_END, output_every=every)[quantity]
    moved = np.linalg.norm(whole - whole[0], axis=1).max()
    return np.linalg.norm(one - whole[:len(one)], axis=1).max() / moved


@pytest.mark.parametrize("load", ["pulse", "ripple"])
def test_loads_that_the_given_step_misses_shorten_it(load):
    advice = advise(arm(load), H, T_END, "tip.position", 1e-2)
    error = true_error(advice, arm(load, 24, 0), H / 256)
    assert advice.confirmed
    assert error <= advice.error + 1e-3
    assert advice.step < H / 4
    remark = next(line for line in advice.summary().splitlines() if "needs shorter steps" in line)
    assert remark.startswith(
        f"force on tip.position needs shorter steps than those of {H:g}: the grid is ")
    given = advice.table[-1]                # the model as given, with its step, sees nothing of it
    assert given.kind == "given"
    assert given.error > 0.1


def test_rows_closer_than_steps_need_no_shorter_ones():
    advice = advise(arm("rows"), H, T_END, "tip.position", 1e-2)
    assert advice.confirmed
    assert true_error(advice, arm("pulse", 24, 0), H / 256) <= advice.error + 1e-3
    assert not any("needs shorter steps" in line for line in advice.summary().splitlines())
    assert advice.step > H / 4


def test_a_load_too_fast_for_every_step_is_refused_by_its_name():
    model = arm("pulse")
    shot = with_corners(lambda t: max(0.0, 1e6 - 1e12 * abs(t - 0.300001)), [0.3, 0.300002])
    model.force("root", (1.0, 0.0), shot, name="shot")
    with pytest.raises(Exception, match="shot changes too fast for the step: even steps of .* miss "
                       ".*% of it, most at t = 0.3; give a smaller h than 0.01"):
        advise(model, H, T_END, "tip.position", 1e-2)


def shaken(t, x, v, force):
    """A force of a user, which nobody can look into: with 1600 Hz, whole periods in all steps."""
    force[0] = 40.0 * np.sin(10053.096491487338 * t)
    force[1] = 100.0 * np.sin(10053.096491487338 * t)


def test_a_force_of_a_user_between_all_steps_is_seen_by_a_run_off_their_grid():
    model = arm("pulse")
    model.loads.clear()
    model.torque("root", 1.0, [(0, 0), (0.1, 6.0), (0.3, -6.0), (0.4, 0.0)])
    model.user_force("shaker", ["tip"], shaken)
    advice = advise(model, H, T_END, "tip.position", 5e-2)
    assert not advice.confirmed
    assert "which share no grid with the others, is off by" in advice.summary()
    assert advice.summary().splitlines()[-1].startswith("not confirmed: within ")


@pytest.mark.parametrize(("shape", "share"), [
    ([(0, 0), (0.4, 1.0)], 0.0),                                    # linear: steps see all of it
    (lambda t: max(0.0, 1.0 - abs(t - 0.103) / 1e-3), 1.0),         # between two steps: nothing
    ([(0, 0), (0.102, 0), (0.103, 1.0), (0.104, 0)], 0.0),          # close rows: all of it
    (harmonic(1.0, 2 * np.pi * 100.0), 1.0),
    (harmonic(1.0, 2 * np.pi * 100.0 / 16), (2 * np.pi / 16)**2 / 12),   # mean of the interpolation
    (lambda t: np.sin(2 * np.pi * 200.0 * t), 1.0)])
def test_the_share_of_a_load_between_steps(shape, share):
    found = missed(["load"], [time_function(shape)], H, T_END)
    assert found.share == pytest.approx(share, rel=0.25, abs=1e-9)


def strip(load: float, aside: float = 0.0) -> Model:
    """A thin strip on edge, bent by a part of the load at which it buckles sideways."""
    width, height, length, modulus = 0.002, 0.03, 1.0, 7e10
    lateral, torsion = height * width**3 / 12, height * width**3 / 3
    section = Section(area=width * height, inertia_y=lateral, inertia_z=width * height**3 / 12,
                      torsion=torsion, youngs_modulus=modulus, poisson_ratio=0.3, density=2700.0)
    # Timoshenko & Gere (1961), Theory of Elastic Stability, 6.4
    critical = 4.013 * np.sqrt(modulus * lateral * modulus / 2.6 * torsion) / length**2
    model = Model()
    model.node("root", (1.0, 2.0, 3.0)), model.node("tip", (1.0 + length, 2.0, 3.0))
    model.beam("strip", ("root", "tip"), section, elements=16, bodies=8, up=(0, 0, 1))
    model.fix("root")
    model.force("tip", (0, 0, -1.0), [(0, 0), (0.3, load * critical), (3.0, load * critical)])
    if aside:
        model.force("tip", (0, 1.0, 0), [(0, 0), (0.01, aside)])
    return model


def test_a_motion_that_symmetry_alone_keeps_in_its_plane_is_not_confirmed():
    ways = [simulate(strip(1.6, aside), 0.005, 0.7)["tip.position.y"] for aside in (0.0, 1e-3)]
    assert np.abs(ways[0] - ways[1]).max() > 0.1        # a thousandth of a newton
    advice = advise(strip(1.6), 0.005, 0.7, "tip.position", 5e-2)
    assert not advice.confirmed
    assert not advice.model.planar
    lines = advice.summary().splitlines()
    assert lines[-1] == (f"not confirmed: within {advice.error:.2g} of the reference model, which "
                         f"may itself be off by {advice.doubt:.2g}")
    assert any("the motion is unstable: a small disturbance of all velocities and loads grows to "
               in line and "give the model the imperfection" in line for line in lines)
    below = advise(strip(0.6), 0.005, 0.7, "tip.position", 5e-2)
    assert below.confirmed
    assert below.model.planar


def test_a_reference_that_may_be_off_by_more_than_half_the_tolerance_confirms_nothing():
    def exact(bodies: int) -> Model:
        model, one = Model(planar=True), crane(torque=3000.0)
        for name, node in one.nodes.items():
            model.node(name, node.point)
        model.beam("soft", ("elbow", "tip"), SOFT, bodies)
        model.beam("stout", ("base", "elbow"), STIFF, 4)
        model.point_mass("weight", "tip", 0.02)
        model.revolute("base")
        model.torque("base", 1.0, [(0, 0), (0.1, 3000.0), (0.3, -3000.0), (0.4, 0.0)])
        return model
    advice = advise(crane(torque=3000.0), H, T_END, "tip.position", 1e-3)
    assert advice.error <= 1e-3 < true_error(advice, exact(24), H / 8)
    assert not advice.confirmed
    assert advice.doubt >= true_error(advice, exact(24), H / 8) - advice.error
    assert advice.summary().splitlines()[-1].startswith("not confirmed: within ")
    assert "linear theory: soft rotates by 0.2" in advice.summary()


def test_a_damped_beam_is_damped_alike_in_the_reference():
    model = Model(planar=True)
    model.node("root", ROOT), model.node("tip", TIP)
    model.beam("arm", ("root", "tip"), SOFT, 16, 1, modes=4, damping=(0.05, "clamped 1"))
    model.fix("root")
    model.force("tip", (0.2, 1.0), [(0, 0), (0.05, 20.0), (0.1, 0)])
    advice = advise(model, H, 2.0, "tip.position", 5e-2)
    assert advice.confirmed
    assert advice.table[-1].kind == "given"
    assert advice.table[-1].error <= 5e-2       # eight bodies are damped as one is
    assert sum(len(body.nodes) - 1 for body in advice.model.bodies.values()) == 1


SCENE = """
from advised_crane import H, T_END, crane
from sebody.scenes.scene import Scene

def build(torque: float = 3000.0) -> Scene:
    return Scene("crane", "a crane", crane(torque=torque), H, T_END)
"""


def test_the_command_has_an_exit_code_for_what_is_not_confirmed(tmp_path, capsys):
    file = tmp_path / "scene.py"
    file.write_text(SCENE)
    arguments = ["advise", str(file), "--quantity", "tip.position", "--tolerance"]
    assert main([*arguments, "1e-3"]) == 3
    assert capsys.readouterr().out.splitlines()[-1].startswith("not confirmed: within ")
    assert main([*arguments, "5e-2"]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith("confirmed error ")
