"""The command line as a user sees it, and the README's example."""

import io
import re
from contextlib import redirect_stderr
from pathlib import Path

import numpy as np
import pytest
from pages import all_pages

from sebody import catalogue, simulate
from sebody.basics import errors, progress
from sebody.catalogue import scenes
from sebody.cli import run, scene_arguments
from sebody.cli.entry import main
from sebody.runs import first_run
from sebody.scenes import hinged_beam, planar_hinged_beam
from sebody.verify import chart, check
from sebody.verify.check.states import CheckRow
from sebody.verify.references import reference, tip_error

ROOT = Path(__file__).parents[2]
KEYS = {"t": (51,), "base.angular_velocity": (51, 3), "tip.position": (51, 3),
        "energy.kinetic": (51,), "energy.strain": (51,), "energy.external_work": (51,)}


def test_run_saves_and_draws(tmp_path, capsys):
    output, picture = tmp_path / "beam.npz", tmp_path / "beam.png"
    assert main(["run", "hinged-beam", "--t-end", "0.5", "--output", str(output),
                     "--plot", str(picture)]) == 0
    with np.load(output) as saved:
        assert {key: saved[key].shape for key in KEYS} == KEYS
        assert saved["t"][-1] == pytest.approx(0.5)
    assert picture.stat().st_size > 10_000
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "hinged-beam: the paper's hinged beam, spun up by a torque at its base"
    assert lines[1] == "unknowns             15"
    assert lines[2] == "steps                50 (0 rejected), to t = 0.5"
    assert lines[-2:] == [f"histories            {output}", f"picture              {picture}"]


