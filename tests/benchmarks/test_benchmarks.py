"""The benchmarks run: every one of them is imported, and measures something small."""

import importlib.util
import json
import sys
from pathlib import Path

import pytest

from sebody import Model
from sebody.fem import planar_beam, rectangle
from sebody.reduction import craig_bampton
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


def test_starts_are_timed_beside_that_of_libraries(monkeypatch, capsys):
    bench = imported("bench_start")
    monkeypatch.setattr(bench, "ROWS", {name: bench.ROWS[name] for name in
                                        ("import numba, scipy", "sebody --help")})
    bench.main(["--json", "--times", "1"])
    found = json.loads(capsys.readouterr().out)
    assert 0.0 < found["sebody --help"] < 4 * found["import numba, scipy"]


def test_resultants_that_are_left_out_are_weighed(monkeypatch, capsys):
    bench = imported("bench_resultants")
    cases = bench.cases
    monkeypatch.setattr(bench, "BODIES", {"star": (bench.star, (4,), {})})
    monkeypatch.setattr(bench, "cases", lambda body, seed: cases(body, seed, spins=1, loads=0))
    monkeypatch.setattr(bench, "SAMPLES", 1)
    bench.main(["--json", "--times", "2"])
    row = json.loads(capsys.readouterr().out)["star"]
    assert (row["kept"], row["resultants"]) == (12 + 1, 24 + 1)     # one of internal modes
    # four modes are few, but the same with all resultants
    assert 0.0 < row["frequency, largest"] < 0.02 < row["without any, largest"]
    assert min(row[f"cost of {one}"] for one in ("all", "kept", "none")) > 0.0


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
def test_slender_bodies_are_compared_with_beams(capsys):
    """A bow with two interfaces, 6e-3 off without resultants of its internal modes."""
    imported("bench_slender").main(["--json", "--bodies", "1"])
    found = json.loads(capsys.readouterr().out)["0"]
    assert 0.0 < found["default"] < 2e-3 < found["no internal resultants"] < 1.0
    assert found["no stiffening"] > 0.0


def test_set_ups_are_timed_by_scene(capsys):
    bench = imported("bench_setup")
    bench.main(["--json"], times=1)
    found = json.loads(capsys.readouterr().out)
    assert len(found) == len(bench.SCENES) and found["planar-hinged-beam"] > 0.0


def test_variable_steps_are_compared_with_the_best_fixed_step():
    (error, steps, spent, best), = imported("bench_accuracy").compare(
        planar_hinged_beam.build, 0.5, 0.05, 16, (1e-2,), 1)
    assert error < 2.0 and steps > 0 and spent > 0.0 and best > 0.0


def test_errors_of_random_models_are_claimed_truly(monkeypatch, capsys):
    bench = imported("bench_accuracy")
    monkeypatch.setattr(bench, "LAST", 512)
    # a rod between ball joints, a hinge that sticks and slides
    bench.main(["--random", "16,33", "--json"])
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["kind"] for row in rows] == ["light_rod", "dry_hinge"]
    assert all(row["true"] <= 1.0 and row["claimed"] > 0.3 * row["true"] for row in rows)
    assert all(row["reference"] < 0.1 and row["steps"] < row["all steps"] for row in rows)


def test_planned_steps_are_compared_with_fixed_ones():
    row, = imported("bench_accuracy").swung(2.0, [1e-4], t_end=5.0)
    assert row["over fixed"] < 1.1 and row["energy over fixed"] < 1.1


@pytest.mark.parametrize("name", ["four-bar", "slider-crank"])
def test_plans_of_mechanisms_are_compared_with_fixed_steps(name):
    rows = list(imported("bench_planned").beside_fixed(name, (1e-3, 1e-4), 1.0))
    assert all(max(row["over fixed"], row["energy over fixed"]) < 1.1 for row in rows)
    assert rows[1]["error"] < 0.5 * rows[0]["error"]


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


def test_options_are_compared_with_exact_values(monkeypatch, capsys):
    bench = imported("bench_stiffening")
    monkeypatch.setattr(bench, "OPTIONS", {name: bench.OPTIONS[name] for name in (
        "B", "C + stiffening")})
    bench.main(["--json", "propeller"])
    (row, values), = json.loads(capsys.readouterr().out).items()
    assert row == "propeller moment" and list(values) == ["exact", "B", "C + stiffening"]
    assert values["C + stiffening"] == pytest.approx(values["exact"], abs=1e-3)
    bench.main(["Euler, 4"])
    out = capsys.readouterr().out.splitlines()
    assert out[0] == "| | exact | B | C + stiffening |"
    assert out[2].startswith("| Euler, 4 modes: load | 2.4674 | 3.165")


