"""The search of advice: what it looks at, what it leaves out, and how it ends."""

import math
import types

import numpy as np
import pytest

from sebody import Model, SimulationError, simulate
from sebody.analysis import advise, modes
from sebody.explore.advice import Unreached
from sebody.explore.advice.changes import Choice, Step
from sebody.explore.advice.cost import operations
from sebody.explore.advice.estimates import UNSURE
from sebody.explore.advice.forms import parts_of
from sebody.explore.advice.indicators.activity import activity
from sebody.explore.advice.measures import Measure
from sebody.explore.advice.quantities import Values
from sebody.explore.advice.reference import reference
from sebody.explore.advice.runner import Tried
from sebody.explore.advice.search import Search
from sebody.fem import Section, planar_beam
from sebody.kernels.loader import load
from sebody.reduction import craig_bampton
from sebody.runs.simulation import Simulation

H, T_END = 0.01, 0.4
SOFT = Section(area=0.2, inertia_y=0.02, inertia_z=0.02, torsion=0.04, youngs_modulus=2.1e6,
               poisson_ratio=0.3, density=7.8e-3)
ROOT, TIP = np.array([12.0, 9.0]), np.array([50.0, 2.0])


def arm(space: bool = False, torque: float = 60.0, angle: float = 0.0) -> Model:
    """A soft beam that a torque swings about its root, in a plane or, turned, in space."""
    model = Model(planar=not space)
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])

    def placed(point: np.ndarray) -> np.ndarray:
        return turn @ [*point, 0.0] if space else point
    tip, root = model.node("tip", placed(TIP)), model.node("root", placed(ROOT))
    model.beam("arm", (root, tip), SOFT, elements=16, bodies=1, modes=2)
    model.point_mass("weight", tip, 0.02)
    history = [(0, 0), (0.1, torque), (0.3, -torque), (0.4, 0.0)]
    if space:
        model.revolute(root, axis=turn[:, 2], name="hinge")
        model.torque(root, turn[:, 2], history)
    else:
        model.revolute(root, name="hinge")
        model.torque(root, 1.0, history)
    return model


@pytest.fixture(scope="module")
def advice():
    return advise(arm(), H, T_END, "tip.position", 1e-2)


def test_the_reference_is_a_beam_of_eight_bodies_at_a_quarter_of_the_step(advice):
    assert advice.table[0].step == H / 4
    assert advice.table[0].change.startswith("arm: 8 bodies with ")
    assert [trial.kind for trial in advice.table[:3]] == ["reference"] * 3


def test_a_beam_whose_inside_is_asked_for_is_not_divided():
    model = arm()
    assert parts_of(model)[0].detailed.bodies == 8
    assert parts_of(model, {"arm"})[0].detailed.bodies == 1
    model = Model(planar=True)
    model.node("a", (0, 0)), model.node("b", (8, 1))
    model.beam("rod", ("a", "b"), SOFT, elements=4, bodies=2)
    assert parts_of(model, {"rod 1"})[1].name == "rod 2"
    assert [part.name for part in parts_of(model)] == ["rod"]


def test_what_is_chosen_holds_with_half_its_step(advice):
    kinds = [trial.kind for trial in advice.table]
    half = advice.table[kinds.index("confirmation")]
    assert half.step == advice.step / 2
    assert half.error <= 1e-2
    assert kinds[-1] == "given"


def test_nothing_is_tried_that_an_indicator_excludes(advice):
    tight = advise(arm(), H, T_END, "tip.position", 1e-3)
    looked_at = [trial for trial in tight.table if trial.kind == "alone"]
    assert looked_at
    assert all(trial.predicted <= UNSURE * 1e-3 for trial in looked_at)
    # the arm bends by a fifth of its travel
    assert not any("arm: rigid" in trial.change for trial in tight.table)


def test_predictions_are_near_what_runs_confirm(advice):
    assert 1 / 3 <= advice.predicted / advice.error <= 3
    ratios = [trial.predicted / trial.error for trial in advice.table
              if trial.kind in ("alone", "together") and trial.error < np.inf]
    assert min(ratios) >= 0.1


