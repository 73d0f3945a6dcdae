"""The workflow of changing a formula, rehearsed in copies of the tree.

A copy has the folders as they are installed, sebody/derive inside sebody and so on, is the only
one a new process finds, and ships few small kernels, so that a derivation takes seconds.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = {"sebody": "", "derive": "derive", "generated": "generated", "examples": "scenes"}
MANIFEST = '''"""A small manifest."""

SUPERELEMENTS = (("planar-f2", "converged_mean", "b"),)
ELEMENTS = ("force", "torque", "planar_force", "planar_torque")
'''
SHIPPED = ["element_force.py", "element_planar_force.py", "element_planar_torque.py",
           "element_torque.py", "superelement_planar_f2_converged_mean_b.py"]

# An editable installation would serve what a copy lacks from the checkout.
ISOLATED = '''
import runpy
import sys

sys.meta_path[:] = [f for f in sys.meta_path if "editable" not in getattr(f, "__module__", "")]
'''
DERIVE = 'runpy.run_module("sebody.derive", run_name="__main__", alter_sys=True)'
# Residuals of two kernels, called through their addresses: the time loop need not be compiled.
DRIVER = '''
import ctypes
import numpy as np
from sebody import Model
from sebody.assembly import build
from sebody.fem import Section, planar_beam
from sebody.reduction import craig_bampton

section = Section(area=1.0, inertia_y=1.0, inertia_z=1.0, torsion=1.0, youngs_modulus=1e3,
                  poisson_ratio=0.3, density=1.0)
count = int(sys.argv[1])
fe_model = planar_beam((0, 0), (10, 0), section, 4)
kept = np.linspace(0, 4, count).round().astype(int)
body = craig_bampton(fe_model, [(int(k), "full") for k in kept], 0)
model = Model(planar=True)
nodes = [model.node(f"n{k}", fe_model.coordinates[k, :2]) for k in kept]
model.superelement("beam", body, nodes)
model.force(nodes[-1], (0.0, 1.0))
system, numbering = build(model)
q = np.zeros(numbering.total)
for n in nodes:
    first = numbering.triplets[id(n.position)]
    q[first:first + 2] = n.point
q[first] += 0.1         # stretched
g, J, work, energy = np.zeros(99), np.zeros(999), np.zeros(9999), np.zeros(10)
call = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_int64] * 4, *[ctypes.c_void_p] * 15)
R, v, a, reference, frames, T = np.zeros((6, 9 * numbering.total))
loads, coefficients = np.array([3.0, 0.0, 0.0]), np.zeros(8)
for k, address in enumerate(system.address):
    arrays = (system.index[system.at_index[k]:], system.constants, q, R, v, a, reference, frames,
              T, loads, coefficients, g, J, work, energy)
    status = call(int(address))(0, 1, int(system.stride[k]), int(system.width[k]),
                                *[x.ctypes.data for x in arrays])
    print(status, *g[:system.width[k]].round(9))
'''


def python(tree: Path, code: str, *arguments: str, **variables: str):
    """Run code on a copy, in a process that knows no other one."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "SEBODY_KERNELS": "", **variables}
    return subprocess.run([sys.executable, "-c", ISOLATED + code, *arguments], cwd=tree,
                          env=environment, text=True, capture_output=True, timeout=200)


def derive(tree: Path, *arguments: str, **variables: str):
    """``python -m sebody.derive`` on a copy."""
    return python(tree, DERIVE, *arguments, **variables)


def residuals(tree: Path, nodes: int = 2, **variables: str) -> list[list[float]]:
    """Residuals of a stretched planar beam and of a force of 3 along y on its end."""
    done = python(tree, DRIVER, str(nodes), **variables)
    assert done.returncode == 0, done.stderr
    return [[float(x) for x in line.split()[1:]] for line in done.stdout.splitlines()]


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text, f"{path.name} has changed: adapt this test"
    path.write_text(text.replace(old, new))


def duplicate(tree: Path, target: Path) -> Path:
    return shutil.copytree(tree, target / "tree", ignore=shutil.ignore_patterns("*.tmp*"))


