"""The command line for someone new: words that are none, default names of files, completion."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from sebody import InputError, simulate
from sebody.analysis import final
from sebody.catalogue import kernel_files
from sebody.cli.entry import main
from sebody.explore.sweep import sweep
from sebody.scenes import planar_hinged_beam
from sebody.verify.check.chosen import JOINTS, chosen_kernels


@pytest.mark.parametrize("word, message", [
    ("runn", "command 'runn' is unknown: did you mean 'run'?"),
    ("lst", "command 'lst' is unknown: did you mean 'list'?"),
    ("zzz", "command 'zzz' is unknown: there are run, sweep, advise, list, new")])
def test_a_command_that_is_none_names_the_nearest(word, message, capsys):
    with pytest.raises(SystemExit) as caught:
        main([word])
    assert caught.value.code == 2 and message in capsys.readouterr().err


def test_the_package_is_the_command_line():
    said = subprocess.run([sys.executable, "-m", "sebody", "runn"], capture_output=True, text=True)
    assert said.returncode == 2 and "did you mean 'run'?" in said.stderr


def test_pictures_and_pages_have_default_names(tmp_path, capsys):
    """Beside the result, of its name, each another one; the commands say which."""
    scene, file = planar_hinged_beam.build(), tmp_path / "my.run.npz"
    simulate(scene.model, scene.h, 5 * scene.h).save(file)
    for command, made in (("plot", "my.run.png"), ("animate", "my.run.html"),
                          ("report", "my.run_report.html")):
        assert main([command, str(file)]) == 0
        assert capsys.readouterr().out.endswith(f": {tmp_path / made}\n")
        assert (tmp_path / made).stat().st_size > 1000


def test_a_table_of_a_sweep_is_listed(tmp_path, capsys):
    sweep(planar_hinged_beam.build, {"tip": final("tip.position.x")}, {"modes": [1, 3]}, {},
          fixed={"t_end": 0.02}, output=tmp_path / "table.npz")
    assert main(["list", str(tmp_path / "table.npz")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == ["modes: 2 values, 1 to 3", "2 of 2 runs done, 0 failed"]
    assert lines[2].split() == ["modes", "tip"] and lines[-1].split()[0] == "3"


@pytest.mark.parametrize("name, message", [
    ("sat.npx", "cannot list sat.npx: there is no such file; give the name of a scene, FILE.py"),
    ("sat.npz", "results file sat.npz does not exist: give one that was saved")])
def test_a_file_that_there_is_not_is_no_scene(name, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["list", name]) == 2 and message in capsys.readouterr().err


def test_kernels_of_joints():
    """Those of their equations in space and in a plane, to the ground and to a node."""
    known = list(kernel_files())
    found = {name: {one.removeprefix("element_") for one in chosen_kernels([name], known)}
             for name in JOINTS}
    assert found["revolute"] == {"parallel", "parallel_ground", "coincident", "coincident_ground",
                                 "planar_coincident", "planar_coincident_ground"}
    assert found["distance"] == {"distance", "planar_distance"} & {
        one.removeprefix("element_") for one in known}
    assert {"on_line", "parallel"} <= found["cylindrical"] and "on_plane" in found["planar_joint"]
    assert all(found.values())
    assert chosen_kernels(["spring", "element_spring"], known) == ["element_spring"]
    with pytest.raises(InputError, match="kernel 'revolut' is unknown: did you mean 'revolute'"):
        chosen_kernels(["revolut"], known)


def test_shells_complete_commands(capsys):
    pytest.importorskip("shtab")
    with pytest.raises(SystemExit) as caught:
        main(["--print-completion", "bash"])
    script = capsys.readouterr().out
    assert caught.value.code == 0 and re.search(r"\(run sweep .*plot", script)
    checked = subprocess.run(["bash", "-n"], input=script, text=True) if Path(
        "/bin/bash").exists() else None
    assert checked is None or checked.returncode == 0


def test_completion_names_what_it_needs(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "shtab", None)
    with pytest.raises(SystemExit) as caught:
        main(["--print-completion", "zsh"])
    assert caught.value.code == 2
    assert 'completion needs shtab: pip install "sebody[completion]"' in capsys.readouterr().err