def test_advise_prints_what_is_enough(capsys):
    assert main(["advise", "hinged-beam", "--t-end", "1", "--quantity", "tip.position",
                 "--tolerance", "0.02"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["predicted", "error", "step", "seconds", "change"]
    assert 0.0 < float(lines[1].split()[1]) < 1e-3 and lines[1].split()[2] == "0.0025"
    assert " ".join(lines[1].split()[4:8]) == "beam: 8 bodies with"     # the detailed
    error = float(lines[-1].removeprefix("confirmed error ").removesuffix(" <= 0.02"))
    assert 0 < error <= 0.02


def test_advise_draws_the_search_and_prints_the_model(tmp_path, capsys, monkeypatch):
    picture, drawn, draw = tmp_path / "search.png", [], chart.draw
    monkeypatch.setattr(chart, "draw", lambda name, points, *others: drawn.append(
        (list(points), *others)) or draw(name, drawn[0][0], *others))
    assert main(["advise", "planar-hinged-beam", "--t-end", "1", "--quantity", "tip.position",
                 "--tolerance", "0.02", "--set", "modes=2", "--code", "--output",
                 str(picture)]) == 0
    assert picture.stat().st_size > 10_000
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1].startswith("confirmed error ")
    assert lines[-2] == f"picture: {picture}"
    # every run once; the choice is one of them, and guards are no models to choose
    (points, front, _, _, choice, tolerance, _), = drawn
    rows = lines[1:next(k for k, line in enumerate(lines) if line.startswith("Keeps "))]
    assert len(points) == len(rows) and choice in points and tolerance == 0.02
    assert choice.label.partition("; step")[0] in "".join(rows)
    assert any(p.family.startswith("guard") for p in points)
    assert not any(p.family.startswith("guard") for p in front)
    begin = lines.index("from sebody.scenes.planar_hinged_beam import build")
    code = lines[begin:lines.index("", lines.index("model = build(modes=2).model"))]
    found = {}
    exec("\n".join(code), found)
    result, whole = found["result"], simulate(planar_hinged_beam.build(modes=2).model, 0.0025, 1.0)
    every = round((result.t[1] - result.t[0]) / 0.0025)
    off = result["tip.position"] - whole["tip.position"][::every]
    travel = whole["tip.position"] - whole["tip.position"][0]
    assert 0 < np.abs(off).max() <= 0.02 * np.abs(travel).max()


def test_run_with_other_parameters(capsys):
    assert main(["run", "hinged-beam", "--t-end", "0.1", "--step", "0.005", "--rho", "0.5",
                     "--set", "modes=0", "--set", "elements=4", "--set", "frame=node"]) == 0
    out = capsys.readouterr().out
    assert "unknowns             11" in out
    assert "steps                20 (0 rejected), to t = 0.1" in out


def test_run_with_an_accuracy(capsys):
    assert main(["run", "squeezer", "--step", "1e-4", "--t-end", "0.005", "--accuracy",
                     "1e-3"]) == 0
    assert re.search(r"error +0\.\d\d of the tolerance, estimated", capsys.readouterr().out)


def test_run_stops_and_goes_on(tmp_path, capsys):
    state = tmp_path / "state.npz"
    assert main(["run", "hinged-beam", "--t-end", "0.2", "--save", str(state)]) == 0
    assert main(["run", "hinged-beam", "--t-end", "0.5", "--resume", str(state)]) == 0
    assert "steps                50 (0 rejected), to t = 0.5" in capsys.readouterr().out


@pytest.mark.parametrize("arguments, message", [
    (["triple-beam"], "scene 'triple-beam' is unknown: did you mean 'spherical-beam' or "),
    (["pendulum"], "scene 'pendulum' is unknown: there are ball-on-beam, blade, bolted-arm, box, "),
    (["Four_Bar"], "scene 'Four_Bar' is unknown: did you mean 'four-bar'?"),
    (["hinged-beam", "--set", "length=3"], "scene 'hinged-beam' has no parameter 'length': there "
     "are frame=converged_mean, inertia=None, modes=4, elements=20"),
    (["hinged-beam", "--set", "modes"], "cannot read --set modes: write --set NAME=VALUE"),
    (["hinged-beam", "--set", "modes=two"], "parameter modes is 'two': give a value of type int"),
    (["hinged-beam", "--set", "frame=best"], "frame 'best' is unknown: use one of"),
    (["hinged-beam", "--step", "0"], "the time step is 0.0: give a positive number"),
    (["hinged-beam", "--rho", "1.5"], "rho is 1.5: use a spectral radius between 0 and 1"),
    (["hinged-beam", "--t-end", "nan"], "the end time is nan: give a number >= 0"),
    (["hinged-beam", "--output", "beam.txt"], "output file beam.txt must end in .npz"),
    (["hinged-beam", "--output", "nowhere/b.npz"], "folder nowhere of the output file does not"),
    (["hinged-beam", "--plot", "beam.exe"], "picture beam.exe must end in .png"),
    (["hinged-beam", "--accuracy", "-1"], "tolerance relative is -1.0: give a number >= 0"),
    (["hinged-beam", "--accuracy", "1e-3", "--save", "a.npz"], "--accuracy repeats the run with"),
    (["hinged-beam", "--resume", "none.npz"], "restart file none.npz does not exist"),
    (["hinged-beam", "--resume", "a.npz", "--step", "1"], "--resume continues with the step that"),
    (["hinged-beam", "--resume", "a.npz", "--rho", "1"], "--resume continues with the rho that"),
    (["hinged-beam", "--save", "state.txt"], "restart file state.txt must end in .npz"),
    (["hinged-beam", "--index", "0"], "index is 0: use 3, or 2 for the stabilised form"),
    (["hinged-beam", "--index", "1"], "index is 1: use 3, or 2 for the stabilised form"),
])
def test_bad_input_is_named(arguments, message, capsys):
    assert main(["run", *arguments]) == 2
    assert capsys.readouterr().err.startswith("error: " + message)


def test_a_failed_run_keeps_what_it_has(tmp_path, capsys, monkeypatch):
    def build(name, changes):
        scene = hinged_beam.build(modes=2, elements=4)
        scene.model.force("tip", (0, 0, 1e12), [(0.1, 0.0), (0.11, 1.0), (0.12, 0.0)])
        return scene

    monkeypatch.setattr(run, "build_scene", build)
    output, picture = tmp_path / "kept.npz", tmp_path / "kept.png"
    assert main(["run", "struck", "--t-end", "1", "--output", str(output), "--plot",
                     str(picture)]) == 1
    out, err = capsys.readouterr()
    assert "FAILED" in out
    assert err.startswith("error: stopped at t = 0.1")
    assert picture.exists()
    with np.load(output) as saved:
        assert 10 <= saved["t"].size < 20


def test_values_take_the_type_of_the_default():
    assert scene_arguments._value("modes", "3", 4) == 3
    assert scene_arguments._value("length", "3", 4.0) == 3.0
    assert scene_arguments._value("frame", "3", "mean") == "3"
    assert scene_arguments._value("planar", "True", False) is True
    assert scene_arguments._value("load", "(0, 1)", None) == (0, 1)
    with pytest.raises(errors.InputError, match="type int, such as 4"):
        scene_arguments._value("modes", "3.5", 4)


def test_list_shows_every_scene_and_kernel(capsys):
    assert main(["list"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"^  hinged-beam +The paper's hinged beam", out, re.M)
    assert not re.search(r"^  scene ", out, re.M)
    assert re.search(r"^  f2 +converged_mean +material$", out, re.M)
    assert re.search(r"^  planar-f2 +converged_mean +material$", out, re.M)
    assert "rigid_body" in out.partition("joints and loads")[2]


def test_list_shows_the_kernels_of_the_user(capsys, monkeypatch, tmp_path):
    (tmp_path / "superelement_f9_mean_frame_axes.py").write_text(
        'LAYOUT = "f9"\nFRAME = "mean"\nINERTIA = "a"\nraise RuntimeError("imported")\n')
    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path))
    assert main(["list"]) == 0
    assert re.search(r"^  f9 +mean +a$", capsys.readouterr().out, re.M)


