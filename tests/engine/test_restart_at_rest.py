"""The start of stiff bodies at rest, whose forces are rounding and nothing else."""

import sys
from pathlib import Path

import numpy as np
import pytest

from sebody import Model, simulate

sys.path.insert(0, str(Path(__file__).parents[1]))
from many_interfaces import patched_block


@pytest.mark.parametrize("h", [1e-2, 1e-5])
def test_a_stiff_block_rests(h):
    """On five patches, in its default frame, turned; whatever the step, nothing moves."""
    body = patched_block(40, 0.3, 2)
    model = Model()
    nodes = [model.node(f"n{k}", point) for k, point in enumerate(body.coordinates)]
    model.superelement("block", body, nodes)
    result = simulate(model, h, 5 * h)
    for k in range(len(nodes)):
        place = result[f"n{k}.position"]
        assert np.abs(place - place[0]).max() < 1e-11
