"""The benchmarks run: every one of them is imported, and measures something small."""

import importlib.util
import json
from pathlib import Path

import pytest

from sebody.scenes import planar_hinged_beam

FOLDER = Path(__file__).parent


def imported(name):
    """A benchmark as a module."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("bench_*.py")))
def test_every_benchmark_is_imported(name):
    assert callable(imported(name).main)


def test_kernels_are_compared_with_the_same_text_for_any_counts(tmp_path):
    row = imported("bench_kernels").compare("planar_f2_converged_mean_b", tmp_path, 100)
    assert len(row) == 4 and min(row) > 0.0


def test_another_text_of_a_kernel_is_refused(tmp_path):
    bench = imported("bench_kernels")
    path = tmp_path / "superelement_other.py"
    path.write_text("N_POSITIONS = count()\n    n = width\n")
    module = type(bench)("superelement_other")
    module.__file__ = str(path)
    with pytest.raises(ValueError, match="superelement_other.py is not written as expected"):
        bench.generic(module, tmp_path)


def test_steps_are_timed_beside_their_errors():
    (spatial, _, error, _), (planar, us, same, _) = imported("bench_kernels").step_times(1.0, 1)
    assert (spatial, planar) == ("spatial", "planar") and us > 0.0
    assert 0.0 < error < 1e-3 and 0.0 < same < 1e-3


def test_set_ups_are_timed_by_scene(capsys):
    bench = imported("bench_setup")
    bench.main(["--json"], times=1)
    found = json.loads(capsys.readouterr().out)
    assert len(found) == len(bench.SCENES) and found["planar-hinged-beam"] > 0.0


def test_variable_steps_are_compared_with_the_best_fixed_step():
    (error, steps, spent, best), = imported("bench_accuracy").compare(
        planar_hinged_beam.build, 0.5, 0.05, 16, (1e-2,), 1)
    assert error < 2.0 and steps > 0 and spent > 0.0 and best > 0.0