@pytest.fixture(scope="module")
def original(tmp_path_factory) -> Path:
    """A copy of the tree with the small manifest and its kernels compiled; not to be changed."""
    tree = tmp_path_factory.mktemp("original")
    for source, target in FOLDERS.items():
        shutil.copytree(ROOT / source, tree / "sebody" / target, dirs_exist_ok=True,
                        ignore=shutil.ignore_patterns("__pycache__"))
    (tree / "sebody" / "derive" / "manifest.py").write_text(MANIFEST)
    for path in (tree / "sebody" / "generated").glob("*_*.py"):
        if path.name not in (*SHIPPED, "__init__.py"):
            path.unlink()
    assert residuals(tree) == [[-10.0, 0.0, 10.0, 0.0, 0.0, 0.0], [0.0, -3.0]]
    return tree


@pytest.mark.parametrize("seed", ["1", "2"])
def test_text_is_the_same_for_every_hash_seed(original, seed):
    done = derive(original, "--check", PYTHONHASHSEED=seed)
    assert (done.returncode, done.stdout) == (0, "5 kernels are up to date\n"), done.stderr


def test_change_a_formula_and_a_leaf(original, tmp_path):
    tree = duplicate(original, tmp_path)
    package = tree / "sebody"
    edit(package / "derive" / "forces.py", "load=AMPLITUDE[0] * direction.dot(x.",
         "load=2 * AMPLITUDE[0] * direction.dot(x.")
    edit(package / "dense.py", "_store(builder, result, out, row)",
         "_store(builder, builder.fadd(result, result), out, row)")
    done = derive(tree, "--check")
    assert done.returncode == 1
    changed = ["element_force.py", "element_planar_force.py",
               "superelement_planar_f2_converged_mean_b.py"]
    stale = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("stale:")]
    assert sorted(stale) == changed
    assert "-        g[1] = -amplitude*d_y" in done.stdout      # the diff shows the formula
    assert '-    "_columns_times": ' in done.stdout          # and the leaf
    untouched = (package / "generated" / "element_torque.py").stat().st_mtime_ns
    done = derive(tree)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("5 kernels derived, 3 written")
    assert (package / "generated" / "element_torque.py").stat().st_mtime_ns == untouched
    assert residuals(tree) == [[-20.0, 0.0, 20.0, 0.0, 0.0, 0.0], [0.0, -6.0]]
    assert derive(tree, "--check").returncode == 0


def test_missing_and_orphaned_files_are_reported(original, tmp_path):
    tree = duplicate(original, tmp_path)
    generated = tree / "sebody" / "generated"
    (generated / "element_force.py").rename(generated / "element_spring.py")
    done = derive(tree, "--check")
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        "missing: element_force.py (run python -m sebody.derive)",
        "orphaned: element_spring.py is not in derive/manifest.py: add it or delete it"]


def test_a_layout_that_cannot_be_read(original):
    done = derive(original, "nonsense")
    assert done.returncode == 2
    assert done.stderr.startswith("error: layout 'nonsense' is unknown: write counts of full, ")


def test_a_layout_is_added_to_the_directory_of_the_user(original, tmp_path):
    mine = {"SEBODY_KERNELS": str(tmp_path / "mine")}
    before = python(original, DRIVER, "3", **mine)
    assert before.returncode == 1
    assert "there is no kernel for layout 'planar-f3'" in before.stderr
    command = "python -m sebody.derive planar-f3:converged_mean:b"
    assert command in before.stderr
    done = derive(original, command.split()[-1], **mine)
    assert done.returncode == 0, done.stderr
    assert f"1 written to {mine['SEBODY_KERNELS']}" in done.stdout
    beam, force = residuals(original, nodes=3, **mine)
    assert beam == pytest.approx([0, 0, -20, 0, 20, 0, 0, 0, 0], abs=1e-9)
    assert force == [0.0, -3.0]
    assert derive(original, "--check").returncode == 0      # the package is as it was
