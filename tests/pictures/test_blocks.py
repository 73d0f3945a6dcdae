"""Numbers in blocks against those given."""

import zlib

import numpy as np
from page_data import whole_numbers

from sebody.pictures.blocks import Blocks


def read(blocks, block):
    content = np.frombuffer(zlib.decompress(blocks.bytes()), "u1")
    if "count" in block:
        return whole_numbers(content, block, block["count"], 1)[:, 0]
    found = np.tile(block["low"], (block["shape"][0], 1))
    found[:, block["varying"]] += np.array(block["step"]) * whole_numbers(
        content, block, len(found), len(block["varying"]))
    return found


def test_blocks_hold_what_was_given():
    rng = np.random.default_rng(4)
    values = rng.normal(size=(50, 5)) * [1.0, 1e-9, 1e6, 0.0, 3.0] + [0.0, 7.0, -1e6, 2.5, 1e3]
    blocks = Blocks()
    first = blocks.values(values)
    fine = blocks.values(values, seen=1e-4)
    places = blocks.indices(np.array([3, 1, 70000]))
    small = blocks.indices(np.array([3, 1, 7]))
    again = blocks.values(values)
    assert (first["bytes"], fine["bytes"], places["bytes"], small["bytes"]) == (2, 4, 4, 2)
    assert again["at"] == first["at"]           # stored once
    assert 3 not in first["varying"]            # a constant is not stored
    half = np.ptp(values, axis=0) / 0xFFFF / 2
    # ranges are written with twelve digits
    digits = 1e-12 * np.abs(values).max(axis=0) + 2e-12 * np.ptp(values, axis=0)
    assert (np.abs(read(blocks, first) - values).max(axis=0) <= half + digits).all()
    assert np.abs(read(blocks, fine) - values).max() < 1e-3
    assert read(blocks, places).tolist() == [3, 1, 70000]
    assert read(blocks, small).tolist() == [3, 1, 7]


def test_smooth_histories_take_little_room():
    t = np.linspace(0, 60, 1801)
    blocks = Blocks()
    blocks.values(np.column_stack([np.sin(k + 0.3 * k * t) for k in range(1, 9)]))
    assert len(blocks.bytes()) < 0.62 * 2 * 8 * 1801


def test_empty_and_single_rows():
    blocks = Blocks()
    for array in (np.zeros((0, 3)), np.zeros((4, 0)), np.array([[1.5, -2.0]])):
        block = blocks.values(array)
        assert read(blocks, block).shape == array.shape
        np.testing.assert_allclose(read(blocks, block), array)
