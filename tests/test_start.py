"""What programs load before they do anything: time to start is the time these imports take."""

import subprocess
import sys

import pytest
from pages import public_names

import sebody
from sebody.cli.entry import COMMANDS

LIBRARIES = {"numpy", "scipy", "numba", "sympy", "matplotlib", "pandas", "h5py"}
COMMAND_LINE = {"sebody", "sebody.basics", "sebody.cli"}
# of basics, what the command line loads to show its help
BASICS = {"sebody.basics.collector", "sebody.basics.lazy", "sebody.basics.errors"}
MODEL_AND_RUN = {"sebody.contract", "sebody.compiler", "sebody.kernels", "sebody.generated",
                 "sebody.engine", "sebody.fem", "sebody.reduction", "sebody.io", "sebody.model",
                 "sebody.assembly", "sebody.quantities", "sebody.results", "sebody.runs"}
# parts of rooms that neither a model nor a run needs
UNUSED = {"sebody.explore.advice", "sebody.explore.ensembles", "sebody.small_motion.frequency",
          "sebody.small_motion.campbell", "sebody.runs.statics", "sebody.pictures.animation",
          "sebody.pictures.report", "sebody.pictures.film", "sebody.io.importing",
          "sebody.io.registry", "sebody.model.variants"}
# of SciPy; signal and stats take half a second, spatial 0.15 s, optimize and interpolate 0.1 to 0.2
SCIPY = {"scipy.linalg", "scipy.sparse", "scipy.version"}


def loaded(code: str) -> set[str]:
    """Modules of the package and of libraries that a program has loaded at its end."""
    code += "\nimport sys\nprint('\\nloaded', *sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names = done.stdout.rpartition("\nloaded ")[2].split()
    return {name for name in names if name.partition(".")[0] in LIBRARIES | {"sebody"}}


def upper(names: set[str], depth: int = 2) -> set[str]:
    """Names of packages down to a depth, without private ones."""
    short = {".".join(name.split(".")[:depth]) for name in names}
    return {name for name in short if "._" not in name}


def command(*arguments: str) -> str:
    """A program that gives the command line some arguments."""
    return ("from sebody.cli.entry import main\ntry:\n"
            f"    main({list(arguments)!r})\nexcept SystemExit:\n    pass")


def test_import_of_the_package_loads_nothing():
    assert loaded("import sebody") == {"sebody", "sebody.basics", "sebody.basics.collector",
                                       "sebody.basics.lazy"}


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["sweep", "--help"]])
def test_help_loads_no_library(arguments):
    names = loaded(command(*arguments))
    assert upper(names) <= COMMAND_LINE
    assert {name for name in names if name.startswith("sebody.basics.")} <= BASICS


def test_the_version_is_printed(capsys):
    code = command("--version")
    names = loaded(code)
    assert upper(names) <= COMMAND_LINE
    assert {name for name in names
            if name.startswith("sebody.basics.")} <= BASICS | {"sebody.basics.version"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == f"sebody {sebody.__version__}\n"
    assert sebody.__version__[0].isdigit()


def test_a_model_and_a_run_load_what_they_need():
    """The names of README's example, and the run of its first command."""
    names = loaded("from sebody import Model, simulate")
    assert upper({name for name in names if name.startswith("sebody")}) <= (
        COMMAND_LINE | MODEL_AND_RUN) - {"sebody.cli"}
    run = loaded(command("run", "hinged-beam", "--t-end", "0.05"))
    for found in (names, run):
        assert upper({name for name in found if name.startswith("scipy.")}) <= SCIPY
        assert {name.partition(".")[0] for name in found} == {"numpy", "scipy", "numba", "sebody"}
    assert not names & UNUSED
    assert not run & (UNUSED - {"sebody.model.variants"})


@pytest.mark.parametrize("package", public_names())
def test_names_are_there_before_they_are_loaded(package):
    """For completion, `import *` and readers, whatever was loaded before."""
    code = (f"import {package} as package\nlisted = set(dir(package))\n"
            "assert listed >= set(package.__all__), package.__all__\n"
            f"from {package} import *\n"
            "import inspect\n"
            "for name in package.__all__:\n"
            "    assert name in globals() and not inspect.ismodule(globals()[name]), name\n"
            "try:\n    package.nothing\nexcept AttributeError as error:\n    print(error)")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"module {package!r} has no attribute 'nothing'\n"


def test_a_submodule_does_not_hide_the_function_of_its_name():
    code = ("import sebody.pictures.report, sebody.small_motion.campbell\n"
            "from sebody.results import report\nfrom sebody.analysis import campbell\n"
            "print(report.__module__, campbell.__module__)")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["sebody.pictures.report", "sebody.small_motion.campbell"]


def test_every_command_is_light():
    """Their modules are loaded for any command: libraries are imported where a command runs."""
    assert {one.__name__.rpartition(".")[0] for one in COMMANDS} == {"sebody.cli"}
    code = "import importlib\n" + "\n".join(
        f"importlib.import_module({one.__name__!r})" for one in COMMANDS)
    assert upper(loaded(code)) <= COMMAND_LINE


def test_scenes_do_not_warn_of_a_sign_that_they_know():
    code = "import sebody.scenes.machine_bed as scene\nscene.build()"
    done = subprocess.run([sys.executable, "-W", "default", "-c", code], capture_output=True,
                          text=True, check=True)
    assert "FutureWarning" not in done.stderr
