"""The summary of an equilibrium: load steps, iterations and the force out of balance."""

import re

import numpy as np
import pytest

from sebody import Model, Result, rest_to_rest, simulate
from sebody.analysis import equilibrium


def hung():
    """A driven carriage, from which a mass hangs on a soft spring."""
    model = Model()
    model.gravity((0, 0, -9.81))
    model.rigid_body("car", model.node("a", (0, 0, 0)), 1.0, (1, 1, 1))
    model.prismatic("a", (1, 0, 0), name="rail")
    model.drive_slide("rail", rest_to_rest(0.5, 1.0), name="winch")
    model.point_mass("bob", model.node("b", (0, 0, -1.0), keeps="translation"), 2.0)
    model.spring("a", "b", stiffness=300.0, cubic=50.0)
    return model


@pytest.mark.filterwarnings("ignore:.*since version 0.2.0:FutureWarning")
def test_a_summary_of_an_equilibrium(tmp_path):
    """In the middle of a drive's motion: no residual of time, energy or constraints."""
    still = equilibrium(hung(), 4, t=0.5)
    assert still["rail.displacement"] == pytest.approx(0.25 * still.t, abs=1e-9)
    assert np.abs(still["constraints.position"]).max() < 1e-9
    lines = dict(re.split(r"  +", line, maxsplit=1) for line in still.summary().splitlines())
    assert lines["equilibrium"] == "4 load steps, to 1 of the load"
    assert 4 <= int(lines["iterations"]) < 60
    left, reach = re.fullmatch(r"(\S+) on an unknown, where forces of elements reach (\S+)",
                               lines["residual force"]).groups()
    assert float(left) < 1e-8
    assert float(reach) == pytest.approx(3 * 9.81, rel=1e-2)        # of the rail
    assert "energy balance" not in lines and "time per step" not in lines
    loaded = Result.load(still.save(tmp_path / "still.npz")).summary().splitlines()
    assert [line for line in loaded if "residual force" not in line] == [
        line for line in still.summary().splitlines() if "residual force" not in line]  # rounding


@pytest.mark.filterwarnings("ignore:.*since version 0.2.0:FutureWarning")
def test_a_summary_of_a_run_is_as_before():
    said = simulate(hung(), 0.01, 0.1).summary()
    assert "energy balance" in said and "steps                10" in said
    assert "equilibrium" not in said
