"""Folders and their order: what every file may import, and that no modules import in a circle."""

import ast
import re
import subprocess
import sys
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = {"sebody": "sebody", "derive": "sebody.derive", "generated": "sebody.generated",
           "examples": "sebody.scenes"}
# every folder, lowest first, and which others its files may import, besides the helpers in basics
OPEN = {"basics"}
COMPILED = {"contract", "compiler", "kernels", "generated"}
MAY_IMPORT = {
    "basics": set(),
    "contract": set(),
    "compiler": {"contract"},
    "kernels": {"contract", "compiler"},
    "generated": {"contract", "compiler", "kernels"},
    "engine": {"contract", "compiler", "kernels"},
    "fem": set(),
    "reduction": {"fem"},
    "io": {"fem", "reduction"},
    "model": {*COMPILED, "fem", "reduction", "io"},         # of generated the options alone
    "control": {"model"},           # its names
    "quantities": {*COMPILED, "engine", "reduction", "model"},
    "assembly": {*COMPILED, "engine", "reduction", "model", "quantities"},  # the options likewise
    "parameters": {"reduction", "model", "assembly", "quantities"},
    "results": {*COMPILED, "engine", "fem", "reduction", "model", "assembly", "quantities"},
    "pictures": {"fem", "reduction", "model", "quantities", "results"},
    "names of results": {"results", "pictures"},
    "runs": {*COMPILED, "engine", "reduction", "model", "assembly", "quantities", "results"},
    "small_motion": {*COMPILED, "engine", "reduction", "model", "assembly", "quantities", "results",
                     "pictures", "runs"},
    "gradients": {*COMPILED, "engine", "fem", "reduction", "model", "assembly", "quantities",
                  "results", "pictures", "parameters", "runs", "small_motion"},
    "explore": {*COMPILED, "engine", "fem", "io", "reduction", "model", "assembly", "quantities",
                "results", "pictures", "parameters", "runs", "small_motion", "gradients"},
    "names of reduction": {"reduction", "explore"},
    # names of other folders
    "analysis": {"runs", "small_motion", "explore", "gradients"},
    "sebody": {"model", "results", "runs"},         # its names: sebody/__init__.py
    "scenes": {"sebody", "control", "fem", "reduction", "names of reduction", "io", "results",
               "pictures", "analysis"},
    "catalogue": {*COMPILED, "scenes"},
    "verify": {*COMPILED, "engine", "fem", "reduction", "model", "assembly", "quantities",
               "results", "pictures", "runs", "small_motion", "explore", "gradients", "sebody",
               "analysis", "io", "names of reduction", "scenes", "catalogue"},
    "export": {*COMPILED, "engine", "model", "assembly", "quantities", "results", "parameters",
               "runs"},
    "cli": {"contract", "kernels", "reduction", "io", "sebody", "results", "pictures", "runs",
            "explore", "analysis", "scenes", "catalogue", "verify", "export"},
    "derive": {"contract", "compiler", "kernels"},
}
# modules of a folder above their own: names that are loaded when they are asked for, and
# the command line as a program
APART = {"sebody.results": "names of results", "sebody.reduction": "names of reduction",
         "sebody.__main__": "cli"}
RUNTIME = {"numpy", "scipy", "numba"}
PACKAGES = {"basics": {"numpy"}, "contract": {"numpy"}, "compiler": RUNTIME | {"llvmlite"},
            "kernels": RUNTIME | {"llvmlite"}, "engine": RUNTIME | {"llvmlite"},
            "export": RUNTIME | {"llvmlite"},
            "generated": {"numba", "math"}, "derive": {"sympy", "mpmath"}}
# modules that may import matplotlib
PICTURES = {"plots", "control_figures", "frequency_pictures", "orbit_pictures", "drawing",
            "film", "film_marks", "rendering", "draw", "picture", "paper_figures",
            "vibration_figures", "notebook"}
FORMULAS = {"derivatives"}      # that may import SymPy, once it is asked for
EXTRAS = {"peer", "peer_models", "peer_mechanisms"}     # that may import Exudyn
# modules of extras by folder, and what they may import
OTHERS = {"io/nastran": {"pyyeti"}, "io/ansys_process": {"ansys"}, "io/ngsolve_space": {"ngsolve"},
          "results/hdf5": {"h5py"}, "basics/hdf5": {"h5py"},
          "results/dataframes": {"pandas", "xarray"}, "results/hot_spots": {"pandas"},
          "results/vtk_series": {"meshio"}, "pictures/film": {"PIL", "imageio"},
          "small_motion/state_space": {"control"}, "reduction/pardiso": {"pypardiso"},
          "cli/entry": {"shtab"}, "explore/executors": {"distributed"}, "explore/table": {"pandas"}}


