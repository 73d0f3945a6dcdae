"""Base motion by accelerations against exact responses of a linear oscillator."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, simulate
from sebody.analysis import Ensemble, final
from sebody.model.profiles import harmonic, ramp

X = Rotation.from_rotvec((0.3, 1.1, -0.4)).apply((1.0, 0.0, 0.0))
PLACE = np.array([0.4, -2.0, 1.0])
MASS, STIFFNESS, DAMPING = 2.0, 150.0, 1.2
TIMES = np.linspace(0.0, 4.0, 41)
ROWS = np.column_stack([TIMES, 3.0 * np.random.default_rng(7).normal(size=41) * np.exp(-TIMES)])


def oscillator(**given):
    """A mass on a slider, on a spring to a base that is moved."""
    model = Model()
    model.node("base", PLACE)
    model.node("mass", PLACE + 0.5 * X)
    model.rigid_body("body", "mass", MASS, (0.1, 0.1, 0.1))
    model.prismatic("mass", X, to="base", name="guide")
    model.spring("mass", "base", STIFFNESS, DAMPING)
    model.fix("base", "rotation")
    model.move("base", X, name="quake", **given)
    return model


def exact(rows, times):
    """Relative displacement: pieces of linear acceleration by exponentials of matrices."""
    A = np.zeros((4, 4))        # displacement, speed, acceleration of the base and its slope
    A[0, 1], A[2, 3] = 1.0, 1.0
    A[1] = -STIFFNESS / MASS, -DAMPING / MASS, -1.0, 0.0
    t, state, found = 0.0, np.zeros(2), [0.0]
    for end in times[1:]:
        while t < end - 1e-12:
            k = int(np.searchsorted(rows[:, 0], t + 1e-12, side="right")) - 1
            last = k + 1 >= len(rows)
            until = end if last else min(end, rows[k + 1, 0])
            slope = 0.0 if last else (rows[k + 1, 1] - rows[k, 1]) / (rows[k + 1, 0] - rows[k, 0])
            a = 0.0 if last else rows[k, 1] + slope * (t - rows[k, 0])
            state = (expm((until - t) * A) @ [*state, a, slope])[:2]
            t = until
        found.append(state[0])
    return np.array(found)


def errors(rows, **given):
    found = []
    for h in (0.02, 0.01, 0.005):
        result = simulate(oscillator(acceleration=rows, **given), h, 5.0)
        wanted = exact(np.asarray(rows), result.t)
        found.append(np.abs(result["guide.displacement"] - wanted).max() / np.abs(wanted).max())
    return np.array(found)


def test_an_accelerogram_is_of_second_order():
    """The base follows exactly, the oscillator by the square of the step."""
    found = errors(ROWS, drift="keep")
    np.testing.assert_allclose(np.log2(found[:-1] / found[1:]), 2.0, atol=0.01)
    assert found[-1] < 3e-3
    result = simulate(oscillator(acceleration=ROWS, drift="keep"), 0.02, 5.0)
    inside = result.t < 4.0 - 1e-9
    np.testing.assert_allclose((result["base.acceleration"] @ X)[inside],
                               np.interp(result.t, *ROWS.T)[inside], atol=1e-9)


@pytest.mark.parametrize("first", ["", "t,a\n"])
def test_a_file_and_a_table_are_the_same(tmp_path, first):
    path = tmp_path / "quake.csv"
    path.write_text(first + "\n".join(f"{float(t)!r},{float(a)!r}" for t, a in ROWS))
    one, other = (simulate(oscillator(acceleration=given, drift="keep"), 0.02, 1.0)
                  for given in (path, ROWS))
    assert np.array_equal(one.rows, other.rows)


def test_drift_is_removed_and_told():
    """A straight line from the accelerations leaves neither speed nor way."""
    with pytest.warns(UserWarning, match="leaves a speed of .* and a way of .*drift='remove'"):
        left = oscillator(acceleration=ROWS)
    with pytest.warns(UserWarning, match="are removed by a straight line from .* % of the largest"):
        right = oscillator(acceleration=ROWS, drift="remove")
    before, after = (simulate(model, 0.02, 5.0) for model in (left, right))
    speed, way = (before[f"base.{name}"][-1] @ X for name in ("velocity", "position"))
    assert abs(speed) > 1e-2 and abs(way - PLACE @ X) > 1e-2
    np.testing.assert_allclose(after["base.position"][-1], PLACE, atol=1e-12)
    np.testing.assert_allclose(after["base.velocity"][-1], 0.0, atol=1e-12)
    change = (after["base.acceleration"] - before["base.acceleration"]) @ X
    inside = after.t < 4.0 - 1e-9
    assert np.abs(np.diff(change[inside], 2)).max() < 1e-11


def wave(t):
    """An acceleration."""
    return 2.0 * np.sin(7.0 * t) - 0.4 * t


@pytest.mark.parametrize("given, way", [
    (wave, lambda t: 2.0 * (t / 7.0 - np.sin(7.0 * t) / 49.0) - t**3 / 15.0),
    (harmonic(2.0, 7.0), lambda t: 2.0 * (t / 7.0 - np.sin(7.0 * t) / 49.0)),
    (harmonic(2.0, 7.0, 0.5), lambda t: 2.0 * (np.sin(0.5) / 49.0 + np.cos(0.5) * t / 7.0
                                               - np.sin(7.0 * t + 0.5) / 49.0)),
    (ramp(1.0, 0.9, 0.3), lambda t: np.where(
        t < 0.3, 0.0, np.where(t < 1.2, (t - 0.3)**3 / 6.0, 0.1215 + 0.405 * (t - 1.2)
                               + 0.45 * (t - 1.2)**2)))])
def test_functions_are_integrated_exactly(given, way):
    result = simulate(oscillator(acceleration=given), 0.01, 1.5)
    np.testing.assert_allclose((result["base.position"] - PLACE) @ X, way(result.t), atol=1e-12)


def test_amplitudes_vary():
    """The motion is linear in its amplitude."""
    found = Ensemble(oscillator(acceleration=ROWS, drift="keep"), 0.02).run(
        {"quake.amplitude": [1.0, 2.5]}, 1.0, {"x": final("guide.displacement")})
    assert found["x"][1] == pytest.approx(2.5 * found["x"][0], rel=1e-9)


def test_refused(tmp_path):
    """Wrong tables, files and functions."""
    (tmp_path / "wrong.csv").write_text("0, 1\n1\n")
    (tmp_path / "empty.csv").write_text("# nothing\n")

    def jumping(t):
        return 1.0 if t > 1.0 else 0.0
    for given, said in (
            ({}, "motion of base.position: give either motion= or acceleration="),
            ({"motion": ROWS, "acceleration": ROWS}, "give either motion= or acceleration="),
            ({"motion": ROWS, "drift": "keep"}, "drift= is that of an acceleration"),
            ({"acceleration": ROWS, "drift": "all"}, "acceleration of base.position: drift"),
            ({"acceleration": wave, "drift": "remove"}, "drift is of a table, which ends"),
            ({"acceleration": [(0.0, 1.0)]}, "has one row: give at least two rows"),
            ({"acceleration": [(0.0, 1.0), (0.0, 2.0)]}, "must increase: sort the rows"),
            ({"acceleration": [(0.0, 1.0), (1.0, np.nan)]}, "contains NaN or infinite entries"),
            ({"acceleration": [1.0, 2.0, 3.0]}, "has shape (3,): give rows (t, value)"),
            ({"acceleration": jumping}, "'jumping' cannot be integrated"),
            ({"acceleration": "nowhere.csv"}, "nowhere.csv"),
            ({"acceleration": tmp_path / "wrong.csv"}, "has the row '1', which has no number for "
             "each of the 2 columns"),
            ({"acceleration": tmp_path / "empty.csv"}, "is empty: give rows of 2 numbers")):
        with pytest.raises(InputError) as caught:
            oscillator(**given)
        assert said in str(caught.value)
