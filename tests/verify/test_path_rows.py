"""Rows of points on paths against differences, closer than `sebody check` asks of all kernels."""

import pytest

from sebody.contract.layout import RESIDUAL
from sebody.kernels.loader import load
from sebody.verify.check.elements import joint_acceleration, joint_force, joint_velocity
from sebody.verify.check.paths import body_path_case
from sebody.verify.check.states import difference, evaluate, gradient
from sebody.verify.check.superelement_cases import nodes_of

FRAMES = "converged_mean", "mean_axes", "positions"


@pytest.mark.parametrize("plane", ["", "planar_"])
@pytest.mark.parametrize("frame", FRAMES)
def test_rows_agree_with_differences(plane, frame):
    """Of a body that has all of the path, in even states, and of one that hands over to the next.

    Differences of order six are off by their step to the sixth power, 1e-9 at most in these states,
    and by rounding over its square.
    """
    module = load(f"element_{plane}body_path_{frame}")
    for nodes in nodes_of(module)[:2]:
        for seed in range(2):
            case = body_path_case(module, seed, nodes)
            for measure in (joint_force, joint_velocity, joint_acceleration):
                assert measure(case) < 1e-9, (nodes, seed, measure.__name__)


@pytest.mark.parametrize("kind", ["path_turn", "planar_path_turn", "path_across"])
@pytest.mark.parametrize("frame", FRAMES)
def test_rows_of_single_equations_agree_with_differences(kind, frame):
    """Sections turn far in these states, so steps are a quarter of those above."""
    module = load(f"element_{kind}_{frame}")
    for nodes in nodes_of(module)[:2]:
        for seed in range(2):
            case = body_path_case(module, seed, nodes)
            rows = gradient(case, lambda c: c.q[-1] * evaluate(c, RESIDUAL)[0][-1], 0.005)[:-1]
            assert difference(evaluate(case, RESIDUAL)[0][:-1], rows) < 1e-9, (nodes, seed)
