"""The benchmarks run: every one of them is imported, and measures something small."""

import importlib.util
import json
import sys
from pathlib import Path

import pytest

from sebody.scenes import planar_hinged_beam

FOLDER = Path(__file__).parent


def imported(name):
    """A benchmark as a module."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = sys.modules[name] = importlib.util.module_from_spec(spec)     # where caches look
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("bench_*.py")))
def test_every_benchmark_is_imported(name):
    assert callable(imported(name).main)


def test_specialised_kernels_are_compared_with_general_ones(monkeypatch, capsys):
    bench = imported("bench_kernels")
    monkeypatch.setattr(bench, "KERNELS", (("planar-f2", "converged_mean"),))
    compare = bench.compare
    monkeypatch.setattr(bench, "compare", lambda *kernel: compare(*kernel, times=10))
    bench.main(["--json"])
    (kernel, row), = json.loads(capsys.readouterr().out).items()
    assert kernel == "planar-f2:converged_mean" and min(row.values()) > 0.0
    assert list(row) == ["residual", "residual_general", "matrix", "matrix_general"]


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


def test_orders_of_creation_are_compared(monkeypatch, capsys):
    bench = imported("bench_order")
    monkeypatch.setattr(bench, "GRAPHS", {"tree": (bench.tree, 30)})
    bench.main(["--json"])
    (graph, rows), = json.loads(capsys.readouterr().out).items()
    assert graph == "tree" and len(rows) == 2 + bench.RANDOM
    assert all(row["microseconds"] > 0.0 and row["entries"] > 0 for row in rows.values())


def test_everyday_mechanisms_run_in_every_place(monkeypatch, capsys):
    bench = imported("bench_everyday")
    monkeypatch.setattr(bench, "T_END", 0.1)
    monkeypatch.setattr(bench, "MODELS", {"door": bench.MODELS["door"]})
    bench.main(["--json"], times=1)
    found = json.loads(capsys.readouterr().out)["door"]
    assert list(found) == list(bench.PLACES)
    assert all(one["microseconds"] > 0.0 and one["cuts"] == 0 for one in found.values())


def test_numbers_of_modes_are_compared_with_the_least(monkeypatch, capsys):
    bench = imported("bench_modes")
    monkeypatch.setattr(bench, "MOST", 1)
    bench.main(["--json"], bodies=2)
    beam, weak = json.loads(capsys.readouterr().out)
    assert (beam["body"], weak["body"]) == ("beam", "nearly_two")
    for row in (beam, weak):
        assert row["true"] <= bench.TOLERANCE and row["free"] <= bench.TOLERANCE
        assert row["modes"] <= row["least"] + 2 and 0.5 < row["effectivity"] < 5
