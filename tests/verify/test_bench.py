"""`sebody bench`: what it prints and refuses. The peer itself is run only where it is installed."""

import json
from dataclasses import replace

import pytest

from sebody import InputError, Model, simulate
from sebody.cli.entry import main
from sebody.kernels.loader import element_kernel
from sebody.scenes import hinged_beam
from sebody.verify import bench
from sebody.verify.bench import own, peer
from sebody.verify.bench.measurement import Measurement

MINE = Measurement("hinged-beam", "superelement", 15, 0.01, 2.0, 2.4, 9e-4, 6e-3, 7000.0)
THEIRS = Measurement("hinged-beam", "Exudyn beams", 24, 0.01, 80.0, 2.0, 5e-4, 0.24)


@pytest.fixture
def alone(monkeypatch):
    monkeypatch.setattr(peer, "available", lambda: False)


def test_json_has_cost_and_error_of_the_same_run(alone, capsys):
    assert main(["bench", "planar-hinged-beam", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    row, of_b = answer["measurements"]
    assert (row["variant"], of_b["variant"]) == ("superelement", "superelement, inertia material")
    assert row["scene"] == "planar-hinged-beam" and row["unknowns"] == 6 and row["h"] == 0.01
    assert {"variant", "us_per_step", "iterations_per_step", "tip_error"} <= row.keys()
    assert row["tip_error"] < 3e-4 and 8e-4 < of_b["tip_error"] < 9.5e-4
    assert row["iterations_per_step"] > 1.0
    assert row["us_per_step"] * 3000 == pytest.approx(1e6 * row["wall_seconds"])
    fraction = row["flops_per_step"] / answer["flops_per_second"] / (1e-6 * row["us_per_step"])
    assert 0.0 < fraction < 1.0


def test_operations_grow_with_bodies_and_iterations():
    """At least two flops for each entry of S and M, each of which a product meets once."""
    result = simulate(hinged_beam.build().model, 0.01, 1.0)
    n = result.model.bodies["beam"].reduced.stiffness.shape[0]
    assert own.flops_per_step(result) > result.iterations_per_step * 2 * 2 * n * n


def test_modes_are_the_hinged_beam_by_their_number(monkeypatch, alone, capsys):
    monkeypatch.setattr(own, "MODES", (4, 16))
    assert main(["bench", "modes", "--json"]) == 0
    few, of_b, many, _ = json.loads(capsys.readouterr().out)["measurements"]
    assert of_b["variant"] == "12 + 4 coordinates, inertia material" and of_b["tip_error"] > 8e-4
    assert (few["variant"], many["variant"]) == ("12 + 4 coordinates", "12 + 16 coordinates")
    assert many["unknowns"] - few["unknowns"] == 12
    assert max(few["tip_error"], many["tip_error"]) < 4e-4
    assert many["flops_per_step"] > few["flops_per_step"]


def test_modes_are_compared_with_the_peers_body_of_the_same_size():
    mine = replace(MINE, scene="modes", variant="12 + 4 coordinates")
    theirs = [replace(THEIRS, scene="modes", variant=f"Exudyn reduced, 12 + {n} coordinates",
                      us_per_step=10.0 * n) for n in (4, 16)]
    of_b = replace(mine, variant=mine.variant + own.OPTION_B, us_per_step=1.0)
    found, faster = bench.ratios([mine, of_b, *theirs])
    assert found.endswith("12 + 4 coordinates takes 20.0 times as long a step")
    assert faster.endswith("12 + 4 coordinates takes 40.0 times as long a step")


def test_report_names_ratios_and_fractions():
    text = bench.report([MINE, THEIRS], 1e10)
    assert "Exudyn beams takes 40.0 times as long a step" in text
    assert "to a tip error of 1e-3: 6.00 ms, Exudyn beams (h 0.01) 240.0 ms: 40.0 times" in text
    assert "35%" in text and "10.00 Gflop/s" in text
    poor = replace(THEIRS, tip_error=2e-3)
    assert "no Exudyn model reaches it" in bench.report([MINE, poor], 1e10)


def test_a_run_without_the_peer_compares_nothing():
    assert bench.ratios([MINE]) == []


def test_a_scene_without_benchmark_is_named():
    with pytest.raises(InputError, match="no benchmark of scene 'shaft': use hinged-beam"):
        bench.measure(["shaft"])


def test_missing_peer_is_named(alone):
    with pytest.raises(InputError, match=r'Exudyn is not installed: pip install "sebody\[bench\]"'):
        peer.measure("chain")


@pytest.mark.skipif(not peer.available(), reason="Exudyn is not installed")
def test_the_peer_computes_the_same_beam():
    found = [m for m in peer.measure("planar-hinged-beam") if m.h == 0.01]
    assert min(m.tip_error for m in found) < 1e-3


def test_operations_are_those_of_all_elements():
    """Of a body and a spring in a plane: counts of their kernels, and the product with an inverse.

    Two unknowns take four multiplications and four additions.
    """
    model = Model(planar=True)
    model.fix(model.node("wall", (0.0, 0.0), keeps="translation"), "position")
    model.point_mass("ball", model.node("ball", (1.0, 0.0), keeps="translation"), 1.0)
    model.spring("ball", "wall", 4.0, length=0.9)
    result = simulate(model, 0.01, 0.1)
    counts = [element_kernel(name).OPERATIONS["residual"][0]
              for name in ("planar_point_mass", "planar_spring")]
    assert min(counts) > 0
    assert own.flops_per_step(result) == pytest.approx(
        result.iterations_per_step * (sum(counts) + 8))


def test_gradients_are_measured_in_runs(capsys, monkeypatch):
    from sebody.verify.bench import gradient

    found = gradient.measure(steps=20, runs=1)
    assert {m.scene for m in found} == {"gradient"} and len(found) == 8
    assert [found[k].variant for k in (0, 5)] == ["run", "adjoint, 1 parameter, inertia material"]
    assert all(m.us_per_step > 0 and m.wall_seconds * 1e6 >= 20 * m.us_per_step for m in found)
    text = bench.report(found, 1e10)
    assert "gradient, adjoint, 1000 values of a table: a sweep takes" in text
    assert text.count("runs\n") == 6


def test_steps_that_follow_the_phase_are_measured_beside_equal_ones(monkeypatch):
    from sebody.verify.bench import following

    monkeypatch.setitem(bench.ALONE, "following-steps",
                        lambda: following.measure(1e-5, t_end=15.0, runs=1))
    planned, equal, chosen = found = bench.measure(["following-steps"])
    assert planned.tip_error < 1.1 * equal.tip_error
    assert planned.energy_drift < 1.1 * equal.energy_drift
    assert chosen.tip_error > 5 * equal.tip_error       # near the top one change is enough
    assert planned.h == pytest.approx(equal.h)
    assert bench.report(found, 1e10).count("following-steps, ") == 3


def test_many_short_runs_are_measured_by_all_threads_and_alone(monkeypatch):
    from sebody.verify.bench import ensemble, peer

    monkeypatch.setattr(peer, "available", lambda: False)
    monkeypatch.setattr(ensemble, "ALONE", 2)
    together, paper, alone = ensemble.measure(10)
    assert {m.scene for m in (together, paper, alone)} == {"ensemble"}
    assert paper.variant == f"{together.variant}, inertia material"
    assert together.thread_efficiency > 0 and alone.thread_efficiency is None
    assert "thread_efficiency" in together.as_dict()
    # runs of 300 steps: the time a step belongs to the time of all runs
    assert together.wall_seconds == pytest.approx(together.us_per_step * 1e-6 * 300 * 10)


OWN_SCENE = '''"""Bars of unequal length on a spring."""
from sebody import Model
from sebody.fem import circle
from sebody.scenes.scene import Scene

def build() -> Scene:
    model = Model(planar=True)
    model.gravity((0.4, -9.0))
    at = model.node("n0", (0.3, -0.2))
    model.revolute(at)
    for k in range(3):
        end = model.node(f"n{k + 1}", (0.5 * k + 1.0, 0.1 * k * k))
        model.beam(f"b{k}", (at, end), circle(0.01, 2e11, 0.3, 7800.0), 4, 1, 1)
        at = end
    model.rigid_body("tip", at, 2.0, 0.1)
    wall = model.node("wall", (2.0, 1.0))
    model.fix(wall)
    model.spring(at, wall, 300.0)
    return Scene("bars", "bars on a spring", model, 0.01, 0.5)
'''


def test_the_cost_of_a_users_scene_is_told_by_its_parts(tmp_path, capsys):
    (tmp_path / "own.py").write_text(OWN_SCENE)
    assert main(["bench", str(tmp_path / "own.py"), "--json"]) == 0
    own_cost, = json.loads(capsys.readouterr().out)["costs"]
    scene = {}
    exec(OWN_SCENE, scene)
    run = simulate((made := scene["build"]()).model, made.h, made.t_end)
    assert own_cost["scene"] == "bars" and own_cost["steps"] == run.steps == 50
    assert own_cost["corrections"] == pytest.approx(run.iterations_per_step)
    assert own_cost["matrices"] == pytest.approx(run.matrices / run.steps)
    parts = {part["name"]: part for part in own_cost["parts"]}
    counts = {name.partition(" of ")[2]: part["count"] for name, part in parts.items()
              if name.startswith("forces")}
    assert sorted(counts.values()) == [1, 1, 3] and "element_planar_spring" in counts
    assert {name for name in parts if " of element" in name or " of super" in name} == {
        f"{what} of {kind}" for what in ("forces", "matrices") for kind in counts}
    for part in own_cost["parts"]:
        assert part["microseconds"] > 0.0
        wanted = ("matrices" if part["name"].startswith(("matrices", "sum")) else "corrections")
        assert part["per_step"] == own_cost[wanted]
    flexible, = (name for name in counts if name.startswith("superelement"))
    assert (parts[f"matrices of {flexible}"]["microseconds"]
            > parts[f"forces of {flexible}"]["microseconds"] > 0.05)
    assert own_cost["rest_us_per_step"] < own_cost["us_per_step"]


def test_parts_are_a_table_beside_that_of_benchmarks(alone, tmp_path, capsys):
    (tmp_path / "own.py").write_text(OWN_SCENE)
    assert main(["bench", "heavy-top", str(tmp_path / "own.py")]) == 0
    text = capsys.readouterr().out
    assert "this machine: " in text and "heavy-top" in text
    assert ", 50 steps of 0.01: " in text
    assert "the rest: loop, records" in text and " %\n" in text
    assert main(["bench", "hinged-baem"]) == 2
    assert "did you mean 'hinged-beam'" in capsys.readouterr().err
