"""The stabilised index-2 form: no drift of velocities, multipliers of second order throughout."""

import numpy as np
import pytest
from helpers import order

from sebody import InputError, Simulation, generalized_alpha, hht
from sebody.assembly.build import DENSE_LIMIT
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


def test_wrong_index():
    with pytest.raises(InputError, match="index is 1: use 3, or 2 for the stabilised form"):
        hht(index=1)
