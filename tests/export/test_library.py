"""Libraries for C: rows of a program without Python against runs in Python, bit for bit."""

import ctypes
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
from exported_models import VARIABLE, H, arm
from helpers import multipliers_first
from readings import TABLE

import sebody.assembly.build as assembly
from sebody import (
    InputError,
    Model,
    SebodyError,
    Simulation,
    WriteError,
    generalized_alpha,
    simulate,
)
from sebody.export import export, objects, toolchain
from sebody.export.platforms import host
from sebody.scenes import chain

pytest.importorskip("ziglang", reason="exports are linked by the package ziglang")
STEPS = 150
OUTPUTS = ["the hand.position", "joint 1.force", "joint 1.local_moment.z", "energy",
           "upper arm.the hand.moment", "the floor.normal_force", "loop.states", "a wind.power",
           "motor 1.value", "joint 1.angle", "a pull.work", "upper arm.mode_rates.1"]


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The arm as a library for this processor, and its example as a program."""
    folder = export(arm(), H, library=tmp_path_factory.mktemp("exports") / "the arm",
                    name="the arm", outputs=OUTPUTS, processor="native")
    compiled_example(folder, "the_arm")
    return folder


def compiled_example(folder, name):
    """The example of a library as a program."""
    toolchain.call(folder / "example.c", f"-I{folder}", f"-L{folder / host()}", f"-l{name}",
                   f"-Wl,-rpath,{folder / host()}", "-o", folder / "example", folder=folder)


def called(folder, *arguments):
    """What the program prints, without environment variables."""
    done = subprocess.run([folder / "example", *map(str, arguments)], env={}, text=True,
                          capture_output=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_rows_are_those_of_the_run_bit_for_bit(library, tmp_path):
    called(library, STEPS, tmp_path / "rows")
    result = simulate(arm(), H, STEPS * H)
    assert result["the floor.normal_force"].max() > 1.0     # it has touched the floor
    assert np.ptp(result["motor 1.value"]) > 0.1
    assert (tmp_path / "rows").read_bytes() == result.rows[1:].tobytes()


def test_outputs_are_the_quantities_of_results(library):
    names = [re.findall(r", ([^=]*) = ", line) for line in called(library, STEPS).splitlines()][0]
    values = np.array([[float(x) for x in re.findall(r"= ([^,\n]*)", line)]
                       for line in called(library, STEPS).splitlines()])
    result = simulate(arm(), H, STEPS * H)
    assert {"the hand.position.x", "joint 1.force.z", "loop.states.0"} < set(names)
    for name, column in zip(names, values[:, 1:].T, strict=True):
        own = result[name][1:]
        # sums in another order: joint forces are differences of larger forces of elements
        assert np.abs(column - own).max() <= 1e-9 * max(1.0, np.abs(own).max()), name


@pytest.mark.skipif(not shutil.which("ldd"), reason="ldd is not installed")
def test_it_needs_libc_and_libm_alone(library):
    file, = (library / host()).iterdir()
    found = subprocess.run(["ldd", file], text=True, capture_output=True).stdout
    names = {line.split()[0].split("/")[-1].split(".")[0] for line in found.splitlines()}
    assert names - {"linux-vdso"} <= {"libc", "libm", "ld-linux-x86-64", "ld-linux-aarch64"}
    assert file.stat().st_size < 450_000        # a body, seven kernels


def test_variable_steps_are_the_same_bit_for_bit(tmp_path):
    folder = export(arm(), 10 * H, library=tmp_path / "variable", name="variable",
                    processor="native", tolerance=VARIABLE)
    text = (folder / "example.c").read_text()
    assert len(text.splitlines()) <= 60
    compiled_example(folder, "variable")
    run = Simulation(arm(), 10 * H, tolerance=VARIABLE).run_to(STEPS * H)
    called(folder, STEPS // 10, folder / "rows")
    assert (folder / "rows").read_bytes() == run.result().rows[1:].tobytes()


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
@pytest.mark.parametrize("name", [name for name, row in TABLE.items() if row.exported])
def test_models_of_many_kinds_are_the_same_bit_for_bit(name, tmp_path):
    """Continuous laws, motions without mass, jumps between close rows of a table."""
    row = TABLE[name]
    folder = export(row.build(), row.h, library=tmp_path / "made", name="made",
                    processor="native", outputs=[row.followed])
    compiled_example(folder, "made")
    called(folder, round(row.end / row.h), tmp_path / "rows")
    result = simulate(row.build(), row.h, row.end)
    assert np.ptp(result[row.followed], axis=0).max() > 0.0
    assert (tmp_path / "rows").read_bytes() == result.rows[1:].tobytes()


@pytest.mark.parametrize("name", [name for name, row in TABLE.items() if "C" in row.refused])
def test_models_that_cannot_be_exported_are_refused(name, tmp_path):
    row = TABLE[name]
    with pytest.raises(InputError, match=row.refused["C"]):
        export(row.build(), row.h, library=tmp_path / "x", processor="native")
    assert not list(tmp_path.iterdir())


def loaded(folder, name):
    """The functions of a library in this process."""
    found = ctypes.CDLL(str(next((folder / host()).glob("lib*"))))
    for one in ("new", "state_size", "error"):
        getattr(found, f"{name}_{one}").restype = ctypes.c_void_p
    return lambda one, *given: getattr(found, f"{name}_{one}")(*given)


@pytest.mark.parametrize("index", [3, 2])
def test_matrices_with_row_exchanges_are_the_same_bit_for_bit(index, monkeypatch, tmp_path):
    """The numbering makes the elimination in the loop meet zero pivots; states are put back."""
    monkeypatch.setattr(assembly, "number", multipliers_first(assembly.number))
    scene, scheme, (half, steps) = chain.build(links=6), generalized_alpha(index=index), (25, 40)
    folder = export(scene.model, 1e-3, library=tmp_path / "x", name="x", processor="native",
                    scheme=scheme)
    call, rows = loaded(folder, "x"), np.zeros((steps, 0))
    run = Simulation(scene.model, 1e-3, scheme).run_to(steps * 1e-3)
    assert run.state.control.pivoted == 1
    own = run.result().rows[1:]
    rows, again = np.zeros_like(own), np.zeros_like(own[half:])
    first, second = (ctypes.c_void_p(call("new")) for _ in range(2))
    state = ctypes.create_string_buffer(call("state_size"))
    assert call("run", first, ctypes.c_int64(half), rows.ctypes.data_as(ctypes.c_void_p)) == 0
    call("save", first, state)
    assert call("run", first, ctypes.c_int64(steps - half),
                rows[half:].ctypes.data_as(ctypes.c_void_p)) == 0
    assert call("restore", second, state) == 0
    assert call("run", second, ctypes.c_int64(steps - half),
                again.ctypes.data_as(ctypes.c_void_p)) == 0
    for one in (first, second):
        call("free", one)
    assert rows.tobytes() == own.tobytes() and again.tobytes() == own[half:].tobytes()


BAD = {
    "unknown input": ({"inputs": ["a wnd"]}, "did you mean 'a wind'"),
    "unknown output": ({"outputs": ["the hand.postion"]}, "did you mean 'the hand.position'"),
    "FE node": ({"outputs": ["upper arm.node2.displacement"]}, "cannot be compiled"),
    "platform": ({"platforms": ["linux-sparc"]}, "'linux-sparc' is unknown: use 'linux-x86_64'"),
    "processor": ({"processor": "x86-64-v9"}, "'x86-64-v9' is unknown"),
    "native elsewhere": ({"platforms": ["windows-x86_64"]}, "is that of this machine"),
    "twice": ({"outputs": ["t", "t"]}, "output 't' is given twice"),
    "input twice": ({"inputs": ["a pull", "a pull"]}, "input 'a pull' is given twice"),
    "end": ({"t_end": -1.0}, "t_end is -1.0: give a positive number"),
    "a text": ({"outputs": "t"}, "outputs is 't': give a list of names"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_exported_is_refused(case, tmp_path):
    arguments, said = BAD[case]
    with pytest.raises(InputError) as error:
        export(arm(), H, library=tmp_path / "x", **{"processor": "native", **arguments})
    assert said in str(error.value) and not list(tmp_path.iterdir())


def test_a_failure_of_llvm_is_said(monkeypatch, tmp_path):
    """It ends its process, which is none of the user's: nothing is kept then."""
    monkeypatch.setattr(objects, "KIND", "none")
    monkeypatch.setattr(objects, "call_all", lambda tasks: None)
    with pytest.raises(SebodyError, match="LLVM has made no code of engine, .* and native"):
        export(arm(), H, library=tmp_path / "x", processor="native")
    assert not list(tmp_path.iterdir())