def test_numbers_of_modes_are_compared_with_the_least(monkeypatch, capsys):
    bench = imported("bench_modes")
    monkeypatch.setattr(bench, "MOST", 1)
    bench.main(["--json"], bodies=2)
    beam, weak = json.loads(capsys.readouterr().out)
    assert (beam["body"], weak["body"]) == ("beam", "nearly_two")
    for row in (beam, weak):
        assert row["true"] <= bench.TOLERANCE and row["free"] <= bench.TOLERANCE
        assert row["modes"] <= row["least"] + 2 and 0.5 < row["effectivity"] < 5


def test_modes_by_frequencies_are_the_least(capsys):
    bench = imported("bench_modes")
    bench.main(["--json", "--frequencies"], bodies=3)
    for row in json.loads(capsys.readouterr().out):
        assert row["modes"] == row["least"] < row["stiffness"]
        assert row["true"] <= bench.TOLERANCE and row["rubin_true"] < 1e-7
        assert abs(row["estimate"] / row["true"] - 1) < 0.03


def test_beams_are_compared_by_method():
    rows = imported("bench_modes").beam_table((0, 1))
    free = {(row["method"], row["modes"]): row["free-free"] for row in rows}
    assert abs(free["rubin", 1][0] - 22.37329) < 1e-4 and abs(free["guyan", 0][0] - 26.833) < 1e-2
    assert len(rows) == 7


def test_a_solid_is_reduced(capsys):
    pytest.importorskip("skfem")
    bench = imported("bench_solid")
    # fine enough that the patches have faces
    bench.main(["--json"], divisions=(9, 3, 3), modes=2)
    found = json.loads(capsys.readouterr().out)
    assert found["dofs"] == 480 and found["order"] == 26 and found["reduced"]["seconds"] > 0.0
    found = bench.factors(bench.curved_bar((6, 2, 2)))
    assert found["SuperLU, minimum degree"]["entries"] > 0


def test_recovered_stresses_are_compared_with_full_solutions():
    bench = imported("bench_recovery")
    row = bench.errors({"beam": bench.beam}, (2,))["beam"]["2"]
    assert max(row["static"]) < 1e-4                # at rest Guyan's shapes are exact
    near, middle = row["moving"]
    assert near < 0.6 * row["moving, without"][0] and middle < 0.05
    assert min(bench.seconds(bench.large_field((3, 2, 2), 20, 14)).values()) > 0.0


def test_inertia_options_are_compared(capsys):
    imported("bench_inertia").main(["--json"], 2, ())
    (name, row), = json.loads(capsys.readouterr().out).items()
    assert (name, row["coordinates"], row["resultants"]) == ("planar 8", 8, 1)
    assert all(min(row[what].values()) > 0.0 for what in ("residual", "matrix"))
    assert list(row["residual"]) == ["b", "plain c", "c"]
    assert row["matrix"]["b"] < row["matrix"]["c"]      # a third: they are different kernels


def test_sweeps_are_timed_beside_their_runs(monkeypatch, capsys):
    bench = imported("bench_sweep")
    monkeypatch.setattr(bench, "cluster", lambda count: {})     # processes take seconds to start
    bench.main(["--json"], count=2)
    row = json.loads(capsys.readouterr().out)["structures, ms"]
    assert row["run"] > row["of it the model"] > 0.0


def pendulum():
    """A soft rod from reduced matrices, falling."""
    model = Model(planar=True)
    model.gravity((2.0, -9.0))
    tip, base = model.node("tip", (0.9, -0.5)), model.node("base", (0.1, 0.2))
    fe_model = planar_beam(base.point, tip.point, rectangle(0.01, 0.02, 7e10, 0.3, 2700.0), 6)
    model.superelement("rod", craig_bampton(fe_model, [(0, "full"), (6, "full")], 1), [base, tip])
    model.fix(base, "position")
    return model


