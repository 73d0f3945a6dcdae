"""Members in lanes that are evaluated, or make some steps, alone: each equals its single run."""

import numpy as np
import pytest
from lane_models import TURN, assert_bits_in_other_company, linkage, single, turned_beam

from sebody import Model, plane
from sebody.analysis import Ensemble, final, maximum
from sebody.compiler.choice import way
from sebody.explore.ensembles import ensemble

RUNS = 9        # one group of eight, and one run
SEED = 6

pytestmark = pytest.mark.skipif(
    way().__name__.endswith("plain"), reason="the plain way makes runs one by one")


def pulled(t, x, v, force):
    """A force that grows with the place and brakes."""
    force[0] = -3.0 * x[0] * x[0] - 0.2 * v[0]
    force[1] = -2.0 * x[1] - 0.3 * v[1] * abs(v[1])


def touching_linkage() -> Model:
    """A four-bar with a beam that meets a rough plane and a stop, and whose load jumps."""
    made = linkage()
    made.contact("tip", on=plane((0.1, 1.0), point=(0.0, 1.045)), stiffness=2e5, friction=0.3,
                 name="floor")
    made.stop(("pin", "wall"), upper=2.6, stiffness=1e5, name="buffer")
    made.user_force("air", ["tip"], pulled)
    made.force("tip", (1.0, 0.4), [(0, 0), (0.07, 2.0), (0.07, -6.0), (1.0, 3.0)], name="load")
    return made


def stopped_beam() -> Model:
    """A spatial beam on a turned hinge with a spring that counts turns, between two stops."""
    made = turned_beam()
    made.torsion_spring("base", 2e4, 10.0, axis=TURN @ (0, 0, 1), name="coil")
    made.stop("hinge", lower=-0.015, upper=0.012, stiffness=1e5, restitution=0.5, name="buffer")
    return made


def numbers(names: dict[str, tuple[float, float]]) -> dict:
    rng = np.random.default_rng(SEED)
    return {name: rng.uniform(*bounds, RUNS) for name, bounds in names.items()}


@pytest.mark.parametrize("build, given, h, steps", [
    (touching_linkage, {"floor.coefficient": (0.1, 0.5), "buffer.upper": (2.36, 2.5),
                        "motor.amplitude": (-3, 4), "load.amplitude": (-1, 2)}, 4e-3, 60),
    (stopped_beam, {"beam.stiffness": (0.6, 1.6), "motor.amplitude": (-1, 2),
                    "coil.stiffness": (1e4, 1e5)}, 2e-3, 60)])
def test_members_equal_single_runs(build, given, h, steps, monkeypatch):
    """They hit at different times, or never; alone and backwards the bits are the same."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    given = numbers(given)
    outputs = {"course": "tip.position", "most": maximum("tip.velocity"),
               "work": final("energy.external_work")}
    many = Ensemble(build(), h)
    found = many.run(given, steps * h, outputs)
    assert found.in_lanes == RUNS and not found.failures
    assert_bits_in_other_company(many, given, steps * h, outputs, found)
    cuts = []
    for run in range(RUNS):
        result = single(build(), {name: v[run] for name, v in given.items()}, h, steps * h)
        cuts.append(result.cuts)
        size = np.abs(result["tip.position"]).max()
        assert np.abs(found["course"][run] - result["tip.position"]).max() < 1e-10 * size
        speed = np.abs(result["tip.velocity"]).max()
        assert np.abs(found["most"][run] - result["tip.velocity"].max(axis=0)).max() < 1e-8 * speed
        assert found["work"][run] == pytest.approx(result["energy.external_work"][-1], rel=1e-6)
    assert min(cuts) == 0 < max(cuts) and len(set(cuts)) > 2


def rolling(friction: float, speed: float) -> Model:
    """A ball that lies on a plane, with a beam beside it."""
    made = linkage()
    ball = made.node("ball", (0.0, -3.0))
    made.rigid_body("sphere", ball, 1.0, 0.004)
    made.initial_velocity(ball, (speed, 0.0))
    made.contact(ball, on=plane((0.0, 1.0), point=(0.0, -3.1)), radius=0.1001, stiffness=1e5,
                 friction=friction, name="floor")
    return made


def geared() -> Model:
    made = linkage()
    for k in (0, 1):
        wheel = made.node(f"wheel {k}", (4.0 + 3 * k, 1.0))
        made.rigid_body(f"gear {k}", wheel, 1.0, 0.1)
        made.revolute(wheel, name=f"axle {k}")
    made.gear("axle 0", "axle 1", ratio=-1.0, backlash=1e-3, name="teeth")
    return made


def stopped_bar() -> Model:
    made = Model(planar=True)
    made.rigid_body("bar", made.node("pin", (0.0, 0.0)), 1.0, 0.1, (0.5, 0.0))
    made.revolute("pin", name="hinge")
    made.stop("hinge", lower=-1.0, stiffness=1e4, name="buffer")
    return made


@pytest.mark.parametrize("build, reason", [
    (lambda: rolling(0.3, 0.0), "friction that holds"), (geared, "teeth"),
    (stopped_bar, "rigid bodies alone"), (lambda: rolling(0.3, 1.0), "eight at a time")])
def test_the_ensemble_says_how_its_runs_are_made(build, reason):
    assert reason in repr(Ensemble(build(), 2e-3))


def test_the_outcome_says_how_its_runs_were_made(monkeypatch):
    """A damping that follows from a restitution, not in proportion, wants another model."""
    beam, ball = linkage(), Model(planar=True)
    ball.rigid_body("ball", ball.node("centre", (0.3, 0.2)), 1.0, 0.1)
    for made, node in ((beam, "tip"), (ball, "centre")):
        made.contact(node, plane((0.1, 1.0), point=(0.0, -3.0)), stiffness=1e5, name="floor")

    def told(model, name):
        outcome = Ensemble(model, 2e-3).run({name: np.linspace(0.3, 0.9, RUNS)}, 0.02,
                                            {"end": final("energy.kinetic")})
        title = repr(outcome).splitlines()[0]
        assert title.endswith(f"one by one: {outcome.why_one_by_one}" if outcome.why_one_by_one
                              else f"{outcome.in_lanes} of them eight at a time")
        return outcome.in_lanes, outcome.why_one_by_one
    assert told(beam, "floor.stiffness") == (0, f"fewer than {ensemble.WORTH_IT} steps in all")
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    assert told(beam, "motor.amplitude") == (RUNS, "")
    assert told(beam, "floor.restitution") == (
        0, "with these parameters the model is built anew for each run")
    assert told(ball, "ball.mass") == (
        0, "elements that keep numbers, as contacts and friction, among rigid bodies alone")
