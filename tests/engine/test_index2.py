"""The stabilised index-2 form: no drift of velocities, multipliers of second order throughout."""

import numpy as np
import pytest
from helpers import order
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, Tolerance, generalized_alpha, hht, simulate
from sebody.analysis import Ensemble, final
from sebody.assembly.build import DENSE_LIMIT
from sebody.compiler.choice import why_no_lanes
from sebody.contract.counts import MEMBERS
from sebody.explore.ensembles import ensemble
from sebody.fem import rectangle
from sebody.scenes import chain, four_bar, heavy_top, squeezer

TOLERANCE = 1e-11       # of increments above 0.04: above rounding of positions


def top(index, h, t_end=0.5):
    scene = heavy_top.build(explicit=True)
    scheme = generalized_alpha(tolerance=TOLERANCE, index=index)
    result = Simulation(scene.model, h, scheme).run_to(t_end).result()
    return result, result[f"{scene.model.joints[0].name}.multipliers"]


@pytest.mark.parametrize("index, expected", [(2, (1.8, 2.3)), (3, (0.8, 1.3))])
def test_order_of_multipliers(index, expected):
    """Against the finest run: with index 3 the start leaves an error of first order."""
    finest = 3.125e-5
    exact, steps = top(2, finest)[1], (1e-3, 5e-4, 2.5e-4)
    errors = []
    for h in steps:
        result, multipliers = top(index, h)
        k = round(h / finest)
        errors.append(np.abs(multipliers - exact[::k]).max() / np.abs(exact).max())
        if index == 2:
            # what is left: the tolerance of the increment h v, in rates times gamma / (beta h)
            left = TOLERANCE * np.abs(result.recorded("v")).max()
            scheme = generalized_alpha()
            assert result["constraints.velocity"].max() < left * scheme.gamma / scheme.beta
            assert result["constraints.position"].max() < left * h
        else:
            assert result["constraints.velocity"].max() > 1e-3
    assert expected[0] < order(steps, errors) < expected[1]


def test_motion_of_the_top_is_more_accurate():
    exact = top(2, 6.25e-5)[0]["centre.position"]
    errors = [np.abs(top(i, 1e-3)[0]["centre.position"] - exact[::16]).max() for i in (2, 3)]
    assert errors[0] < 0.5 * errors[1]


def test_closed_loops_and_redundant_constraints():
    """Both forms move alike, to the order of the step."""
    for build, h, t_end, node in ((squeezer.build, 2e-5, 0.02, "crank.rotation"),
                                  (four_bar.build, 1e-3, 1.0, None)):
        results = [Simulation(build().model, h, generalized_alpha(index=i, tolerance=1e-10)).run_to(
            t_end).result() for i in (3, 2)]
        node = node or next(f"{n}.position" for n in results[0].model.nodes
                            if not results[0].model.nodes[n].position.fixed)
        assert np.abs(results[0][node] - results[1][node]).max() < 2e-4 * np.abs(
            results[0][node]).max()
        assert results[1]["constraints.velocity"].max() < 1e-6 * np.abs(
            results[1].recorded("v")).max()


def test_large_systems():
    """Corrections of positions through the elimination by blocks."""
    result = Simulation(chain.build(8).model, 0.01, generalized_alpha(index=2)).run_to(0.2).result()
    assert result.numbering.free > DENSE_LIMIT
    assert result["constraints.velocity"].max() < 1e-7 * np.abs(result.recorded("v")).max()
    assert result["constraints.position"].max() < 1e-9


def arms(explicit):
    """Two hanging beams on hinges that are not parallel; the first turns by 110 degrees."""
    turn = Rotation.from_rotvec((0.4, -1.1, 0.7)).as_matrix()
    points = (0, 0, 0), (0.7, 0.1, 0), (0.7, 0.1, 0), (1.2, 0.3, 0.2)
    model = Model()
    a, b, c, d = (model.node(name, turn @ x) for name, x in zip("abcd", points, strict=True))
    section = rectangle(0.03, 0.05, youngs_modulus=2e9, poisson_ratio=0.3, density=4e3)
    for name, ends in (("upper", (a, b)), ("lower", (c, d))):
        model.beam(name, ends, section, elements=4, bodies=1, modes=4)
    model.revolute(a, axis=turn @ (0.1, 0.2, 1.0), explicit=explicit)
    model.revolute(b, axis=turn @ (-0.2, 0.1, 1.0), to=c, explicit=explicit)
    model.gravity(turn @ (1.0, -9.0, 3.0))
    return model


@pytest.mark.parametrize("how", [{"scheme": generalized_alpha(tolerance=1e-10, index=2)},
                                 {"tolerance": Tolerance(1e-4)}])
def test_equations_of_joints_on_bodies_that_turn(how):
    """Against shared positions, which need no equations, to what Newton's iteration leaves.

    Corrections of positions were solved for in the axes of bodies from residuals in those of space:
    runs stopped once a body had turned by 60 degrees.
    """
    runs = [simulate(arms(explicit), 2e-3, 0.8, **how) for explicit in (True, False)]
    by_equations, shared = (run["d.position"] for run in runs)
    assert by_equations[0] @ by_equations[-1] < 0.0
    assert np.abs(by_equations - shared).max() < 1e-6
    assert runs[0]["constraints.position"].max() < 1e-8


@pytest.mark.skipif(bool(why_no_lanes()), reason=why_no_lanes())
def test_equations_of_joints_of_members(monkeypatch):
    """The same in ensembles, against single runs."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    factors, scheme = np.linspace(0.9, 1.1, MEMBERS), generalized_alpha(index=2)
    many = Ensemble(arms(True), 2e-3, scheme)
    field = many.model.gravity_field
    found = many.run({"gravity": np.multiply.outer(factors, field)}, 0.8,
                     {"end": final("d.position")})
    assert found.in_lanes == MEMBERS
    alone = arms(True)
    alone.gravity(factors[0] * field)
    end = simulate(alone, 2e-3, 0.8, scheme)["d.position"][-1]
    assert np.abs(found["end"][0] - end).max() < 1e-10


def test_wrong_index():
    with pytest.raises(InputError, match="index is 1: use 3, or 2 for the stabilised form"):
        hht(index=1)
