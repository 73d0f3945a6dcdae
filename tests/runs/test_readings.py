"""Models of many kinds alone, resumed from a file, and in a plane: see the table in `readings`."""

import numpy as np
import pytest
from in_plane import CLOSE, EXACT
from readings import TABLE, read

from sebody import InputError, Simulation, generalized_alpha, simulate
from sebody.analysis import resume, save_state
from sebody.model.variants import planar

pytestmark = pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
UNDAMPED = generalized_alpha(1.0, tolerance=1e-11)
ROUNDING = 1e-12


@pytest.mark.parametrize("name", read("single"))
def test_energy_drifts_by_the_square_of_the_step(name):
    """Where steps resolve all motions: others, and blows, have their own order in the table."""
    row, model = TABLE[name], TABLE[name].build()
    drift, less = (simulate(model, h, row.end, UNDAMPED).energy_balance()
                   for h in (row.h, row.h / 2))
    assert drift < 1e-2
    assert less <= max(drift / row.falls, ROUNDING)


@pytest.mark.parametrize("name", read("resumed"))
def test_runs_go_on_from_a_file_bit_for_bit(name, tmp_path):
    row, steps = TABLE[name], round(TABLE[name].end / TABLE[name].h)
    half = row.h * (steps // 2)
    first = Simulation(row.build(), row.h).run_to(half)
    rest = resume(row.build(), save_state(first, tmp_path / "half.npz")).run_to(row.end)
    whole = first.run_to(row.end).result()
    assert np.array_equal(rest.result().rows, whole.rows)
    assert rest.state.control.iterations == first.state.control.iterations


@pytest.mark.parametrize("name", TABLE)
def test_planar_models_move_as_in_space(name):
    row = TABLE[name]
    model = row.build()
    words = "the model is planar already" if model.planar else row.refused.get("planar")
    if words:
        with pytest.raises(InputError, match=words):
            planar(model)
        return
    made = planar(model).model
    flat, expected = (simulate(one, row.h, row.end, EXACT)[row.followed] for one in (made, model))
    found = made.plane.to_space(row.followed, flat)
    assert np.abs(found - expected).max() <= CLOSE * np.ptp(expected, axis=0).max()