def test_a_turned_model_in_space_becomes_planar(advice):
    found = advise(arm(space=True, angle=0.7), H, T_END, "tip.position", 1e-2)
    assert found.model.planar
    assert found.predicted == pytest.approx(advice.predicted, rel=0.5)
    reason = next(one for one in found.reasons if one.of == "model")
    assert reason.chosen == "planar"
    assert reason.confirmed <= 1e-6         # Newton's tolerance in two models
    # the same arm in a plane, turned into it
    one = simulate(found.model, found.step, T_END)
    plane = simulate(arm(), H / 8, T_END, output_every=round(8 * found.step / H))
    travel = np.linalg.norm(plane["tip.position"] - TIP, axis=1)
    place = found.model.plane.to_space("tip.position", one["tip.position"])
    root = found.model.plane.to_space("root.position", one["root.position"])
    off = np.linalg.norm(place - root, axis=1) - np.linalg.norm(
        plane["tip.position"] - ROOT, axis=1)
    assert np.abs(off).max() <= 1e-2 * travel.max()


def test_a_frequency_is_kept():
    found = advise(arm(), H, T_END, "frequency 2", 1e-3)
    whole = modes(Simulation(arm(), H)).omega
    kept = modes(Simulation(found.model, H)).omega
    second = [omega[omega > 1e-5 * omega.max()][1] for omega in (whole, kept)]
    # two modes of the given arm err less than the tolerance themselves
    assert second[1] == pytest.approx(second[0], rel=2e-3)
    assert found.step == H          # frequencies do not depend on it
    assert sum(len(body.reduced.stiffness) for body in found.model.bodies.values()) < 8 * 7


def test_reasons_name_every_part_and_the_step(advice):
    named = [reason.of for reason in advice.reasons if not reason.of.startswith(" ")]
    assert named == ["arm", "step"]
    lines = advice.summary().splitlines()
    assert lines[0].startswith("Keeps tip.position within ")
    assert lines[1].startswith("arm: ")
    assert any(line.startswith("a run takes ") and "the reference model" in line for line in lines)
    assert [line.partition(":")[0] for line in lines if " predicted: " in line] == [
        "at a tolerance of 0.001 predicted", "at a tolerance of 0.1 predicted"]


def test_the_table_is_plain_data(advice):
    rows = advice.rows()
    assert len(rows) == len(advice.table)
    assert {"change", "predicted", "error", "cost", "seconds", "kind"} <= set(rows[0])
    assert all(isinstance(value, str | int | float | None) for row in rows
               for value in row.values())


def test_the_code_makes_the_same_run(advice):
    code = advice.code(["from tests_arm import arm", "model = arm()"]).replace(
        "from tests_arm import arm\n", "")
    made = {"arm": arm}
    exec(code, made)
    whole = simulate(advice.model, advice.step, T_END)
    assert np.array_equal(made["result"]["tip.position"], whole["tip.position"])


def test_an_interrupted_search_returns_the_best_until_then():
    calls = []

    def stop(part: float) -> None:
        calls.append(part)
        if len(calls) > 25:
            raise KeyboardInterrupt
    found = advise(arm(), H, T_END, "tip.position", 1e-2, progress=stop)
    assert found.interrupted
    assert found.error <= 1e-2
    assert "interrupted: this is the best until then" in found.summary().splitlines()
    with pytest.raises(KeyboardInterrupt):      # without a reference there is none
        advise(arm(), H, T_END, "tip.position", 1e-2, progress=lambda part: stop(part))


def test_linear_theory_that_limits_is_said_with_the_best_so_far():
    model = Model(planar=True)
    model.node("tip", TIP), model.node("root", ROOT)
    body = craig_bampton(planar_beam(ROOT, TIP, SOFT, 8), [(0, "full"), (8, "full")], 2)
    model.superelement("arm", body.damped(0.2), ["root", "tip"])
    model.fix("root")
    model.force("tip", (0.0, -60.0), [(0, 0), (0.4, 1.0)])
    with pytest.raises(Unreached, match="limited by linear theory: arm rotates by 0.* divide"
                       ) as caught:
        advise(model, H, T_END, "tip.position", 1e-3)
    assert caught.value.advice.error <= 1e-3       # against the reference model, which is not good
    assert caught.value.advice.model.bodies


def test_a_body_with_a_node_that_keeps_its_rotation_alone_is_looked_at():
    model = Model(planar=True)
    tip, root = model.node("tip", TIP), model.node("root", ROOT)
    middle = model.node("middle", (ROOT + TIP) / 2, keeps="rotation")
    fe_model = planar_beam(ROOT, TIP, SOFT, 8)
    body = craig_bampton(fe_model, [(0, "full"), (4, "rotation"), (8, "full")], 2)
    model.superelement("arm", body, [root, middle, tip])
    model.revolute(root)
    model.torque(root, 1.0, [(0, 0), (0.1, 60.0), (0.3, -60.0), (0.4, 0.0)])
    assert advise(model, H, T_END, "tip.position", 0.05).error <= 0.05


