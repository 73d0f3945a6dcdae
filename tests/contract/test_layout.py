"""The table of contracts: where parts are, packing by name, names of layouts."""

import numpy as np
import pytest

from sebody.contract.counts import LANES, layout_name, superelement_counts, whole_vectors
from sebody.contract.layout import (
    AT_CONSTANTS,
    AT_FRAME,
    AT_PORT,
    AT_POSITIONS,
    AT_ROTATIONS,
    COEFFICIENTS,
    ENERGIES,
    FIELD,
    HEADER,
    INDEX,
    KINETIC,
    MOMENT,
    MOMENTUM,
    POTENTIAL,
    POWERS,
    RECORD,
    STRAIN,
    ContractError,
    Part,
    Row,
)

COUNTS = {"n": 5, "D": 3}
ROW = Row("a row", (Part("mass"), Part("axis", (3,)), Part("S", ("n", "n"), columns=True),
                    Part("X", (2, "D"))))


def test_parts_follow_each_other():
    """A column of five numbers takes two vectors of four."""
    assert LANES == 4 and [whole_vectors(k) for k in (0, 1, 4, 5)] == [0, 4, 4, 8]
    slices = ROW.slices(COUNTS)
    assert slices == {"mass": slice(0, 1), "axis": slice(1, 4), "S": slice(4, 44),
                      "X": slice(44, 50)}
    assert ROW.size(COUNTS) == 50
    assert ROW.first("S") == 4


def test_place_behind_a_part_of_no_fixed_size():
    with pytest.raises(KeyError):
        ROW.first("X")


def values():
    random = np.random.default_rng(0)
    return {"mass": 2.0, "axis": random.normal(size=3), "S": random.normal(size=(5, 5)),
            "X": random.normal(size=(2, 3))}


def test_pack_and_unpack_are_inverse():
    given = values()
    row = ROW.pack(COUNTS, given)
    found = ROW.unpack(COUNTS, row)
    assert row.shape == (50,)
    assert all(np.array_equal(found[name], value) for name, value in given.items())
    assert np.array_equal(row[4:12], [*given["S"][:, 0], 0, 0, 0])     # a column and its padding


def test_order_of_the_values_does_not_matter():
    given = values()
    assert np.array_equal(ROW.pack(COUNTS, given), ROW.pack(COUNTS, dict(reversed(given.items()))))


@pytest.mark.parametrize("change, message", [
    ({"mass": None}, "a row: the kernel reads mass, axis, S, X; given are axis, S, X"),
    ({"extra": 1.0}, "a row: the kernel reads mass, axis, S, X; given are mass, axis, S, X, extra"),
    ({"axis": np.ones(2)}, r"a row: axis has shape \(2,\), the kernel reads \(3,\)"),
    ({"mass": np.ones(1)}, r"a row: mass has shape \(1,\), the kernel reads \(\)"),
    ({"S": np.ones((5, 4))}, r"a row: S has shape \(5, 4\), the kernel reads \(5, 5\)")])
def test_values_that_do_not_fit_are_refused(change, message):
    given = {name: value for name, value in (values() | change).items() if value is not None}
    with pytest.raises(ContractError, match=message):
        ROW.pack(COUNTS, given)


def test_rows_of_integers():
    counts = {"N_ROTATIONS": 2, "n": 3}
    given = {"unknowns": [7, 8, 9], "constants": 40, "frame": 1, "port": 2, "nodes": [5, 6],
             "rotations": 2, "positions": 3}
    row = INDEX.pack_integers(counts, given)
    assert row == [40, 1, 2, 3, 2, 5, 6, 7, 8, 9]
    assert {name: row[part] for name, part in INDEX.slices(counts).items()} == {
        name: value if isinstance(value, list) else [value] for name, value in given.items()}


@pytest.mark.parametrize("change, message", [
    ({"port": None}, "the kernel reads constants, frame, port, positions, rotations, nodes, "
                     "unknowns; given are constants, frame, nodes, unknowns, positions, rotations"),
    ({"nodes": [5]}, r"nodes has shape \(1,\), the kernel reads \(2,\)"),
    ({"frame": [1]}, r"frame has shape \(1,\), the kernel reads \(\)"),
    ({"nodes": 5}, r"nodes has shape \(\), the kernel reads \(2,\)")])
def test_integers_that_do_not_fit_are_refused(change, message):
    given = {"constants": 40, "frame": 1, "port": 2, "nodes": [5, 6], "unknowns": [7, 8, 9],
             "positions": 3, "rotations": 2}
    given = {name: value for name, value in (given | change).items() if value is not None}
    with pytest.raises(ContractError, match="index row of an element: " + message):
        INDEX.pack_integers({"N_ROTATIONS": 2, "n": 3}, given)


def test_row_without_parts():
    nothing = Row("nothing", ())
    assert nothing.pack({}, {}).shape == (0,) and nothing.size({}) == 0
    with pytest.raises(ContractError, match="the kernel reads nothing; given are mass"):
        nothing.pack({}, {"mass": 1.0})


def test_named_places_are_those_of_the_rows():
    """Places of the index, coefficients and energies, counted by hand."""
    assert (AT_CONSTANTS, AT_FRAME, AT_PORT, AT_POSITIONS, AT_ROTATIONS, HEADER) == tuple(range(6))
    assert INDEX.slices({"N_ROTATIONS": 2, "n": 7})["unknowns"] == slice(7, 14)
    assert FIELD == 5 and COEFFICIENTS.size({}) == 8
    assert (KINETIC, STRAIN, MOMENTUM, MOMENT, POTENTIAL, POWERS) == (0, 1, 2, 5, 8, 9)
    assert ENERGIES.size({"ports": 4}) == 13
    assert list(RECORD.slices({"ports": 1, "coordinates": 2, "rotations": 1, "stored": 9}))[:3] == [
        "t", "iterations", "works"]


@pytest.mark.parametrize("keeps, planar, name", [
    (["full", "full"], False, "f2"), (["rotation", "full", "translation", "full"], False, "f2t1r1"),
    (["translation"] * 8, False, "t8"), (["full"] * 3, True, "planar-f3")])
def test_name_of_a_layout(keeps, planar, name):
    assert layout_name(keeps, planar) == name


def test_counts_of_a_superelement():
    assert superelement_counts(3, 2, True, 11) == {"N_POSITIONS": 3, "N_ROTATIONS": 2, "D": 2,
                                                   "n": 11}
