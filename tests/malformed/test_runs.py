"""Simulations, equilibria, results and their files refuse wrong arguments in words."""

import numpy as np
import pytest
from malformed import run_cases
from malformed.cases import listed
from malformed.run_cases import Shared

from sebody import InputError, Simulation
from sebody.analysis import resume, save_state
from sebody.scenes import planar_hinged_beam

ALL = run_cases.PROFILES | run_cases.RUNS | run_cases.FILES


@pytest.mark.parametrize("right, argument, value, said",
                         listed(run_cases.PROFILES | run_cases.RUNS))
def test_refused(right, argument, value, said):
    with pytest.raises(InputError) as caught:
        right.function(**{**right.arguments, argument: value})
    assert said in str(caught.value)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a state, and with files that are none."""
    found = tmp_path_factory.mktemp("files")
    (found / "folder.npz").mkdir()
    (found / "broken.npz").write_bytes(b"not zip")
    np.savez(found / "histories.npz", t=np.zeros(3))
    save_state(Shared.run(), found / "state.npz")
    with np.load(found / "state.npz") as file:
        arrays = dict(file)
    np.savez(found / "nan.npz", **{**arrays, "q_old": np.full_like(arrays["q_old"], np.nan)})
    np.savez(found / "short.npz", **{**arrays, "q_old": arrays["q_old"][:2]})
    return found


@pytest.mark.parametrize("right, argument, value, said", listed(run_cases.FILES))
def test_files_are_refused(right, argument, value, said, folder, monkeypatch):
    monkeypatch.chdir(folder)
    before = {path.name for path in folder.iterdir()}
    with pytest.raises(InputError) as caught:
        right.function(**{**right.arguments, argument: value})
    assert said in str(caught.value)
    assert {path.name for path in folder.iterdir()} == before


@pytest.mark.parametrize("other", [{"frame": "node"}, {"inertia": "frame_axes"}, {"elements": 4}])
def test_a_state_goes_on_with_its_own_superelement_only(other, tmp_path):
    """Of another frame, inertia option or division: the unknowns are the same."""
    right = {"modes": 0, "elements": 2}
    build = planar_hinged_beam.build
    path = save_state(Simulation(build(**right).model, 0.01), tmp_path / "state.npz")
    resume(build(**right).model, path)
    with pytest.raises(InputError, match="state.npz is of another model: build the one it was"):
        resume(build(**right | other).model, path)


@pytest.mark.parametrize("name", ALL)
def test_the_right_call_is_accepted(name, folder, monkeypatch, tmp_path):
    right = ALL[name]
    monkeypatch.chdir(folder if name == "resume" else tmp_path)
    right.function(**right.arguments)