def test_a_scene_that_fails_says_when_and_what_to_do():
    with pytest.raises(SimulationError, match="stopped at t = 0.0.*results up to this time are"):
        advise(arm(torque=1e9), H, T_END, "tip.position", 1e-2)


def smooth(step: float) -> Values:
    """A history with an error of second and of fourth order."""
    t = np.linspace(0.0, 1.0, 11)[:, None]
    return Values([np.sin(3 * t) + step**2 * t + step**4 * t**2], [], (Measure("one"),))


def test_a_reference_knows_its_error_and_where_it_does_not_fall():
    found = reference([smooth(step) for step in (0.2, 0.1, 0.05)])
    exact = np.sin(3 * np.linspace(0.0, 1.0, 11))
    off = np.abs(found.values.histories[0][:, 0] - exact).max() / found.sizes[0]
    assert off / 2 <= found.error <= 10 * off
    assert found.falls
    t = np.linspace(0.0, 1.0, 11)[:, None]
    wild = [Values([np.cos(k * t)], [], (Measure("one"),)) for k in (5.0, 7.0, 10.0)]
    assert not reference(wild).falls


def test_operations_are_those_of_the_kernels():
    name = "superelement_planar_f2_converged_mean_material"
    assert operations(name) == load(name).OPERATIONS["residual"]


def test_a_struck_body_is_quiet_but_for_a_short_time():
    def body(history) -> Model:
        model = Model(planar=True)
        model.node("centre", (3.0, -1.0))
        model.rigid_body("body", "centre", 2.0, 0.5)
        model.force("centre", (1.0, 2.0), history)
        return model
    struck = [(0, 0), (0.2, 0.0), (0.21, 1.0), (0.22, 0.0)]
    always = [(0.02 * k, (-1.0)**k) for k in range(21)]
    quiet, busy = (activity(simulate(body(history), 0.002, T_END)) for history in (struck, always))
    assert quiet < 0.25
    assert busy > 0.9


class Timed:
    """A laboratory whose runs take as long and are as exact as they are said to be."""

    parts, tolerance, bases = [], 1e-2, {H / 8: None}

    def __init__(self, rows):
        """Rows of step, error, error with half the step, and seconds of the first and others."""
        self.rows = {step: own for step, *own in rows}
        self.remarks, self.ran = [], []
        self.tried = [Tried(Choice((), Step(step)), error, error, first)
                      for step, error, _, first, _ in rows]

    def run(self, choice):
        self.ran.append(choice.step.h)
        return types.SimpleNamespace(seconds=self.rows[choice.step.h][3])

    def attempt(self, choice, kind):
        half = self.rows[2 * choice.step.h][1]
        return Tried(choice, half, half, 1.0), None

    def spent(self):
        return 0.0


@pytest.mark.parametrize("rows, chosen, said", [
    # the second one is quicker and more exact
    ([(0.01, 6e-3, 2e-3, 1.46e-3, 1.46e-3), (0.03, 2e-3, 5e-4, 1.3e-3, 1.3e-3)], 0.03, ""),
    ([(0.01, 6e-3, 2e-3, 1.46e-3, 1.46e-3), (0.03, 9e-3, 5e-4, 1.0e-3, 1.0e-3)], 0.03, ""),
    ([(0.01, 6e-3, 2e-3, 1.46e-3, 1.46e-3), (0.03, 2e-3, 5e-2, 1.3e-3, 1.3e-3)], 0.01,
     "with half its step its error is above the tolerance"),
    # by chance: repeated, the first one is as quick
    ([(0.01, 6e-3, 2e-3, 1.46e-3, 1.3e-3), (0.03, 2e-3, 5e-4, 1.29e-3, 1.29e-3)], 0.01,
     "not clearly less than 1.3 ms"),
    ([(0.01, 6e-3, 2e-3, 1.46e-3, 1.4e-3), (0.03, 2e-2, 5e-4, 1.0e-3, 1.0e-3)], 0.01, "")])
def test_the_best_run_of_the_table_is_chosen(rows, chosen, said):
    lab = Timed(rows)
    search = Search(lab, budget=10.0)
    assert search.better(lab.tried[0]).choice.step.h == chosen
    assert [said in one for one in lab.remarks] == [True] * bool(said)


def test_a_quicker_row_that_is_not_chosen_is_remarked(advice):
    """As the table and the summary have them; a row that was repeated may be the chosen one."""
    for row in advice.table:
        if row.error <= advice.tolerance and row.seconds < advice.seconds and row.kind in (
                "alone", "together", "confirmation", "given"):
            assert row is advice.trial or f"{row.change}, step {row.step:.4g}" in advice.summary()
