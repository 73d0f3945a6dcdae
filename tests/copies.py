"""Copies of the tree, in which tests change the sources as a developer would.

A copy has the folders as they are installed, sebody/derive inside sebody and so on, and is the only
one a new process finds.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = {"sebody": "", "derive": "derive", "generated": "generated", "examples": "scenes"}

# An editable installation would serve what a copy lacks from the checkout.
ISOLATED = '''
import runpy
import sys

sys.meta_path[:] = [f for f in sys.meta_path if "editable" not in getattr(f, "__module__", "")]
'''
DERIVE = 'runpy.run_module("sebody.derive", run_name="__main__", alter_sys=True)'


def copy_sources(tree: Path, *ignored: str) -> Path:
    """Copy the package into a folder, without what matches the patterns."""
    for source, target in FOLDERS.items():
        shutil.copytree(ROOT / source, tree / "sebody" / target, dirs_exist_ok=True,
                        ignore=shutil.ignore_patterns(*ignored))
    return tree


def python(tree: Path, code: str, *arguments: str, **variables: str):
    """Run code on a copy, in a process that knows no other one."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "SEBODY_KERNELS": "",
                   "NUMBA_CACHE_DIR": "", "HOME": str(tree), **variables}
    return subprocess.run([sys.executable, "-c", ISOLATED + code, *arguments], cwd=tree,
                          env=environment, text=True, capture_output=True, timeout=200)


def derive(tree: Path, *arguments: str, **variables: str):
    """``python -m sebody.derive`` on a copy."""
    return python(tree, DERIVE, *arguments, **variables)


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text, f"{path.name} has changed: adapt this test"
    path.write_text(text.replace(old, new))


def duplicate(tree: Path, target: Path) -> Path:
    return shutil.copytree(tree, target / "tree", ignore=shutil.ignore_patterns("*.part"))
