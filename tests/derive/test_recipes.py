"""Recipes and the tutorial on formulas followed in copies of the tree; what was added is used."""

from pathlib import Path

import numpy as np
import pytest
from copies import DERIVE, ROOT, copy_sources, derive, duplicate
from pages import commands
from recipes import apply, blocks, copy_tests, recipe, run, run_tests, sebody
from scipy.integrate import quad

from sebody import Model, Result, simulate


@pytest.fixture(scope="module")
def original(tmp_path_factory) -> Path:
    """A copy of the tree with what is compiled; not to be changed.

    The loop is compiled before, where these tests are run first.
    """
    model = Model(planar=True)
    model.rigid_body("body", model.node("node", (0.0, 0.0)), 1.0, 1.0)
    simulate(model, 0.1, 0.1)
    tree = copy_sources(tmp_path_factory.mktemp("original"), "*.pyc", "*.part")
    copy_tests(tree)
    return tree


def followed(original: Path, tmp_path: Path, title: str) -> Path:
    """A copy in which a recipe was followed."""
    tree = duplicate(original, tmp_path)
    apply(tree, recipe(title))
    return tree


def test_joint(original, tmp_path):
    """Its tests are those of the recipe; without a planar form or a picture they fail."""
    tree = followed(original, tmp_path, "A joint")
    run(tree, DERIVE, "cord", "planar_cord")
    assert "of 2 kernels hold" in sebody(tree, "check", "element_cord", "element_planar_cord")
    run_tests(tree, "tests/model/test_cord.py", "tests/malformed/test_complete.py",
              "tests/malformed/test_builders.py", "-k", "cord or complete")


def test_frame(original, tmp_path):
    tree = followed(original, tmp_path, "A frame")
    kernel = "superelement_planar_any_secant_floating_field"
    run(tree, DERIVE, "planar-any:secant:floating_field")
    assert "of 2 kernels hold" in sebody(tree, "check", kernel, "motion_planar_secant")
    run_tests(tree, "tests/model/test_secant_frame.py")


def test_inertia_option(original, tmp_path):
    """Forces against energies and matrix, in space: in a plane all axes of rotation are one."""
    tree = followed(original, tmp_path, "An inertia option")
    run(tree, DERIVE, "f2:converged_mean:half_way")
    assert "of 1 kernel hold" in sebody(tree, "check", "superelement_f2_converged_mean_half_way")


def test_quantity(original, tmp_path):
    """One formula and one row, for every reader."""
    tree = followed(original, tmp_path, "A quantity")
    run_tests(tree, "tests/quantities/test_outward.py")


def test_file_source(original, tmp_path):
    tree = followed(original, tmp_path, "A file source")
    run_tests(tree, "tests/io/test_matlab.py")


def test_command(original, tmp_path):
    tree = followed(original, tmp_path, "A command")
    said = sebody(tree, "mass", "four-bar", "--set", "loops=2")
    *bodies, total = [line.split() for line in said.splitlines()]
    assert total[0] == "total" and len(bodies) > 2
    assert float(total[1]) == pytest.approx(sum(float(row[-1]) for row in bodies), rel=1e-5)


def test_tutorial(original, tmp_path):
    """Its commands in their order; the period is that of the energy, by quadrature."""
    text = (ROOT / ".docs" / "tutorials" / "3_formula.md").read_text()
    tree = duplicate(original, tmp_path)
    apply(tree, blocks(text))
    check, derived, *ours, undo = commands(text)
    assert check[:4] == ["python", "-m", "sebody.derive", "--check"] and undo[0] == "git"
    stale = derive(tree, *check[3:])
    assert stale.returncode == 1 and "stale: element_planar_spring.py" in stale.stdout
    run(tree, DERIVE, *derived[3:])
    said = [sebody(tree, *command[1:]) for command in ours]
    assert "of 1 kernel hold" in said[0] and "picture: chart.png" in said[2]
    result = Result.load(tree / "spring.npz")
    u = result["mass.position.x"] - 2.0
    quarter = np.interp(0.0, -u[:len(u) // 2], result.t[:len(u) // 2])
    exact = 4 * np.sqrt(3) * quad(lambda z: 1 / np.sqrt(1 - z**6), 0, 1)[0]
    assert 4 * quarter == pytest.approx(exact, rel=2e-3)       # of the step, 420 in a period
    assert f"{exact:.2f}" in text


def test_every_recipe_is_followed_here():
    text = (ROOT / ".github" / "CONTRIBUTING.md").read_text()
    titles = [line[3:] for line in text.splitlines() if line.startswith("## ")]
    assert titles == ["A joint", "A frame", "An inertia option", "A quantity",
                      "A file source", "A command"]
