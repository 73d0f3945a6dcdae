"""What steers the derivation: declarations and roles, never titles or names; folders one way."""

import ast
import re
from itertools import count
from pathlib import Path

import pytest
import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.compiler import Variant, compile_kernel, file_name, statements_of
from sebody.derive.form import steps
from sebody.derive.form.arrays import constant, scratch
from sebody.derive.formulas.frames import converged_mean
from sebody.derive.formulas.inertia import option_b
from sebody.derive.kernels import catalogue, linearize, options, superelement

ROOT = Path(__file__).parents[2]
# each imports from those before it
FOLDERS = ("symbolic", "form", "passes", "formulas", "kernels", "printing")
FILES = sorted((ROOT / "derive").rglob("*.py"))


def rank(name: str) -> int:
    """Place of a module of derive in the order; the compiler and the command come last."""
    parts = name.removeprefix("sebody.derive").strip(".").split(".")
    return FOLDERS.index(parts[0]) if parts[0] in FOLDERS else len(FOLDERS)


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_folders_import_one_way(path):
    own = rank(".".join(path.relative_to(ROOT / "derive").with_suffix("").parts))
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module.startswith("sebody.derive"):
            assert rank(node.module) <= own, f"{path.name} imports {node.module}"


def test_the_order_has_all_folders():
    found = {p.relative_to(ROOT / "derive").parts[0] for p in FILES if p.parent.name != "derive"}
    assert found == set(FOLDERS)


@pytest.fixture
def fresh():
    """No derivation remembered, before and after."""
    remembered = superelement.node_formulas, linearize.node_tangent
    for function in remembered:
        function.cache_clear()
    yield
    for function in remembered:
        function.cache_clear()


def code(text: str) -> str:
    """Text of a kernel without its comments."""
    return "\n".join(line for line in text.splitlines() if not line.strip().startswith("#"))


@pytest.mark.parametrize("variant", [
    Variant("planar-f2d", "converged_mean", "frame_axes"), Variant("planar-f2", "positions",
                                                                   "material")])
def test_titles_are_comments(variant, monkeypatch, fresh):
    """With every title reworded a kernel differs in its comments alone."""
    before = compile_kernel(variant)
    for function in (superelement.node_formulas, linearize.node_tangent):
        function.cache_clear()
    number = count()
    for kind in (steps.Stage, steps.Product, steps.Solve, steps.Search, steps.Values, steps.Shift,
                 steps.Scaling, steps.Damping):
        def reworded(cls, title, *rest, make=kind.__new__, **named):
            return make(cls, f"reworded {next(number)}", *rest, **named)
        monkeypatch.setattr(kind, "__new__", reworded)
    after = compile_kernel(variant)
    assert after.count("# reworded") > 20
    assert before != after and code(before) == code(after)


def weighted(q):
    """Option B with a mass of its own at every node, for a test."""
    exact = option_b.option_b(q)
    extra = q.space.quantity("extra", "scalar", "position", constant(EXTRAS)).symbols[0]
    return exact._replace(position=exact.position + extra * q.acc.symbols)


EXTRAS = Part("extras", ("N_POSITIONS",), "masses added to the nodes")


def test_an_inertia_option_declares_its_constants(monkeypatch):
    """They get into the table, behind the others, and the formulas find them there."""
    toy = option_b.INERTIA._replace(
        traits=option_b.INERTIA.traits._replace(constants=(EXTRAS,)), derive=weighted)
    monkeypatch.setitem(options.INERTIA_OPTIONS, "toy", toy)
    text = compile_kernel(Variant("planar-f2d", "converged_mean", "toy"))
    assert ('CONSTANTS = SUPERELEMENT_CONSTANTS + DAMPING_CONSTANTS + (\n'
            '    Part("extras", ("N_POSITIONS",), "masses added to the nodes"),\n)\n') in text
    assert "        C = at(masses, 1)\n        extras = at(C, n*padded(n))\n" in text
    assert "            extra = extras[i]\n" in text
    assert "extras = at(work" not in text           # no scratch row
    ast.parse(text)


