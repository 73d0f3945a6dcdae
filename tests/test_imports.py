"""The one-way rule: derive/ writes kernels, sebody/ runs on them, and neither needs the other."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LEAVES = {"sebody.kernels.rotations", "sebody.kernels.frame_search", "sebody.kernels.dense",
          "sebody.kernels.abi", "sebody.kernels.pipeline", "sebody.kernels.layout"}
PICTURES = {"plot", "draw", "paper_figures"}     # that may import matplotlib
MAIN_ONLY = {"sebody.generated"}


def imported(path: Path, package: str) -> set[str]:
    """Full names of everything a module of `package` imports, also inside functions."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".")[:1 - node.level or None] if node.level else []
            module = ".".join([*parts, *([node.module] if node.module else [])])
            names |= {f"{module}.{alias.name}" for alias in node.names}
    return names


def modules(folder: str, package: str) -> list:
    """Files of a folder and the package each belongs to."""
    return [pytest.param(path, ".".join([package, *path.relative_to(ROOT / folder).parent.parts]),
                         id=str(path.relative_to(ROOT)))
            for path in sorted((ROOT / folder).rglob("*.py"))]


def within(name: str, allowed: set[str]) -> bool:
    return any(name == a or name.startswith(a + ".") for a in allowed)


def test_names_are_resolved(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("import a.b\nfrom . import c\nfrom .d import e\nfrom ..f import g\n"
                    "def h():\n    from i import j\n")
    assert imported(path, "sebody.fem") == {"a.b", "sebody.fem.c", "sebody.fem.d.e", "sebody.f.g",
                                            "i.j"}


@pytest.mark.parametrize("path, package", modules("derive", "sebody.derive"))
def test_derivation_uses_leaf_functions_only(path, package):
    allowed = {"sebody.derive", "sebody.kernels"} | (MAIN_ONLY if path.stem == "__main__"
                                                     else set())
    for name in imported(path, package):
        top = name.split(".")[0]
        if top == "sebody":
            assert within(name, allowed), f"{path} imports {name}"
        else:
            assert top in {"sympy", "mpmath"} or top in sys.stdlib_module_names, name


@pytest.mark.parametrize("path, package", modules("sebody", "sebody")
                         + modules("examples", "sebody.scenes"))
def test_runtime_knows_no_derivation(path, package):
    for name in imported(path, package):
        assert not within(name, {"sebody.derive", "derive", "generated", "sympy", "mpmath"})
        assert path.stem in PICTURES or not within(name, {"matplotlib"})


@pytest.mark.parametrize("path, package", modules("generated", "sebody.generated"))
def test_kernels_use_leaf_functions_only(path, package):
    for name in imported(path, package):
        assert within(name, LEAVES | {"numba", "numpy", "math"}), name


def test_sympy_is_not_loaded():
    code = ("import sys, sebody, sebody.cli.main, sebody.scenes.hinged_beam\n"
            "print(sorted({'sympy', 'matplotlib', 'sebody.derive'} & set(sys.modules)))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
