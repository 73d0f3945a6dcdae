"""Bearings by tables of the speed, read at every speed of linear analyses."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rotor_models import AXIS, TURNED, about_shaft

from sebody import InputError, Model, simulate
from sebody.analysis import campbell, critical_speeds, equilibrium, modes, synchronous_response
from sebody.model.variants import planar

ACROSS = TURNED[:, [1, 2, 0]]
NAMES = [f"{kind}{i}{j}" for kind in "kc" for i in "xy" for j in "xy"]
ROWS = np.linspace(40.0, 400.0, 7)
RANDOM = np.random.default_rng(9)
TABLE = {"frequency": ROWS, **{
    name: size * (1.0 + 0.4 * (ROWS / 400.0) ** power) for name, size, power in zip(
        NAMES, (1e4, 2e3, -1e3, 1.4e4, 6.0, 1.0, 0.5, 8.0), RANDOM.uniform(1, 2, 8), strict=True)}}


def disc(**bearing):
    """A disc of mass 1 whose tilts are held apart from the bearing across the shaft."""
    model = Model()
    for name in "od":
        model.node(name, (0, 0, 0))
    model.fix("o")
    model.rigid_body("disc", "d", 1.0, about_shaft(2e-3, 1e-3))
    model.bushing("o", to="d", rotation=ACROSS, name="film", **bearing)
    model.bushing("o", to="d", stiffness=(1e5, 0, 0), turning_stiffness=(0, 1e3, 1e3),
                  rotation=TURNED, name="thrust")
    return model


def matrices(row):
    """Stiffness and damping of a row, (2, 2)."""
    return (np.array([TABLE[name][row] for name in NAMES[first:first + 4]]).reshape(2, 2)
            for first in (0, 4))


def roots(K, C):
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K, -C]])
    values = np.linalg.eigvals(A)
    return values[values.imag > 0.0]


def test_tables_are_read_at_every_speed():
    model = disc(table=TABLE)
    found = campbell(model, ROWS, AXIS, 5, 1)
    for row, speed in enumerate(ROWS):
        state = equilibrium(model, 1, spin=speed * AXIS)
        values = found.growth[row] + 1j * found.omega[row]
        for value in roots(*matrices(row)):
            assert np.abs(values - value).min() < 1e-9 * abs(value)
            assert np.abs(modes(state, speed * AXIS).values - value).min() < 1e-9 * abs(value)


def test_critical_speeds_and_responses_between_rows():
    """Against a search with bearings built at each speed, and ``m r W^2 / (K - W^2 + i W C)``."""
    model = disc(table=TABLE)
    made = model.unbalance("d", 1e-3, 0.2)
    found = critical_speeds(model, fastest=130.0, count=5)
    near = found.speeds[(found.speeds > 60.0) & (found.whirl != "none")]
    assert len(near) >= 1
    for speed in near:
        own = disc(table=TABLE, speed=speed)
        values = modes(equilibrium(own, 1, spin=speed * AXIS), speed * AXIS).omega
        assert np.abs(values - speed).min() < 1e-7 * speed
    answer = synchronous_response(model, ROWS)["d.position"] @ ACROSS[:, :2]
    first = made.vector("mc") @ ACROSS[:, :2]
    for row, speed in enumerate(ROWS):
        K, C = matrices(row)
        push = speed**2 * (first - 1j * np.array([-first[1], first[0]]))
        exact = np.linalg.solve(K - speed**2 * np.eye(2) + 1j * speed * C, push)
        assert_allclose(answer[row], exact, rtol=1e-9)


@pytest.mark.parametrize("between", [",", ";", "\t"])
def test_files_are_tables(tmp_path, between):
    """Columns in any order, speeds in turns per minute; what is left out."""
    path = tmp_path / "film.csv"
    table = {"KXX": TABLE["kxx"], "cxx": TABLE["cxx"], "rpm": 30.0 / np.pi * ROWS}
    rows = [between.join(table), "# a remark", *(between.join(map(repr, row)) for row in
            np.column_stack(list(table.values())).tolist())]
    path.write_text("\n".join(rows) + "\n")
    one = disc(table=path).element("film").table
    assert_allclose(one.speeds, ROWS, rtol=1e-14)
    for whole, name in ((one.stiffness, "kxx"), (one.damping, "cxx")):
        assert_allclose(whole, TABLE[name][:, None, None] * np.eye(2), rtol=1e-14)
    path.write_text("frequency,kxx\n1,2\n2,x\n")
    with pytest.raises(InputError, match="has the row '2,x', which has no number for each of the"):
        disc(table=path)


def test_tables_are_refused_where_they_are_not_read():
    model = disc(table=TABLE)
    with pytest.raises(InputError, match="'film' has a table of the speed, which a run over time"):
        simulate(model, 1e-3, 0.01)
    assert simulate(disc(table=TABLE, speed=100.0), 1e-3, 0.01).t[-1] == pytest.approx(0.01)
    upright = Model()
    upright.rigid_body("disc", upright.node("d", (0, 0, 0)), 1.0, (1, 1, 1))
    upright.bushing("d", table=TABLE, name="film")
    with pytest.raises(InputError, match="'film' has a table of the speed: build the planar"):
        planar(upright)
    state = equilibrium(model, 1, spin=100.0 * AXIS)
    with pytest.raises(InputError, match="read at 100 and not at 200 rad/time: give the equil"):
        modes(state, 200.0 * AXIS)
    with pytest.raises(InputError, match="'film' has a table for speeds from 40 to 400 rad/time, "
                                         "not for 500: add rows"):
        equilibrium(model, 1, spin=500.0 * AXIS)
    for table, more, said in (
            ({"frequency": ROWS}, {}, "needs the column kxx and one of speeds"),
            ({"kxx": ROWS}, {}, "needs the column kxx and one of speeds"),
            (TABLE, {"stiffness": 1.0}, "leave out these arguments"),
            (TABLE | {"kzz": ROWS}, {}, "column 'kzz'"),
            (TABLE | {"kxx": ROWS[1:]}, {}, "column 'kxx'"),
            (TABLE | {"frequency": ROWS[::-1]}, {}, "speeds must ascend"),
            (None, {"speed": 3.0}, "speed= is that at which a table is read"),
            (3, {}, "give columns by their names"), ("none.csv", {}, "none.csv does not exist")):
        with pytest.raises(InputError, match=said):
            disc(table=table, **more)


@pytest.mark.parametrize("speeds", [[-5.0, 100.0], [100.0, 100.0], [100.0]])
def test_speeds_of_a_table_ascend_from_zero(speeds):
    with pytest.raises(InputError, match="speeds must ascend from zero or above, two of them"):
        disc(table={"frequency": speeds, "kxx": np.ones(len(speeds))})
    assert disc(table={"frequency": [0.0, 5.0], "kxx": [1.0, 2.0]}).element("film").table
