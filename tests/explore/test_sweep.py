"""Sweeps: designs, tables that survive, clusters whose workers die."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from scipy import stats

from sebody import InputError, simulate
from sebody.analysis import equilibrium, final, integral, maximum
from sebody.cli.entry import main
from sebody.explore import sweep as room
from sebody.explore.sweep import Distribution, executors as places, sobol, sweep
from sebody.explore.sweep.design import design
from sebody.explore.sweep.picture import draw
from sebody.explore.sweep.table import Table
from sebody.explore.sweep.variations import distribution_of, values_of

OUTPUTS = {"tip": final("tip.position"), "speed": maximum("tip.velocity", norm=True)}
PENDULUM = '''
from sebody import Model
from sebody.scenes.scene import Scene

def build(length: float = 1.0, mass: float = 2.0) -> Scene:
    """A planar pendulum on a spring, in general position."""
    model = Model(planar=True)
    anchor, tip = model.node("anchor", (0.3, -0.2)), model.node("tip", (0.3 + length, 0.5))
    model.fix(anchor)
    model.rigid_body("bob", tip, mass, 0.3)
    model.spring(tip, anchor, stiffness=80.0, damping=0.5, name="spring")
    model.gravity((0.0, -9.81))
    return Scene("pendulum", "a mass on a spring", model, h=0.01, t_end=0.2, base="anchor")
'''
namespace: dict = {}
exec(PENDULUM, namespace)
build = namespace["build"]


def test_texts_of_axes():
    assert values_of("modes=0:8") == ("modes", list(range(9)))
    assert values_of("step=0.01,0.005") == ("step", [0.01, 0.005])
    assert values_of("load=1.amplitude=0:1:0.25") == ("load=1.amplitude", [0, 0.25, 0.5, 0.75, 1])
    assert values_of("frame=node,mean")[1] == ["node", "mean"]
    assert distribution_of("torque=normal(1e4,500)") == ("torque",
                                                         Distribution("normal", (1e4, 500)))


@pytest.mark.parametrize("one, other", [
    (Distribution("normal", (3.0, 0.5)), stats.norm(3.0, 0.5)),
    (Distribution("uniform", (-1.0, 4.0)), stats.uniform(-1.0, 5.0)),
    (Distribution("loguniform", (0.1, 10.0)), stats.loguniform(0.1, 10.0)),
    (Distribution("triangular", (0.0, 1.0, 4.0)), stats.triang(0.25, 0.0, 4.0))])
@pytest.mark.parametrize("sampler", ["lhs", "sobol", "random"])
def test_samples_are_distributed_as_asked(one, other, sampler):
    found = design({}, {"x": one, "y": one}, 256, 4, sampler).columns["x"]
    assert stats.kstest(found, other.cdf).pvalue > 1e-3      # of one fixed seed: no chance in it
    assert np.array_equal(found, design({}, {"x": one, "y": one}, 256, 4, sampler).columns["x"])


def test_all_combinations_with_all_sampled_sets():
    made = design({"a": [1, 2], "b": ["x", "y", "z"]}, {"c": Distribution("uniform", (0, 1))}, 4, 0)
    assert made.runs == 24
    assert len({(a, b, c) for a, b, c in zip(*made.columns.values(), strict=True)}) == 24
    assert len(set(made.columns["c"])) == 4


def test_every_row_is_the_run_it_says(tmp_path):
    table = sweep(build, OUTPUTS, {"length": [1.0, 1.3], "step": [0.01, 0.02]},
                  {"spring.stiffness": Distribution("uniform", (50.0, 120.0)),
                   "bob.mass": Distribution("normal", (1.0, 0.1))}, runs=3, seed=2,
                  fixed={"mass": 1.5}, output=tmp_path / "table.npz", threads=2)
    assert table.good.all() and table.runs == 12
    for k in range(12):
        length, h, stiffness, factor = (table[n][k] for n in (
            "length", "step", "spring.stiffness", "bob.mass"))
        model = build(length, 1.5 * factor).model
        model.loads[0].constants["k"] = stiffness
        expected = simulate(model, h, 0.2)
        assert np.allclose(table["tip"][k], expected["tip.position"][-1], rtol=1e-9)
    again = Table.load(tmp_path / "table.npz")
    assert np.array_equal(again["tip"], table["tip"]) and again.good.all()


def test_a_sweep_goes_on_from_its_table(tmp_path, monkeypatch):
    path, asked = tmp_path / "table.npz", {"length": list(np.linspace(0.8, 1.5, 150))}
    whole = sweep(build, OUTPUTS, asked)

    monkeypatch.setattr(room, "BATCH", 10)

    def stop(part: float) -> None:
        if part > 0.3:
            raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        sweep(build, OUTPUTS, asked, output=path, progress=stop, threads=1)
    part = Table.load(path)
    assert 0 < part.done.sum() < 150
    done = []
    rest = sweep(build, OUTPUTS, asked, output=path, progress=done.append)
    assert np.array_equal(rest["tip"], whole["tip"])
    assert done[0] > part.done.mean()
    with pytest.raises(InputError, match="is the table of another sweep"):
        sweep(build, OUTPUTS, {"length": [1.0]}, output=path)
    with pytest.raises(InputError, match="is the table of another sweep"):
        sweep(build, {"tip": final("tip.velocity")}, asked, output=path)


def test_sobol_indices_of_a_function_known_by_formula():
    sampled = {"x": Distribution("uniform", (0, 1)), "y": Distribution("uniform", (-1, 1)),
               "z": Distribution("normal", (0, 1))}
    n = 1024
    made = sobol.saltelli(sampled, n, seed=3)
    assert made.runs == n * 5
    x, y, z = (made.columns[name] for name in "xyz")
    table = Table.empty("", dict(made.columns), made.runs)
    table.done[:] = True
    table.outputs = {"f": 3 * x + y + x * z, "constant": np.ones(made.runs)}
    found = sobol.indices(table, sampled, n)
    # f = 3 x + y + x z: V_x = 9/12, V_y = 1/3, V_z = E[x]^2 = 1/4, V_xz = E[x^2] - E[x]^2 = 1/12
    total = 9 / 12 + 1 / 3 + 1 / 3
    first = np.array([9 / 12, 1 / 3, 1 / 4]) / total
    whole = np.array([9 / 12 + 1 / 12, 1 / 3, 1 / 3]) / total
    assert np.abs(found["f"] - [first, whole]).max() < 0.03     # the error of 1024 sets, 1/sqrt(n)
    assert np.array_equal(found["constant"], np.zeros((2, 3)))


REFUSED = {
    "nothing": ({}, "nothing varies"),
    "unknown": ({"listed": {"lenth": [1.0]}}, "'lenth' is unknown"),
    "twice": ({"listed": {"length": [1.0]}, "runs": 2,
               "sampled": {"length": Distribution("uniform", (1, 2))}}, "both varied and sampled"),
    "no number": ({"sampled": {"length": Distribution("uniform", (1, 2))}}, "give --runs N"),
    "number": ({"listed": {"length": [1.0]}, "runs": 5}, "nothing is sampled"),
    "mass": ({"listed": {"bob.mass": [1.0, -1.0]}}, "bob.mass of run 1 is -1"),
    "step": ({"listed": {"step": [-0.1]}}, "the time step"),
    "end": ({"listed": {"length": [1.0]}, "fixed": {"t_end": -1.0}}, "t_end is -1.0"),
    "no step": ({"listed": {"step": [0.0]}}, "the time step is 0.0: give a positive"),
    "set": ({"listed": {"length": [1.0]}, "fixed": {"length": 2.0}},
            "length varies and is set to 2.0: leave out one of them"),
    "output": ({"listed": {"length": [1.0]}, "outputs": {"x": final("top.position")}},
               "did you mean 'tip.position'"),
    "moved": ({"listed": {"length": [1.0], "spring.stiffness": [70.0, 90.0]},
               "fixed": {"equilibrium": True}},
              "spring.stiffness cannot vary where runs start from equilibrium: .*an argument of"),
    "one index": ({"sampled": {"length": Distribution("uniform", (1, 2))}, "sobol_n": 64},
                  "two --sample at least"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_sweeps_are_refused_before_the_first_run(case, tmp_path):
    arguments, message = REFUSED[case]
    path = tmp_path / "table.npz"
    with pytest.raises(InputError, match=message):
        sweep(build, **{"outputs": OUTPUTS, "output": path} | arguments)
    assert not path.exists()


@pytest.mark.parametrize("text, message", [
    ("x", "write --sample NAME"), ("x=normal", "write a distribution"),
    ("x=gauss(1,2)", "'gauss' is unknown, there are normal"), ("x=normal(1)", "mean, deviation"),
    ("x=uniform(2,1)", "rising order"), ("x=normal(1,-1)", "deviation must be above 0"),
    ("x=loguniform(0,1)", "values above 0"), ("x=normal(a,1)", "normal")])
def test_bad_distributions(text, message):
    with pytest.raises(InputError, match=message):
        distribution_of(text)


def test_the_command(tmp_path, capsys):
    scene = tmp_path / "pendulum.py"
    scene.write_text(PENDULUM)
    sweep_file = tmp_path / "SWEEP"
    command = ["sweep", str(scene), "--vary", "length=1:1.5:0.25", "--vary", "step=0.01,0.005",
               "--sample", "spring.stiffness=normal(80,5)", "--runs", "4", "--seed", "1",
               "--output", str(sweep_file), "--keep", "maximum(norm tip.velocity)"]
    assert main(command) == 0
    assert "24 of 24 runs done, 0 failed" in capsys.readouterr().out
    assert Table.load(tmp_path / "SWEEP.npz")["maximum(norm tip.velocity)"].shape == (24,)
    assert (tmp_path / "SWEEP.png").stat().st_size > 5000
    assert main([*command[:-1], "biggest(tip.velocity)"]) == 2
    assert "of the kinds maximum, minimum" in capsys.readouterr().err
    assert main(["sweep", str(scene), "--vary", "length=1,2", "--t-end", "0.1", "--step", "0.005",
                 "--output", str(tmp_path / "SHORT"), "--keep", "final(tip.position)"]) == 0
    short = Table.load(tmp_path / "SHORT.npz")
    assert short.parameters.keys() == {"length"}
    expected = simulate(build(2.0).model, 0.005, 0.1)["tip.position"][-1]
    assert np.array_equal(short["final(tip.position)"][1], expected)
    assert main(["sweep", str(scene), "--vary", "length=1,2", "--keep", "at_time(tip.position)"
                 ]) == 2
    assert "at_time takes a time" in capsys.readouterr().err


def test_runs_start_from_the_equilibrium_of_their_own_model(tmp_path, capsys):
    scene = tmp_path / "pendulum.py"
    scene.write_text(PENDULUM)
    command = ["sweep", str(scene), "--vary", "length=1,1.4", "--vary", "mass=1,3", "--keep",
               "maximum(tip.position)", "--keep", "minimum(tip.position)", "--output",
               str(tmp_path / "REST"), "--equilibrium"]
    assert main(command) == 0
    rest = Table.load(tmp_path / "REST.npz")
    for k in range(4):
        model = build(float(rest["length"][k]), float(rest["mass"][k])).model
        there = equilibrium(model)["tip.position"][-1]
        assert there[1] == pytest.approx(-0.2 - np.hypot(rest["length"][k], 0.7)
                                         - 9.81 * rest["mass"][k] / 80.0)
        for kind in ("maximum", "minimum"):
            assert rest[f"{kind}(tip.position)"][k] == pytest.approx(there, abs=1e-8)
    capsys.readouterr()
    assert main(command[:-1]) == 2      # the same table without equilibria is another sweep's
    assert "another sweep" in capsys.readouterr().err


def test_no_cluster_is_said(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(places, "PATIENCE", 1)
    with pytest.raises(InputError, match="there is no scheduler at tcp://127.0.0.1:9"):
        sweep(build, OUTPUTS, {"length": [1.0]}, cluster="tcp://127.0.0.1:9")


EDITS = [("stiffness=80.0", "stiffness=81.0"), ("t_end=0.2", "t_end=0.3"), ("h=0.01", "h=0.02"),
         ("0.3 + length, 0.5", "0.3 + length, 0.6"), ("mass, 0.3", "mass, 0.31"),
         ('model.gravity(', 'model.initial_velocity("tip", (0.1, 0.0))\n    model.gravity(')]


@pytest.mark.parametrize("edit", EDITS, ids=[new[:20] for _, new in EDITS])
def test_the_table_of_an_edited_scene_is_that_of_another_sweep(tmp_path, capsys, edit):
    """The same command after an edit of the file: refused; after none it goes on."""
    scene, table = tmp_path / "pendulum.py", tmp_path / "table"
    scene.write_text(PENDULUM)
    command = ["sweep", str(scene), "--vary", "spring.stiffness=70,80", "--output", str(table)]
    assert main(command) == 0
    assert main(command) == 0
    scene.write_text(PENDULUM.replace(*edit))
    assert main(command) == 2
    assert "is the table of another sweep, with other scenes, models" in capsys.readouterr().err


def test_an_edit_that_only_other_values_see_is_found(tmp_path):
    """The first structure is as before, the second one is not."""
    def changed(length: float = 1.0, mass: float = 2.0):
        scene = build(length, mass)
        if length > 1.5:
            scene.model.force("tip", (1.0, 0.0))
        return scene
    changed.__module__, changed.__qualname__ = build.__module__, build.__qualname__
    values = {"length": [1.0, 2.0]}
    sweep(build, OUTPUTS, values, output=tmp_path / "table.npz")
    with pytest.raises(InputError, match="is the table of another sweep"):
        sweep(changed, OUTPUTS, values, output=tmp_path / "table.npz")


def test_a_body_and_a_version_make_another_sweep(tmp_path, monkeypatch):
    """Bodies by all they hold, also what stresses are recovered from."""
    from sebody.runs import fingerprint
    sweep(build, OUTPUTS, {"spring.stiffness": [70.0]}, output=tmp_path / "table.npz")
    monkeypatch.setattr(fingerprint, "__version__", "0.0.1")
    with pytest.raises(InputError, match="or of another version of sebody"):
        sweep(build, OUTPUTS, {"spring.stiffness": [70.0]}, output=tmp_path / "table.npz")


KILLED = '''
import json, os, signal, sys
sys.path.insert(0, sys.argv[1])
from pendulum import build
from sebody.analysis import final
from sebody.explore import sweep as package

if __name__ == "__main__":
    workers = []
    package.BATCH = 20
    def kill(part):
        if not workers:         # after the first batch, others are under way
            from distributed import get_client
            import psutil
            for child in psutil.Process().children(recursive=True):
                if "spawn_main" in " ".join(child.cmdline()):
                    workers.append(child.pid)
            os.kill(workers[0], signal.SIGKILL)
    asked = {"length": [1.0 + 0.001 * k for k in range(600)], "t_end": [0.5]}
    table = package.sweep(build, {"tip": final("tip.position")}, asked, workers=2, progress=kill)
    print(json.dumps([len(workers), int(table.good.sum()), table["tip"].tolist()]))
'''


def test_a_killed_worker_loses_nothing(tmp_path):
    pytest.importorskip("distributed")
    (tmp_path / "pendulum.py").write_text(PENDULUM)
    (tmp_path / "killed.py").write_text(KILLED)
    run = subprocess.run([sys.executable, str(tmp_path / "killed.py"), str(tmp_path)],
                         capture_output=True, text=True, timeout=300, cwd=tmp_path,
                         env={**os.environ, "PYTHONPATH": str(tmp_path)})
    assert run.returncode == 0, run.stderr[-2000:]
    killed, good, tip = json.loads(run.stdout.splitlines()[-1])
    assert killed >= 1 and good == 600
    here = sweep(build, {"tip": final("tip.position")},
                 {"length": [1.0 + 0.001 * k for k in range(600)], "t_end": [0.5]})
    assert np.array_equal(np.array(tip), here["tip"])


def test_workers_with_another_version_are_refused(monkeypatch):
    distributed = pytest.importorskip("distributed")
    versions = iter(["0.0.9", "0.0.8"])
    monkeypatch.setattr(places, "_version", lambda: next(versions))
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=False,
                                  dashboard_address=None, protocol="tcp") as here:
        with pytest.raises(InputError, match="has sebody 0.0.8, this is 0.0.9: install one"):
            sweep(build, OUTPUTS, {"length": [1.0]}, cluster=here.scheduler_address)


@pytest.mark.parametrize("varied, axes", [
    ({"length": [1.0, 1.5, 2.0]}, ["length"]),
    ({"length": [1.0, 1.5], "mass": [1, 2, 3], "step": [0.01]}, ["length", "mass"]),
    ({"length": [1.0, 1.5], "mass": [1.0, 2.0], "t_end": [0.1, 0.2]}, [])])
def test_answers_of_one_or_two_parameters_are_listed(varied, axes, tmp_path):
    """A line for each run with its values; of other tables quantiles. The picture is drawn."""
    table = sweep(build, OUTPUTS, varied)
    assert table.axes() == axes
    head, *lines = table.summary().splitlines()[1:]
    if axes:
        assert head.split() == [*axes, "tip[0]", "tip[1]", "speed"] and len(lines) == table.runs
        for k, line in enumerate(lines):
            numbers = [float(word) for word in line.split()]
            assert numbers == pytest.approx([*(float(table[name][k]) for name in axes),
                                             *table["tip"][k], table["speed"][k]], rel=1e-5)
    else:
        assert head.split() == ["output", "5", "%", "median", "95", "%"]
    draw(table, tmp_path / "sweep.png")
    assert (tmp_path / "sweep.png").stat().st_size > 5000


def test_samples_of_two_parameters_are_told_by_quantiles():
    """Not every combination of their values is a run."""
    table = sweep(build, OUTPUTS, {}, {"length": Distribution("uniform", (1.0, 1.5)),
                                       "mass": Distribution("uniform", (1.0, 2.0))}, runs=3)
    assert table.axes() == [] and table.summary().splitlines()[1].startswith("output")


def test_tables_and_pictures_have_the_units_of_the_model(tmp_path, monkeypatch):
    """Also a table that is read from its file; without units there are none."""
    def in_millimetres(length: float = 900.0):
        scene = build(length)
        scene.model.units = "mm t N s"
        return scene

    outputs = {"tip": final("tip.position"), "way": integral("tip.velocity", norm=True),
               "turn": maximum("tip.rotation")}
    path = tmp_path / "table.npz"
    table = sweep(in_millimetres, outputs, {"length": [900.0, 950.0]}, output=path)
    assert table.units == {"tip": "mm", "way": "mm/s s", "turn": "rad"}
    for one in (table, Table.load(path)):
        assert one.summary().splitlines()[1].split() == [
            "length", "tip[0]", "[mm]", "tip[1]", "[mm]", "way", "[mm/s", "s]", "turn", "[rad]"]
    plotted = pytest.importorskip("matplotlib.figure")
    names = []
    monkeypatch.setattr(plotted.Figure, "savefig", lambda figure, *_, **__: names.extend(
        axis.get_ylabel() for axis in figure.axes))
    draw(table, tmp_path / "sweep.png")
    assert names == ["tip[0] [mm]", "tip[1] [mm]", "way [mm/s s]"]      # it does not turn
    assert sweep(build, OUTPUTS, {"length": [1.0, 1.5]}).units == {}


def test_a_table_as_csv_is_what_pandas_reads(tmp_path):
    pandas = pytest.importorskip("pandas")
    table = sweep(build, OUTPUTS, {"length": [1.0, 1.5], "mass": [1.0, 2.0]})
    table.failures[1] = 'stopped at t = 0.1: "no", it said'
    table.outputs["tip"][1] = np.nan
    (tmp_path / "table.csv").write_text(table.to_csv())
    read, made = pandas.read_csv(tmp_path / "table.csv"), table.to_pandas()
    assert list(read.columns) == list(made.columns) and not table.good.all()
    for name in read.columns:
        if name == "failure":
            assert read[name].fillna("").tolist() == made[name].tolist()
        else:
            assert np.array_equal(read[name], made[name].astype(read[name].dtype), equal_nan=True)


LOST = '''
import subprocess, sys
sys.path.insert(0, sys.argv[1])
from pendulum import build
from sebody import SebodyError
from sebody.analysis import final
from sebody.explore import sweep as package
from sebody.explore.sweep import executors

def begin(what, *options):
    return subprocess.Popen([sys.executable, "-m", f"distributed.cli.dask_{what}", *options],
                            stderr=subprocess.PIPE, text=True)

def asked(count, **options):
    try:
        package.sweep(build, {"tip": final("tip.position")}, {
            "length": [1.0 + 0.001 * k for k in range(count)], "t_end": [0.5]}, cluster=address,
            **options)
    except SebodyError as error:
        print(error, flush=True)

scheduler = begin("scheduler", "--port", "0", "--no-dashboard")
while "Scheduler at:" not in (line := scheduler.stderr.readline()):
    assert line
address = line.split()[-1]
executors.PATIENCE = 3
asked(1)
executors.PATIENCE = 60
worker = begin("worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny")
asked(2000, output=sys.argv[1] + "/table.npz",
      progress=lambda part: scheduler.kill() if part > 0.2 else None)
worker.kill()
'''


def test_clusters_without_workers_and_lost_schedulers_are_said(tmp_path):
    """In a line each; the runs that were done are in the table, from which the sweep goes on."""
    pytest.importorskip("distributed")
    (tmp_path / "pendulum.py").write_text(PENDULUM)
    (tmp_path / "lost.py").write_text(LOST)
    run = subprocess.run([sys.executable, str(tmp_path / "lost.py"), str(tmp_path)],
                         capture_output=True, text=True, timeout=300, cwd=tmp_path,
                         env={**os.environ, "PYTHONPATH": str(tmp_path)})
    assert run.returncode == 0, run.stderr[-2000:]
    idle, lost = run.stdout.splitlines()
    assert "has no workers after 3 s: start some with 'dask worker ADDRESS'" in idle
    assert "the scheduler of the cluster was lost: runs that were done are kept in the" in lost
    assert "Traceback" not in run.stderr
    assert 0.1 < Table.load(tmp_path / "table.npz").done.mean() < 1.0
