"""The workflow of changing a formula or a compiled function, rehearsed in copies of the tree.

A copy ships few small kernels, so that a derivation takes seconds, see `copies`. What is compiled
lies beside the sources, so that a copy begins with that of the original.
"""

from pathlib import Path

import pytest
from copies import ROOT, copy_sources, derive, duplicate, edit, python

from sebody.compiler.sources import TEXT, folder_hash
from sebody.derive.compiler import compile_kernel

MANIFEST = '''"""A small manifest."""

SUPERELEMENTS = (("planar-f2", "positions", "material"),)
ELEMENTS = ("force", "torque", "planar_force", "planar_torque", "motion_planar_positions")
PRODUCTS = ("force",)
'''
SHIPPED = ["element_force.py", "element_planar_force.py", "element_planar_torque.py",
           "element_torque.py", "motion_planar_positions.py", "products_element_force.py",
           "superelement_planar_f2_positions_material.py"]

# Residuals of two kernels, called through their addresses: the time loop need not be compiled.
DRIVER = '''
import ctypes
import numpy as np
from sebody import Model
from sebody.assembly.build import build
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
model.superelement("beam", body, nodes, frame="positions", inertia="material")
model.force(nodes[-1], (0.0, 1.0))
system, numbering = build(model)
q = np.zeros(numbering.total)
for n in nodes:
    first = numbering.dof_blocks[n.position]
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

# Compiled functions of the runtime, called one by one.
CALLS = '''
from dataclasses import dataclass
from math import cos, sin
import numpy as np
from numba import njit
from sebody.engine.arrays import Arrays
from sebody.engine.elimination import eliminate
from sebody.engine.scalars import record
from sebody.engine.clock import CLOCK, CONTROL
from sebody.engine.step import cut_step
from sebody.kernels.abi import at, padded, pointer_to
from sebody.kernels.frame_search import converged_mean, planar_relative_angles

def turned_by(angle):
    return [cos(angle), -sin(angle), 0.0, sin(angle), cos(angle), 0.0, 0.0, 0.0, 1.0]

def search():
    """Angles of three nodes against their mean, found by logarithms of relative rotations."""
    R, psi = np.ravel([turned_by(a) for a in (0.0, 0.2, 0.7)]), np.zeros(9)
    found = converged_mean(3, np.arange(3), np.full(3, 1 / 3), R, np.eye(3).ravel(), psi)
    return found, *psi[2::3].round(6)

def near_half_a_turn():
    """Whether an angle of 1.5 is refused."""
    return planar_relative_angles(1, np.array([1.5]), np.eye(3).ravel(), np.zeros(1)),

@njit
def factors(starts, rows, diagonal, unknowns, matrix, column, scale):
    return eliminate(0, 2, False, pointer_to(starts), pointer_to(rows), pointer_to(diagonal),
                     at(pointer_to(starts), 1), pointer_to(unknowns), pointer_to(matrix),
                     pointer_to(column), pointer_to(scale))

def elimination():
    """The last inverted pivot of [[2, 1], [1, 2]]; each number stands for a diagonal block."""
    matrix = np.concatenate([k * np.eye(4).ravel() for k in (2.0, 1.0, 1.0, 2.0)])
    factors(np.array([0, 2, 4]), np.array([0, 1, 0, 1]), np.array([0, 3]), np.arange(8), matrix,
            np.zeros(32), np.ones(8))
    return matrix[48].round(6),

@dataclass(frozen=True, eq=False)
class Clock(Arrays):
    clock: np.record
    control: np.record

def cut():
    """Whether a step may be cut twice."""
    state = Clock(record(CLOCK, np.ones(len(CLOCK.names))), record(CONTROL))
    return cut_step(state), cut_step(state)

