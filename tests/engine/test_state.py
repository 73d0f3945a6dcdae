"""Rows and codes of the loop against the tables they come from."""

import numpy as np
import pytest

from sebody import Simulation
from sebody.contract import layout
from sebody.contract.layout import COEFFICIENTS, RECORD
from sebody.engine import state as codes
from sebody.engine.loop import advance
from sebody.engine.state import REASONS, Record
from sebody.runs.tolerance import Tolerance
from sebody.scenes import chain, heavy_top, hinged_beam


def test_members_of_the_state_are_parts_of_one_row():
    state = Simulation(heavy_top.build(explicit=True).model, 0.01).run_to(0.1).state
    state.now[:] = np.arange(state.now.size)
    for name, part in state.recorded_parts.items():
        if name not in ("t", "iterations"):
            assert np.array_equal(getattr(state, name), np.arange(part.start, part.stop)), name
    assert [part.name for part in RECORD.parts] == list(state.recorded_parts)


def test_places_in_the_row_are_those_of_the_table():
    state = Simulation(chain.build(links=2).model, 0.01).state
    parts, at = state.recorded_parts, Record.of(state, 0).at
    for name in ("q", "R", "v", "a"):
        assert at[getattr(layout, f"{name.upper()}_PART")] == parts[name].start
    assert parts["t"] == slice(layout.RECORD_T, layout.RECORD_T + 1)
    assert parts["iterations"].start == layout.RECORD_ITERATIONS
    assert parts["works"].start == layout.RECORD_WORKS


@pytest.mark.parametrize("build", [hinged_beam.build, lambda: heavy_top.build(explicit=True)])
def test_a_row_at_the_end_of_a_step_is_the_state_there(build):
    """Output between steps has every part in its place: at the end of one it is the state's."""
    h = 1e-3
    run = Simulation(build().model, h, tolerance=Tolerance(1.0))
    run.state.error_weights[:], run.state.clock.chosen, run.state.control.recorded = 0.0, h, 0
    record = Record.of(run.state, 1)
    advance(run.system, run.state, record, run.scheme, 1, 1, run.dense)
    assert run.time == h and run.state.control.recorded == 1
    for name, part in run.state.recorded_parts.items():
        now = {"t": run.time, "iterations": run.state.control.iterations}.get(
            name, run.state.now[part])
        size = max(np.abs(now).max(), 1e-9) if part.stop > part.start else 1.0
        assert np.abs(record.rows[0, part] - now).max(initial=0.0) < 1e-12 * size, name


def test_coefficients_are_set_by_name():
    state = Simulation(heavy_top.build().model, 0.01).state
    field = state.coefficients[layout.FIELD:].copy()
    state.set_coefficients(c_damping=7.0, c_constraint=9.0)
    row = COEFFICIENTS.unpack({}, state.coefficients)
    assert row["c_damping"] == 7.0 and row["c_constraint"] == 9.0
    assert np.array_equal(row["field"], field) and field.any()
    with pytest.raises(KeyError, match="c_speed"):
        state.set_coefficients(c_speed=1.0)


def test_every_reason_has_its_own_number_and_text():
    """Answers of kernels are reasons: the numbers that follow must not be theirs."""
    named = {name: getattr(codes, name) for name in (
        "NO_REASON", "HALF_TURN", "NO_FRAME", "OFF_PATH", "NOT_FINITE", "SLOW", "INACCURATE", "GAP",
        "NO_START", "BAD_CONTROL", "CONTACT", "GROWS", "NO_AID")}
    assert len(set(named.values())) == len(named)
    assert [named[one] for one in ("NO_REASON", "HALF_TURN", "NO_FRAME", "OFF_PATH")] == [
        layout.OK, layout.HALF_TURN, layout.NO_FRAME, layout.OFF_PATH]
    assert set(REASONS) == set(named.values()) - {codes.NO_REASON}
    assert len(set(REASONS.values())) == len(REASONS)