def module(path: Path) -> str:
    """Full name of the module of a file."""
    folder, *parts = path.relative_to(ROOT).with_suffix("").parts
    parts = parts[:-1] if parts[-1] == "__init__" else parts
    return ".".join([FOLDERS[folder], *parts])


def folder_of(name: str) -> str:
    """The folder of the package that a module is in; that of sebody/__init__.py is `sebody`."""
    return APART.get(name, (name.split(".") + ["sebody"])[1])


def imported(source: str) -> set[str]:
    """Full names of what a module imports, in functions and for type checkers, too.

    What comes after the last line with the word is not parsed, where the rest is whole without it:
    of generated files nearly everything.
    """
    lines = [found.end() for found in re.finditer(r"\bimport\b.*", source)]
    try:
        tree = ast.parse(source[:lines[-1]] if lines else "")
    except SyntaxError:     # the import goes on, or stands in a text
        tree = ast.parse(source)
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"relative import of {node.module}"
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


@cache
def imported_by(path: Path) -> set[str]:
    """Full names of what a file imports."""
    return imported(path.read_text())


FILES = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py"))]
MODULES = {module(path): path for path in FILES}


def imported_modules(path: Path) -> set[str]:
    """Modules of the package that a file imports itself or takes names from."""
    names = {name for name in imported_by(path) if name.split(".")[0] == "sebody"}
    return {name if name in MODULES else name.rpartition(".")[0] for name in names}


def test_imports_are_found():
    source = ("import a.b\nfrom a.c import d\nfrom typing import TYPE_CHECKING\n"
              "if TYPE_CHECKING:\n    from e import f\ndef g():\n    from h import i\n")
    assert imported(source) == {"a.b", "a.c.d", "typing.TYPE_CHECKING", "e.f", "h.i"}
    assert imported(source + "x = 1\n") == imported(source)
    assert imported("from a import (\n    b, c)\nx = 1\n") == {"a.b", "a.c"}
    assert imported('"""To import\nis not to have."""\nfrom a import b  # not c\n') == {"a.b"}
    assert imported('"""To import\nis not to have."""\n') == set()


def test_every_folder_is_above_those_it_imports():
    """And the page on folders has them in the same order."""
    order = list(MAY_IMPORT)
    page = (ROOT / "sebody/README.md").read_text().partition("Within `sebody/`")[2]
    listed = re.findall(r"`sebody/(\w+)(?:/|\.py)`", "".join(
        line.split("|")[1] for line in page.splitlines() if line.startswith("| `")))
    assert listed == [name for name in order if " " not in name and name not in (
        "sebody", "generated", "scenes", "derive")]
    assert not [(high, low) for high, lower in MAY_IMPORT.items() for low in lower
                if order.index(low) >= order.index(high)]
    assert {folder_of(name) for name in MODULES} == set(MAY_IMPORT)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_go_one_way(path):
    own = folder_of(module(path))
    allowed = MAY_IMPORT[own] | OPEN | {own}
    if path == ROOT / "derive/__main__.py":
        allowed = allowed | {"generated"}           # where it writes
    for name in imported_modules(path):
        assert name in MODULES, f"there is no module {name}"
        assert folder_of(name) in allowed, f"{module(path)} imports {name}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_packages_of_others(path):
    own = folder_of(module(path))
    allowed = PACKAGES.get(own, RUNTIME) | {"sebody"}
    allowed |= {"matplotlib", "mpl_toolkits"} if path.stem in PICTURES else set()
    allowed |= {"exudyn"} if path.stem in EXTRAS else set()
    allowed |= OTHERS.get(f"{own}/{path.stem}", set())
    allowed |= {"sympy"} if path.stem in FORMULAS else set()
    tops = {name.split(".")[0] for name in imported_by(path)}
    unknown = tops - allowed
    assert unknown <= (set() if own == "generated" else set(sys.stdlib_module_names)), unknown


def test_numbas_inside_is_used_in_one_module():
    """What a release of Numba may change stands in one table, and has a plain counterpart."""
    users = {name for name, path in MODULES.items() for other in imported_by(path)
             if other.startswith(("numba.core", "numba.misc", "numba.np", "numba.cpython"))}
    assert users == {"sebody.compiler.inside.names"}
    ways = [{node.name for node in ast.parse((ROOT / path).read_text()).body
             if isinstance(node, ast.FunctionDef) and node.name[0] != "_"}
            for path in ("sebody/compiler/plain.py", "sebody/compiler/inside/entry.py")]
    assert ways[0] == ways[1] | {"is_kept"}      # that of the fast way is in its cache.py


def test_no_circle_among_modules():
    graph = {name: imported_modules(path) for name, path in MODULES.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(f"modules import each other: {' <- '.join(error.args[1])}")


def test_sympy_is_not_loaded():
    code = ("import sys, sebody, sebody.cli.entry, sebody.scenes.hinged_beam\n"
            "print(sorted({'sympy', 'matplotlib', 'sebody.derive'} & set(sys.modules)))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
