"""What happens to files and results when a command is stopped, fails, or nobody reads it."""

import os
import re
import signal
import subprocess
import sys
import time
import warnings

import numpy as np
import pytest

from sebody import InputError
from sebody.basics import progress
from sebody.cli import interrupts, run
from sebody.cli.entry import main
from sebody.scenes import hinged_beam

LONG = ["run", "hinged-beam", "--t-end", "1e6", "--every", "10000"]     # minutes


def files(folder):
    return ["--output", str(folder / "out.npz"), "--save", str(folder / "state.npz")]


def goes_on(folder, capsys):
    """The saved state is that of the saved histories, and runs on."""
    with np.load(folder / "out.npz") as saved, np.load(folder / "state.npz") as state:
        assert np.array_equal(saved["t"], state["rows"][:, 0])
        reached = float(state["clock"][0])
    assert 0.0 < reached < 1e6
    assert main(["run", "hinged-beam", "--resume", str(folder / "state.npz"), "--t-end",
                 repr(reached + 1.0)]) == 0
    capsys.readouterr()


@pytest.mark.parametrize("number, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_the_run_and_keeps_its_results(tmp_path, capsys, monkeypatch, interruptible,
                                                     number, code):
    """Sent by the run to its own process; what comes while files are written is too late."""
    def send(bar, fraction):
        os.kill(os.getpid(), number)
    monkeypatch.setattr(progress.Progress, "__call__", send)
    monkeypatch.setattr(progress.Progress, "close", lambda bar: send(bar, 1.0))
    assert main([*LONG, *files(tmp_path)]) == code
    out, err = capsys.readouterr()
    assert re.search(r"^error: interrupted at t = .*: results up to this time are kept$", err, re.M)
    assert f"histories            {tmp_path / 'out.npz'}" in out
    assert signal.getsignal(number) != interrupts._note
    monkeypatch.undo()
    goes_on(tmp_path, capsys)