def test_a_frame_declares_its_constants_and_scratch_rows(monkeypatch):
    """A quantity in an array of its own gets a row of scratch memory, and so does its rate."""
    def derive(q):
        frame = converged_mean.converged_mean(q)
        trace = q.space.quantity("trace", "scalar", "rotation", scratch("traces"))
        extra = q.space.quantity("extra", "scalar", "position", constant(EXTRAS)).symbols[0]
        stored = steps.Stage("kept", "rotation", sets=((trace, sp.Matrix([q.psi.symbols[2]])),))
        return frame._replace(locate=(*frame.locate, stored), position=extra * q.x.symbols)
    toy = converged_mean.FRAME._replace(
        traits=converged_mean.FRAME.traits._replace(constants=(EXTRAS,)), derive=derive)
    monkeypatch.setitem(options.FRAMES, "toy", toy)
    made, usual = (statements_of(Variant("planar-f2", frame, "material"))
                   for frame in ("toy", "converged_mean"))
    assert made.rows == usual.rows + 1
    text = compile_kernel(Variant("planar-f2", "toy", "material"))
    assert "        extras = at(masses, 1)\n" in text
    assert re.search(r"^        traces = at\(work, \d+\*row\)$", text, re.M)
    assert f"WORK_ROWS = {made.rows}\n" in text


@pytest.mark.parametrize("variant, name", [
    (Variant("planar-f2", "mean", "frame_axes"), "superelement_planar_f2_mean_frame_axes.py"),
    ("distance", "element_distance.py")])
def test_file_names(variant, name):
    assert file_name(variant) == name


@pytest.mark.parametrize("name", [*catalogue.SMOOTH_ALONG_PATHS, *catalogue.LAWS_ALONG_PATHS])
def test_what_acts_along_paths_stands_on_the_way_alone(name):
    """The tables of the catalogue say what their elements are."""
    given = catalogue.ELEMENTS[name]()
    assert [block.state.kind for block in given.blocks] == ["scalar"]


@pytest.mark.parametrize("layout", ["f2", "planar-f2d", "f2t1"])
def test_no_scratch_row_is_idle(layout):
    """Every row is read or written by the steps, and every array of the steps is somewhere."""
    frame = "positions" if layout == "f2t1" else "converged_mean"
    path = ROOT / "generated" / f"superelement_{layout.replace('-', '_')}_{frame}_material.py"
    tree = ast.parse(path.read_text())
    used = [node.id for node in ast.walk(tree) if isinstance(node, ast.Name)]
    rows = re.findall(r"^ +(\w+) = (?:at\(work|work$)", path.read_text(), re.M)
    assert rows and all(used.count(row) > 1 for row in rows)


# what cuts text, or asks what is in it
CUTTING = {"split", "rsplit", "splitlines", "partition", "rpartition", "replace", "startswith",
           "endswith", "find", "rfind", "strip", "lstrip", "rstrip", "removeprefix",
           "removesuffix", "isupper", "islower", "isdigit", "isalpha", "isidentifier", "upper",
           "lower", "translate", "fullmatch", "findall"}
READING = {"re", "ast", "tokenize", "string"}       # modules that read text
# what users type is read, and lines of text are divided: nothing is decided by that in a kernel
TEXTS = {"names.py", "kernels/layouts.py", "__main__.py", "printing/lines.py"}


def cuts(tree: ast.AST) -> list[str]:
    """What a module does to text beyond putting it together."""
    found = []
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Attribute(attr=name)) if name in CUTTING:
                found.append(f"line {node.lineno}: .{name}()")
            case ast.Subscript(value=ast.Call(func=ast.Name(id="str" | "repr"))):
                found.append(f"line {node.lineno}: part of a text")
            case ast.Compare(left=ast.Constant(value=str()), ops=[ast.In() | ast.NotIn()]):
                found.append(f"line {node.lineno}: search in a text")
            case ast.Import() | ast.ImportFrom():
                names = [a.name for a in node.names] + [getattr(node, "module", "")]
                found += [f"imports {name}" for name in names if name in READING]
            case ast.Call(func=ast.Name(id="eval" | "exec")):
                found.append(f"line {node.lineno}: executes text")
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_text_is_parsed_searched_or_cut(path):
    """Decisions are made by types: what a step reads and writes is in its operands."""
    if path.relative_to(ROOT / "derive").as_posix() not in TEXTS:
        assert cuts(ast.parse(path.read_text())) == []


@pytest.mark.parametrize("text", [
    "a.split('(')[-1]", "line.startswith('#')", "', filled)' in line", "str(symbol)[-1]",
    "import re", "from ast import parse", "index.removesuffix(' + 0')", "eval('1')"])
def test_what_cuts_text_is_found(text):
    assert len(cuts(ast.parse(text))) >= 1
