"""Models of many kinds in lanes: each member equals its single run, in whatever order."""

import numpy as np
import pytest
from helpers import multipliers_first
from lane_models import assert_bits_in_other_company, chain, flowing, single
from readings import TABLE

from sebody import Simulation, generalized_alpha
from sebody.analysis import Ensemble, final, maximum
from sebody.assembly import build as assembly
from sebody.compiler.choice import way
from sebody.explore.ensembles import ensemble
from sebody.explore.ensembles.choice import matrices_at_once

RUNS = 9        # one group of eight, and one run
H = 1e-3
AT_ONCE = "chain", "driven rotor", "long chain"     # bodies that rotate against each other
CUT = "stops", "contacts"       # steps of members, each at its own times, or never

pytestmark = pytest.mark.skipif(
    way().__name__.endswith("plain"), reason="the plain way makes runs one by one")


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
@pytest.mark.parametrize(("name", "index"), [(name, index) for name, row in TABLE.items()
                                             for index in row.index])
def test_members_equal_single_runs(name, index, monkeypatch):
    """Parameters vary; alone and backwards the bits are the same.

    Where a model has no lanes the outcome says why, and its runs are those of single ones, too.
    """
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    row, made, scheme = TABLE[name], TABLE[name].build(), generalized_alpha(index=index)
    words = row.refused.get("lanes", "")
    given = row.members(made, 2 if words else RUNS)
    kept = {"course": row.followed, "most": maximum(row.followed),
            "energy": final("energy.kinetic")}
    many = Ensemble(made, row.h, scheme)
    assert matrices_at_once(many._template) == (name in AT_ONCE)
    found = many.run(given, row.end, kept)
    assert words in found.why_one_by_one and not found.failures
    assert bool(found.why_one_by_one) == bool(words)
    assert found.in_lanes == (0 if words else RUNS)
    if not words:
        assert_bits_in_other_company(many, given, row.end, kept, found)
    cuts = []
    for run in (range(RUNS) if name in CUT else (0, -1)):
        result = single(made, {name: v[run] for name, v in given.items()}, row.h, row.end,
                        scheme)
        cuts.append(result.cuts)
        course = result[row.followed]
        size = np.abs(course).max()
        assert np.abs(found["course"][run] - course).max() < 1e-10 * size
        assert np.abs(found["most"][run] - course.max(axis=0)).max() < 1e-10 * size
        assert found["energy"][run] == pytest.approx(result["energy.kinetic"][-1], rel=1e-6)
    assert name not in CUT or min(cuts) == 0 < max(cuts) and len(set(cuts)) > 2


def test_bits_do_not_depend_on_company_where_an_iterate_is_no_number(monkeypatch):
    """Steps are too long: a member whose iteration gives no numbers has its step made anew.

    What members beside it do until then is nothing to it.
    """
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    rng = np.random.default_rng(3)
    given = {"load.amplitude": 4.0 * rng.uniform(-1, 2, 8),
             "gravity": rng.uniform(-900, 900, (8, 3))}
    many, outputs = Ensemble(chain(), 4 * H), {"course": "tip.position"}
    found = many.run(given, 20 * 4 * H, outputs)
    alone = many.run({name: v[:1] for name, v in given.items()}, 20 * 4 * H, outputs)
    assert found.in_lanes == 8 and alone.in_lanes == 1
    np.testing.assert_array_equal(alone["course"][0], found["course"][0])


def test_matrices_at_once_do_not_depend_on_who_wants_new_ones_of_bodies(monkeypatch):
    """Loads on bodies search for frames where matrices of bodies are rotated, too."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    made = chain(frame="mean_axes")
    for body in made.bodies:
        made.body_load(body, "wind", [(0, 0), (0.02, 30.0)])
    rng = np.random.default_rng(0)
    given = {"load.amplitude": 0.1 * rng.uniform(-1, 2, 8),
             "gravity": rng.uniform(-100, 100, (8, 3))}
    many, outputs = Ensemble(made, 2 * H), {"course": "tip.position"}
    assert matrices_at_once(many._template)
    found = many.run(given, 25 * 2 * H, outputs)
    for run in range(8):
        alone = many.run({name: v[run:run + 1] for name, v in given.items()}, 25 * 2 * H, outputs)
        assert alone.in_lanes == 1
        np.testing.assert_array_equal(alone["course"][0], found["course"][run])


@pytest.mark.parametrize(("build", "index"), [
    (chain, 3), (chain, 2), (lambda: flowing(chain(), "end 1", "hinge 0", 1e4, held=False), 3)])
def test_members_with_row_exchanges_equal_single_runs(build, index, monkeypatch):
    """Multipliers come first, so every matrix needs them, made at once or one by one.

    With index 2 factors solve twice an iteration.
    """
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    monkeypatch.setattr(assembly, "number", multipliers_first(assembly.number))
    rng, made, scheme = np.random.default_rng(5), build(), generalized_alpha(index=index)
    assert Simulation(made, H, scheme).run_to(H).state.control.pivoted == 1
    given = {f"{name}.stiffness": rng.uniform(0.7, 1.5, RUNS) for name in made.bodies}
    given |= {"load.amplitude": rng.uniform(-1, 2, RUNS),
              "gravity": rng.uniform(-900, 900, (RUNS, 3))}
    many, outputs = Ensemble(made, H, scheme), {"course": "tip.position"}
    found = many.run(given, 30 * H, outputs)
    assert found.in_lanes == RUNS and not found.failures
    assert_bits_in_other_company(many, given, 30 * H, outputs, found)
    for run in (0, 8):
        result = single(made, {name: v[run] for name, v in given.items()}, H, 30 * H, scheme)
        size = np.abs(result["tip.position"]).max()
        assert np.abs(found["course"][run] - result["tip.position"]).max() < 1e-10 * size


def test_members_come_back_from_steps_astray(monkeypatch):
    """Steps are too long: what their iterations leave is nothing to the next ones."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    rng = np.random.default_rng(3)
    given = {"load.amplitude": 4.0 * rng.uniform(-1, 2, RUNS),
             "gravity": rng.uniform(-900, 900, (RUNS, 3))}
    found = Ensemble(chain(), 4 * H).run(given, 40 * 4 * H, {"course": "tip.position"})
    assert found.in_lanes == RUNS and not found.failures