def test_advice_is_compared_with_a_full_search(tmp_path, capsys):
    bench = imported("bench_advise")
    scenes = [bench.AdviceScene("rod", "", pendulum, 0.01, 0.4, ("tip.position",), True)]
    keep = tmp_path / "numbers.json"
    bench.main(["--json", "--keep", str(keep)], scenes)
    found = json.loads(capsys.readouterr().out)
    assert found["rod"]["forms"] == [7] and found == json.loads(keep.read_text())
    for tolerance, row in found["rod"]["tolerances"].items():
        assert row["measured"] <= float(tolerance) and row["least seconds"] <= row["seconds"]
        assert row["predicted"] > 0.0 and row["search"] > 0.0 and row["choices run"] > 0
    bench.main(["--keep", str(keep)], scenes)           # of what was kept
    lines = capsys.readouterr().out.splitlines()
    assert lines[2].startswith("| rod | 0.01 | ")
    assert "* within the tolerance: 2" in lines


def test_the_word_of_advice_is_compared_with_exact_beams(tmp_path, capsys):
    bench = imported("bench_trust")
    scenes = [bench.AdviceScene("rod", "", pendulum, 0.01, 0.4, ("tip.position",), True, exact=8)]
    keep = tmp_path / "numbers.json"
    bench.main(["--json", "--keep", str(keep)], scenes)
    found = json.loads(capsys.readouterr().out)
    for tolerance, row in found["rod"]["tolerances"].items():
        assert row["confirmed"] and not row["refused"]
        # both references are good to a fifth of the tolerance and better
        assert row["true"] <= row["error"] + 0.2 * float(tolerance)
        assert row["least"] <= row["seconds"] and 0.0 < row["guards"] < 3.0 < 20.0 > row["work"]
    assert found["rod"]["singles"] and all(
        one["predicted"] > 0.0 for one in found["rod"]["singles"])
    bench.main(["--keep", str(keep)], scenes)           # of what was kept
    out = capsys.readouterr().out
    assert "| rod | 0.01 | " in out and "* confirmed: 2" in out


def test_scenes_for_advice_are_fixed():
    """Twelve, six of them held back, and eleven more; quantities are of parts they have."""
    scenes = imported("advice_scenes").SCENES
    general = imported("advice_general").GENERAL
    assert len({scene.name for scene in (*scenes, *general)}) == 12 + 11
    assert sum(scene.tuning for scene in scenes) == 6
    for scene in (*scenes, *general):
        model = scene.build()
        assert model.bodies
        assert round(scene.t_end / scene.h) * scene.h == pytest.approx(scene.t_end)
        parts = {*model.nodes, *(one.name for one in model.elements())}
        named = {quantity.removesuffix(" rms").removesuffix(".z").rpartition(".")[0]
                 for quantity in scene.quantities if quantity != "frequency 1"}
        assert named <= parts


def test_struck_frames_beside_beams(monkeypatch, capsys):
    bench = imported("bench_frames")
    monkeypatch.setattr(bench, "STEPS", (1e-3,))
    monkeypatch.setattr(bench, "OTHERS", {})
    monkeypatch.setattr(bench, "T_END", 0.1)
    measure = bench.measure
    monkeypatch.setattr(bench, "measure",
                        lambda struck, options: measure(struck, options, (1e-3,), 0.1))
    bench.main(["--json", "--random", "0", "T"])
    row = json.loads(capsys.readouterr().out)["T"]
    assert list(row) == ["default", "on rotations", "beams", "predicted"]
    assert 0.0 < row["default"]["0.001"]["gain"] < 2.0 * row["predicted"]["0.001"]
    assert row["default"]["0.001"]["gain"] < 1e-2 and row["beams"]["0.001"]["gain"] < 1e-2
    assert row["default"]["0.001"]["end"] == pytest.approx(0.1)


def test_struck_bodies_that_turn(capsys):
    bench = imported("bench_turned")
    bench.main(["--json", "31"])
    rows = json.loads(capsys.readouterr().out)
    assert [row["warned"] for row in rows] == [False, True]
    assert all(0.03 < row["share"] < 3.0 for row in rows)