def test_a_process_ends_soon_after_a_signal(tmp_path, capsys):
    code = ("import signal, sys\n"
            "from sebody.basics import progress\nfrom sebody.cli import entry\n"
            "progress.Progress.__call__ = lambda bar, fraction: print(flush=True)\n"
            "sys.exit(entry.main(sys.argv[1:]))")
    process = subprocess.Popen([sys.executable, "-c", code, *LONG, *files(tmp_path)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for line in process.stdout:
        if line == "\n":        # not the name of the scene, which may come first
            break
    began = time.perf_counter()
    process.terminate()
    _, err = process.communicate(timeout=60)
    # a fifth of a second in the loop, then saving: more where other processes share the machine
    assert time.perf_counter() - began < 5.0
    assert process.returncode == 143 and "Traceback" not in err
    goes_on(tmp_path, capsys)


def test_a_signal_before_there_are_results(capsys, monkeypatch, interruptible):
    def build_scene(name, changes):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)
    monkeypatch.setattr(run, "build_scene", build_scene)
    assert main(["run", "hinged-beam"]) == 130
    assert capsys.readouterr() == ("", "interrupted\n")


def test_a_failing_run_saves_its_state(tmp_path, capsys, monkeypatch):
    def build(name, changes):
        scene = hinged_beam.build(modes=2, elements=4)
        scene.model.force("tip", (0, 0, 1e12), [(0.1, 0.0), (0.11, 1.0), (0.12, 0.0)])
        return scene
    monkeypatch.setattr(run, "build_scene", build)
    state = tmp_path / "state.npz"
    assert main(["run", "struck", "--t-end", "1", "--save", str(state)]) == 1
    out, err = capsys.readouterr()
    assert out.endswith(f"state                {state}\n")
    assert main(["run", "struck", "--t-end", "1", "--resume", str(state)]) == 1
    assert all(text.startswith("error: stopped at t = 0.100") for text in
               (err, capsys.readouterr().err))      # it stops at the same place, or steps later


def test_warnings_are_lines_without_a_place_in_the_program(capsys, monkeypatch):
    def build_scene(name, changes):
        warnings.warn("code cannot be kept", RuntimeWarning, stacklevel=1)
        raise InputError("no such scene")
    monkeypatch.setattr(run, "build_scene", build_scene)
    assert main(["run", "hinged-beam"]) == 2
    assert capsys.readouterr().err == "warning: code cannot be kept\nerror: no such scene\n"


def closed_pipe():
    """The end of a pipe that nobody reads."""
    reading, writing = os.pipe()
    os.close(reading)
    return os.fdopen(writing, "w")


def test_a_reader_that_stops_reading(tmp_path, monkeypatch):
    """Every command; files are written before anything is printed."""
    commands = [["list"], ["check", "element_force"],
                ["run", "hinged-beam", "--t-end", "0.1", *files(tmp_path)]]
    for arguments in commands:
        with closed_pipe() as pipe:
            monkeypatch.setattr(sys, "stdout", pipe)
            assert main(arguments) == 141, arguments
            print("goes nowhere, and harms nobody", flush=True)
    assert (tmp_path / "out.npz").exists() and (tmp_path / "state.npz").exists()


@pytest.mark.parametrize("closed", [">&-", ">&- 2>&-"])
def test_closed_streams_take_nothing_and_hinder_nothing(tmp_path, closed):
    """As services and `>&-` in a shell start a command: Python has no streams then."""
    command = (f"exec {sys.executable} -m sebody run heavy-top --t-end 0.01 --output "
               f"{tmp_path / 'out.npz'} {closed}")
    done = subprocess.run(["sh", "-c", command], stderr=subprocess.PIPE, text=True, timeout=120)
    assert done.returncode == 0 and "Traceback" not in done.stderr
    assert (tmp_path / "out.npz").exists()


def test_memory_that_runs_out_is_said(capsys, monkeypatch):
    def build_scene(*given):
        raise MemoryError("Unable to allocate 7.45 GiB")
    monkeypatch.setattr(run, "build_scene", build_scene)
    assert main(["run", "hinged-beam"]) == 1
    assert capsys.readouterr().err == (
        "error: memory ran out: Unable to allocate 7.45 GiB; take a smaller model or mesh, keep "
        "fewer states (--every), or allow more memory\n")


def test_a_full_disk_behind_the_standard_output(monkeypatch, capsys):
    with open("/dev/full", "w") as full:
        monkeypatch.setattr(sys, "stdout", full)
        assert main(["list", "chain"]) == 1
    assert capsys.readouterr().err == ("error: the output cannot be written: No space left on "
                                       "device\n")


def test_a_file_that_cannot_be_written_after_all(tmp_path, capsys, monkeypatch):
    """The folder goes while the run is under way; the other file is written all the same."""
    folder = tmp_path / "gone"
    folder.mkdir()
    monkeypatch.setattr(progress.Progress, "close", lambda bar: folder.rmdir())
    output, state = folder / "out.npz", tmp_path / "state.npz"
    assert main(["run", "hinged-beam", "--t-end", "0.1", "--output", str(output), "--save",
                 str(state)]) == 1
    out, err = capsys.readouterr()
    assert state.exists() and out.endswith(f"state                {state}\n")
    errors = [line for line in err.splitlines() if line.startswith("error")]    # not its warnings
    assert errors == [f"error: folder {folder} of the output file does not exist: make it"]


@pytest.mark.parametrize("arguments, message", [
    (["run", "hinged-beam", "--output", "a.npz", "--save", "./a.npz"],
     "--output and --save are the same file, a.npz: give each its own"),
    (["run", "hinged-beam", "--output", "a.npz", "--resume", "a.npz"],
     "--output and --resume are the same file, a.npz: give each its own"),
    (["chart", "hinged-beam", "--output", "a.png", "--csv", "a.png"],
     "--output and --csv are the same file, a.png: give each its own")])
def test_one_file_for_two_purposes(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert capsys.readouterr().err == f"error: {message}\n"