print(*globals()[sys.argv[1]]() if sys.argv[1] != "column" else [padded(3)])
'''


def residuals(tree: Path, nodes: int = 2, **variables: str) -> list[list[float]]:
    """Residuals of a stretched planar beam and of a force of 3 along y on its end."""
    done = python(tree, DRIVER, str(nodes), **variables)
    assert done.returncode == 0, done.stderr
    return [[float(x) for x in line.split()[1:]] for line in done.stdout.splitlines()]


def call(tree: Path, name: str) -> str:
    """What one of `CALLS` gives."""
    done = python(tree, CALLS, name)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.fixture(scope="module")
def original(tmp_path_factory) -> Path:
    """A copy of the tree with the small manifest and its kernels compiled; not to be changed."""
    tree = tmp_path_factory.mktemp("original")
    copy_sources(tree, "__pycache__")
    (tree / "sebody" / "derive" / "kernels" / "manifest.py").write_text(MANIFEST)
    for path in (tree / "sebody" / "generated").glob("*_*.py"):
        if path.name not in (*SHIPPED, "__init__.py"):
            path.unlink()
    assert residuals(tree) == [[-10.0, 0.0, 10.0, 0.0, 0.0, 0.0], [0.0, -3.0]]
    return tree


@pytest.mark.parametrize("seed", ["1", "2"])
def test_text_is_the_same_for_every_hash_seed(original, seed):
    done = derive(original, "--check", PYTHONHASHSEED=seed)
    assert (done.returncode, done.stdout) == (0, "7 kernels are up to date\n"), done.stderr


def stale(tree: Path) -> list[str]:
    """Files that ``--check`` finds outdated."""
    done = derive(tree, "--check")
    found = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("stale:")]
    assert done.returncode == bool(found), done.stderr
    return sorted(found)


def test_change_a_formula(original, tmp_path):
    tree = duplicate(original, tmp_path)
    package = tree / "sebody"
    edit(package / "derive" / "formulas" / "forces.py", "load=AMPLITUDE[0] * direction.dot(x.",
         "load=2 * AMPLITUDE[0] * direction.dot(x.")
    assert stale(tree) == ["element_force.py", "element_planar_force.py",
                           "products_element_force.py"]
    assert "-        g[1] = -amplitude*d_y" in derive(tree, "--check").stdout
    untouched = (package / "generated" / "element_torque.py").stat().st_mtime_ns
    done = derive(tree)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("7 kernels derived, 3 written")
    assert (package / "generated" / "element_torque.py").stat().st_mtime_ns == untouched
    assert residuals(tree) == [[-10.0, 0.0, 10.0, 0.0, 0.0, 0.0], [0.0, -6.0]]
    assert stale(tree) == []


def test_change_a_function_that_a_kernel_reaches_through_another(original, tmp_path):
    """Both nodes seem turned by 0.01 more: as a beam bent by end moments 6 EI / l times that."""
    tree = duplicate(original, tmp_path)
    edit(tree / "sebody" / "kernels" / "frame_search.py", "return angle - 2.0 * math.pi",
         "return 0.01 + angle - 2.0 * math.pi")
    bent, push = residuals(tree)        # without deriving anything
    assert bent[4] == pytest.approx(6 * 1e3 / 10 * 0.01, rel=0.02)
    assert push == [0.0, -3.0]
    assert stale(tree) == []            # what is compiled is new, not the text


@pytest.mark.parametrize("file, old, new, name, before, after", [
    # half of every angle: the search reaches it through relative_rotations and relative_log
    ("kernels/rotations.py", "return ratio * x, ratio * y, ratio * z, cosine",
     "return ratio * x, ratio * y, 0.5 * ratio * z, cosine",
     "search", "0 -0.3 -0.1 0.4", "0 -0.15 -0.05 0.2"),
    # compiled into the elimination: 1/(2 - 1/2), and with all products doubled 1/(2 (2 - 1))
    ("kernels/blocks.py", "store_vector(builder, total, C, WORD(LANES * j))",
     "store_vector(builder, builder.fadd(total, total), C, WORD(LANES * j))",
     "elimination", "0.666667", "0.5"),
    # constants of other files
    ("kernels/rotations.py", "NEAR_PI = -0.98", "NEAR_PI = 0.98", "near_half_a_turn", "0", "1"),
    ("contract/counts.py", "LANES = 4 ", "LANES = 8 ", "column", "4", "8"),
    ("engine/state.py", "FINEST = 4096 ", "FINEST = 2 ", "cut", "True True", "True False"),
], ids=["log_map", "subtract_product", "NEAR_PI", "LANES", "FINEST"])
def test_compiled_functions_follow_what_they_call(original, tmp_path, file, old, new, name, before,
                                                  after):
    assert call(original, name) == before
    tree = duplicate(original, tmp_path)
    edit(tree / "sebody" / file, old, new)
    assert call(tree, name) == after


def test_shipped_kernels_name_no_version_of_the_runtime():
    """Only those that are kept elsewhere do, where nothing else says that they are outdated."""
    texts = [path.read_text() for path in (ROOT / "generated").glob("*_*.py")]
    assert len(texts) > 70 and not any("SOURCES" in text for text in texts)
    assert f'SOURCES = "{folder_hash(*TEXT)}"' in compile_kernel("planar_force", shipped=False)


def test_one_kernel_of_the_catalogue(original, tmp_path):
    """Where its formula has changed it is written, and nothing else is derived or written."""
    tree = duplicate(original, tmp_path)
    generated = tree / "sebody" / "generated"
    edit(tree / "sebody" / "derive" / "formulas" / "forces.py",
         "load=AMPLITUDE[0] * direction.dot(x.", "load=2 * AMPLITUDE[0] * direction.dot(x.")
    (generated / "element_torque.py").unlink()
    done = derive(tree, "planar_force")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("1 kernel derived, 1 written to ")
    assert residuals(tree)[1] == [0.0, -6.0]
    assert stale(tree) == ["element_force.py", "products_element_force.py"]
    assert not (generated / "element_torque.py").exists()
    done = derive(tree, "planar_forse")
    assert done.returncode == 2
    assert done.stderr == ("error: there is no kernel 'planar_forse' in the catalogue: is it "
                           "planar_force or planar_torque?\n")


def test_an_element_in_the_directory_of_the_user(original, tmp_path):
    """It is found there, and after an upgrade refused with the command that makes it again."""
    mine = {"SEBODY_KERNELS": str(tmp_path / "mine")}
    tree = duplicate(original, tmp_path)
    (tree / "sebody" / "generated" / "element_planar_force.py").unlink()
    assert derive(tree, "planar_force", **mine).returncode == 0
    assert residuals(tree, **mine)[1] == [0.0, -3.0]
    edit(tree / "sebody" / "kernels" / "rotations.py", "NEAR_PI = -0.98", "NEAR_PI = -0.97")
    refused = python(tree, DRIVER, "2", **mine)
    assert "made by another version of sebody: make it again with\n    python -m sebody.derive " \
           "planar_force" in refused.stderr


def test_comments_and_docstrings_compile_nothing(original, tmp_path):
    tree = duplicate(original, tmp_path)
    residuals(tree)
    call(tree, "search")
    compiled = {path: path.stat().st_mtime_ns for path in tree.rglob("*.sebody")}
    assert {path.name.split(".")[1] for path in compiled} >= {"kernel", "converged_mean", "log_map"}
    edit(tree / "sebody" / "kernels" / "rotations.py", '"""Rotation vector of a rotation matrix',
         '"""A vector. Rotation vector of a rotation matrix')
    edit(tree / "sebody" / "kernels" / "frame_search.py", "@compiled\ndef converged_mean",
         "\n# a remark\n@compiled\ndef converged_mean")
    assert residuals(tree) == residuals(original)
    assert call(tree, "search") == call(original, "search")
    assert {path: path.stat().st_mtime_ns for path in tree.rglob("*.sebody")} == compiled
    assert stale(tree) == []


def test_missing_and_orphaned_files_are_reported(original, tmp_path):
    tree = duplicate(original, tmp_path)
    generated = tree / "sebody" / "generated"
    (generated / "element_force.py").rename(generated / "element_spring.py")
    done = derive(tree, "--check")
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        "missing: element_force.py (run python -m sebody.derive)",
        "orphaned: element_spring.py is not in derive/kernels/manifest.py: add it or delete it"]


def test_a_layout_that_cannot_be_read(original):
    done = derive(original, "nonsense")
    assert done.returncode == 2
    assert done.stderr.startswith("error: layout 'nonsense' is unknown: write counts of full, ")


def test_a_layout_is_added_to_the_directory_of_the_user(original, tmp_path):
    mine = {"SEBODY_KERNELS": str(tmp_path / "mine")}
    before = python(original, DRIVER, "3", **mine)
    assert before.returncode == 1
    assert "there is no kernel for layout 'planar-f3'" in before.stderr
    command = "python -m sebody.derive planar-f3:positions:material"
    assert command in before.stderr
    done = derive(original, command.split()[-1], **mine)
    assert done.returncode == 0, done.stderr
    assert f"1 written to {mine['SEBODY_KERNELS']}" in done.stdout
    beam, force = residuals(original, nodes=3, **mine)
    assert beam == pytest.approx([0, 0, -20, 0, 20, 0, 0, 0, 0], abs=1e-9)
    assert force == [0.0, -3.0]
    assert stale(original) == []        # the package is as it was

    changed = duplicate(original, tmp_path)     # an upgrade
    edit(changed / "sebody" / "kernels" / "rotations.py", "NEAR_PI = -0.98", "NEAR_PI = -0.97")
    refused = python(changed, DRIVER, "3", **mine)
    assert refused.returncode == 1
    assert "was made by another version of sebody: make it again with\n    " + command in (
        refused.stderr)
    assert derive(changed, command.split()[-1], **mine).returncode == 0
    assert residuals(changed, nodes=3, **mine) == [beam, force]