def test_exported_libraries_beside_runs(monkeypatch, capsys):
    pytest.importorskip("ziglang", reason="exports are linked by the package ziglang")
    bench = imported("bench_export")
    monkeypatch.setattr(bench, "PROCESSOR", "native")
    monkeypatch.setattr(bench, "MOST_PAIRS", 1)
    bench.main(["heavy-top", "--json", "--pairs", "1", "--t-end", "0.2"])
    row = json.loads(capsys.readouterr().out)["heavy-top"]
    assert row["bitwise"] and row["largest difference"] == 0.0 and row["steps"] == 200
    assert row["speed"] > 0.0 and row["library kB"] < 300


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
def test_gradients_are_timed_and_a_torque_ends_at_rest():
    bench = imported("bench_gradient")
    found = bench.cost(repeats=1, t_end=0.5)
    assert list(found)[0] == "run" and min(found.values()) > 0.0
    assert all(0.0 < row["MB"] < 50.0 for row in bench.memory(steps=20).values())
    assert min(bench.many(runs=2, t_end=0.1, repeats=1).values()) > 0.0
    found, _ = bench.torque(entries=60, t_end=0.3, angle=0.05, h=5e-3)
    assert found["misses"][-1] < 1e-8 < found["misses"][0]


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
def test_a_rod_is_sized(tmp_path, capsys):
    bench = imported("bench_sizing")
    picture = tmp_path / "rod.png"
    bench.main(["--json", "--elements", "10", "--iterations", "4", "--picture", str(picture)])
    rows = json.loads(capsys.readouterr().out)
    assert rows["mass"] < rows["mass before"] and rows["iterations"] <= 4
    assert picture.read_bytes()[:4] == b"\x89PNG"


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
def test_contributions_are_compared_with_runs(capsys):
    bench = imported("bench_contributions")
    bench.main(["--json", "stiff drives"])
    found = json.loads(capsys.readouterr().out)
    assert found["summary"]["all"] == {"count": len(found["rows"]), "within": 1.0}
    assert {row["change"] for row in found["rows"]} >= {"rigid", "without modes"}


def test_row_exchanges_are_compared_with_superlu(monkeypatch, capsys):
    bench = imported("bench_row_exchanges")
    monkeypatch.setattr(bench, "MODELS", {"chain": bench.MODELS["chain of 8"]})
    bench.main(["--json", "--pairs", "2"])
    found = json.loads(capsys.readouterr().out)["chain"]
    assert found["unknowns"] == 120 and found["entries"][0] <= found["entries"][1]
    assert max(found["errors"]) < 1e-14


def test_chains_are_compared_with_links_one_by_one():
    """In a few steps both ways differ by rounding."""
    row = imported("bench_chain").measure(16, "default", pairs=1, until=0.03, curved=True)
    assert row["together"] > 0.0 and row["ratio"] > 0.0 and row["deviation"] < 1e-11


def test_chains_are_compared_with_several_threads():
    row = imported("bench_chain").measure_threads(70, "B", pairs=1, threads=2, until=0.05)
    assert row["one"] > 0.0 and row["several"] > 0.0 and row["ratio"] > 0.0 and row["same"]


def test_columns_and_chains_are_found():
    bench = imported("bench_statics")
    row, = bench.columns((4,), (400,), (1.05,), (1e-3,))
    assert abs(row["error"]) < 1e-2 and row["stability"] == "stable" and row["lowest"] > 0.0
    rows = bench.chains(("arc", "straight"), (4,), (2e11,), (1,))
    assert len(rows) == 2 and all(row["error"] < 1e-4 for row in rows)
    assert "1 of 1" in bench.table(rows)


def test_blades_on_a_tower_by_two_methods():
    """Floquet's multipliers and averages of multi-blade coordinates, of every mode."""
    rows = imported("bench_rotors").blades(4.0)
    assert len(rows) == 7 and max(row["floquet"] for row in rows) < 1e-6
    assert all(row["damping"] > 1e-4 for row in rows)


def test_small_mechanisms_are_compared_with_another_version():
    """With this one itself: the same counts, and runs of a tight tolerance nearby."""
    bench = imported("bench_small")
    row = bench.measure("2 links", [bench.Version(), bench.Version()], pairs=1)
    own, other = ({key: value for key, value in one.items() if key != "us"} for one in row["rows"])
    assert own == other and own["cuts"] == 0 and 3.0 < own["corrections"] < 4.5
    assert row["ratio"] > 0.0 and 1e-10 < own["deviations"][0] < 1e-5


def test_a_crane_with_three_features_closes_its_energy(capsys):
    imported("bench_let_go").main(["--json", "--steps", "2.5e-3,1.25e-3"])
    coarse, fine = json.loads(capsys.readouterr().out)
    # with an order of at least 1.5: where the rope becomes taut has an error of its own
    assert fine["balance"] < min(5e-5, 0.35 * coarse["balance"])
    assert coarse["slack"] > 0.3 and abs(coarse["breaks"] - fine["breaks"]) < 2e-3