def test_no_linker_is_said(monkeypatch, tmp_path):
    monkeypatch.setattr(toolchain, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=re.escape('pip install "sebody[fmu]"')):
        export(arm(), H, library=tmp_path / "x")


def test_places_that_cannot_be_written_are_refused_first(tmp_path):
    (tmp_path / "file").write_text("mine")
    for place, said in (("file", "is a file: give a folder"), ("no/x", "does not exist: make it")):
        with pytest.raises(InputError, match=said):
            export(Model(), H, library=tmp_path / place)
    with pytest.raises(InputError, match="one of the two"):
        export(Model(), H)


def test_a_failed_link_leaves_what_was_there(monkeypatch, tmp_path, library):
    folder = tmp_path / "older"
    folder.mkdir()
    (folder / "example.c").write_text("older")
    monkeypatch.setattr(toolchain, "SOURCES", library)      # has no sources
    with pytest.raises(SebodyError):
        export(arm(), H, library=folder, processor="native")
    assert [file.name for file in folder.rglob("*")] == ["example.c"]
    assert (folder / "example.c").read_text() == "older" and len(list(tmp_path.iterdir())) == 1


@pytest.mark.skipif(sys.platform != "linux", reason="limits the size of files as Linux does")
def test_a_full_disk_leaves_what_was_there(tmp_path):
    import resource
    import signal

    before = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ,
                                                                      signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, before[0][1]))
        with pytest.raises(WriteError, match="cannot be"):
            export(arm(), H, library=tmp_path / "x", processor="native")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before[0])
        signal.signal(signal.SIGXFSZ, before[1])
    assert not list(tmp_path.iterdir())
