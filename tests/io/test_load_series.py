"""Series of loads as tables: values between rows, jumps, CSV files, wrong tables."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.interpolate import CubicSpline

from sebody import InputError
from sebody.io import LoadSeries

T = np.array([0.0, 0.5, 0.5, 1.5, 2.0])
VALUES = np.array([[1.0, 0.0], [3.0, 0.0], [-1.0, 2.0], [5.0, 0.0], [5.0, 1.0]])


def test_linear_and_cubic_between_jumps():
    for interpolation in ("linear", "cubic"):
        series = LoadSeries(T, VALUES, ["a", "b"], interpolation)
        times = np.array([-1.0, 0.25, 0.5 - 1e-12, 0.5, 0.9, 1.7, 2.0, 9.0])
        second = CubicSpline(T[2:], VALUES[2:]) if interpolation == "cubic" else (
            lambda t: np.column_stack([np.interp(t, T[2:], VALUES[2:, k]) for k in (0, 1)]))
        exact = np.vstack([VALUES[:1], [[2.0, 0.0]], VALUES[1:2], second([0.5, 0.9, 1.7, 2.0]),
                           VALUES[-1:]])
        assert_allclose(series.at(times), exact, rtol=0, atol=1e-10)
        assert series.pieces.jumps.tolist() == [0.5]
    assert LoadSeries(T, VALUES, ["a", "b"]).pieces.corners.tolist() == [0.0, 0.5, 1.5, 2.0]
    assert series.pieces.corners.tolist() == [0.0, 0.5, 2.0]     # a spline has none within
    first = LoadSeries([1.0, 1.0], [[2.0], [5.0]], ["a"])
    assert first.at([0.0, 0.999, 1.0, 3.0]).ravel().tolist() == [2.0, 2.0, 5.0, 5.0]
    assert series.scaled(2.0).values[1, 0] == 6.0 and series.chosen(["b"]).names == ("b",)
    with pytest.raises(ValueError):
        series.values[0, 0] = 1.0


def test_csv_files_bit_for_bit(tmp_path):
    random = np.random.default_rng(5)
    plain = LoadSeries(np.cumsum(random.random(50)), random.normal(size=(50, 3)) * 10.0**-7,
                       ["tip.x", "mode 0", "mode 3"], others={"level": random.random(50)})
    path = plain.to_csv(tmp_path / "loads.csv")
    read = LoadSeries.from_csv(path, "cubic", ["tip.x", "mode 0", "mode 3"])
    assert_array_equal(read.values, plain.values)
    assert_array_equal(read.t, plain.t)
    assert_array_equal(read.others["level"], plain.others["level"])
    path.write_text("# made by hand\ntime, x\n\n0, 1\n1, 2\n")
    assert LoadSeries.from_csv(path).at(0.5)[0, 0] == 1.5


@pytest.mark.parametrize("text, message", [
    ("", "has no table"), ("t,x\n", "has no table"), ("t\n0\n", "has no table"),
    ("t,x\n0,1\n1,a\n", "line 3: '1,a' is no row of numbers"),
    ("t,x\n0,1,2\n", "line 2: 3 numbers for 2 names"),
    ("t,x\n1,1\n0,1\n", "times of a load series must not decrease, after t = 1"),
    ("t,x\n0,nan\n", "values of a load series"), ("t,x,x\n0,1,1\n", "a different name for each")])
def test_wrong_csv_files(tmp_path, text, message):
    path = tmp_path / "loads.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        LoadSeries.from_csv(path)
    assert message in str(caught.value)


def test_refused(tmp_path):
    for arguments, message in (
            ((T, VALUES[:3], ["a", "b"]), "give 5 rows"), (([], np.zeros((0, 1)), ["a"]), "no row"),
            (([0, 0, 0], np.zeros((3, 1)), ["a"]), "more than two rows at t = 0"),
            ((T, VALUES, ["a", "b"], "quadratic"), "interpolation"),
            ((T, VALUES, ["a", "b"], "linear", {"c": [1.0]}), "column 'c'")):
        with pytest.raises(InputError) as caught:
            LoadSeries(*arguments)
        assert message in str(caught.value)
    with pytest.raises(InputError, match="column 'c' is unknown"):
        LoadSeries(T, VALUES, ["a", "b"]).chosen(["c"])
    with pytest.raises(InputError, match="load series"):
        LoadSeries(T, VALUES, ["a", "b"]).to_csv(tmp_path / "no" / "a.csv")
    with pytest.raises(InputError, match="none.csv"):
        LoadSeries.from_csv(tmp_path / "none.csv")