def test_check_of_named_kernels_prints_all_criteria(capsys):
    assert main(["check", "element_force"]) == 0
    *lines, last = capsys.readouterr().out.splitlines()
    assert sum(line.startswith("element_force ") for line in lines) == len(lines) - 1 >= 4
    assert last == f"{len(lines) - 1} criteria of 1 kernel hold"


def test_check_of_all_kernels_prints_what_fails(capsys, monkeypatch):
    asked = []

    def check_kernels(names):
        asked.append(names)
        return [CheckRow("element_a", "force", 0, 1e-9, None, 1e-7),
                CheckRow("element_b", "force", 0, 1e-3, None, 1e-7)]
    monkeypatch.setattr(check, "check_kernels", check_kernels)
    assert main(["check"]) == 1 and asked == [None]
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines if "FAILED" in line] == [
        ["element_b", "force", "0", "1.0e-03", "1e-07", "FAILED"]]
    assert not any(line.startswith("element_a") for line in lines)
    assert lines[-1] == "1 of 2 criteria fail"


def test_warm_compiles_kernels_and_loop(capsys, monkeypatch):
    asked = []

    def compile_missing(kernels, parts, report, together):
        asked.extend([*kernels, *parts, *together])
        report("element_force", 0.4)
    kernels = ["element_force", "superelement_f2_converged_mean_material"]
    monkeypatch.setattr(catalogue, "kernel_files", lambda: kernels)
    monkeypatch.setattr(first_run, "compile_missing", compile_missing)
    eight = []
    monkeypatch.setattr(first_run, "lanes_exist", lambda: True)
    monkeypatch.setattr(first_run, "compile_together", eight.append)
    assert main(["warm"]) == 0
    out = capsys.readouterr().out
    assert {*kernels, "loop", "reactions"} <= set(asked) and asked.count(kernels[1]) == 2
    assert eight == kernels[1:]
    assert re.search(r"^  element_force +0\.4 s$", out, re.M)
    assert "2 kernels and the time loop are compiled, 1 kernel also for eight equal bodies" in out


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize("patience, stream, expected", [
    (0.0, Terminal(), "\r[" + "#" * 10 + "." * 30 + "]  25 %  t = 2 of 8\r[" + "#" * 40
     + "] 100 %  t = 8 of 8, 3 a second, 0 s left\n"),
    (0.0, io.StringIO(), ""), (1e3, Terminal(), "")])
def test_progress_is_for_long_runs_on_a_terminal(patience, stream, expected, monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", patience)
    monkeypatch.setattr(progress.time, "perf_counter", iter((0.0, 5.0, 7.0)).__next__)
    with redirect_stderr(stream):
        bar = progress.Progress(8.0)
        bar(0.25)
        bar(1.0)
        bar.close()
    assert stream.getvalue() == expected


def test_no_command_and_unknown_commands_are_refused(capsys):
    for arguments in ([], ["fly"]):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 2
    assert "COMMAND" in capsys.readouterr().err


def test_example_of_the_readme(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "README.md").read_text()
    code = re.search(r"```python\n(.*?)```", text, re.S).group(1)
    names = {}
    exec(code, names)
    assert "steps                3000 (0 rejected), to t = 30" in capsys.readouterr().out
    result = names["result"]
    text += (ROOT / "sebody" / "model" / "README.md").read_text()
    assert (tmp_path / "beam.png").stat().st_size > 10_000
    assert len(result.t) == len(reference("hinged_beam")["t"])
    assert tip_error("hinged_beam", result.t, result["tip.position"]) <= 1.0e-3
    for name in re.findall(r'result\["(.*?)"\]', text):
        assert len(result[name]) == len(result.t), name
    for name in re.findall(r'model\.element\("(.*?)"\)', text):
        assert names["model"].element(name).name == name


@pytest.mark.parametrize("page", all_pages(), ids=lambda page: str(page.relative_to(ROOT)))
def test_links_and_scenes_of_a_page_exist(page):
    text = page.read_text()
    assert set(re.findall(r"sebody (?:run|sweep) ([a-z][\w-]*)(?![\w.-])", text)) <= set(scenes())
    for link, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([^)]*))?\)", text):
        target = page.parent / link if link else page
        assert target.exists(), link
        if anchor:
            headings = re.findall(r"^#+ (.*)$", target.read_text(), re.M)
            assert anchor in {re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-")
                              for heading in headings}, f"{link}#{anchor}"


def test_folders_and_pictures_exist():
    text = (ROOT / "sebody" / "README.md").read_text()
    folders = re.findall(r"^\| .*?`([a-z/]+/)`", text, re.M)
    assert len(folders) > 15 and all((ROOT / folder).is_dir() for folder in folders)
    text = (ROOT / "README.md").read_text()
    for picture in re.findall(r"!\[.*?\]\((.*?)\)", text):
        assert (ROOT / picture).exists()
