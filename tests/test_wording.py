"""Retired phrases of pages, messages, help texts and docstrings do not come back.

One term for each thing, the one that the field uses: the table has, for each phrase that readers
stumbled over, what is written in its place.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = ("sebody", "derive", "generated", "examples")
# texts of advice are judged with that folder's own tests
APART = ()

RETIRED = {     # a regular expression: what is written instead
    r"histor(y|ies) of (a |the )?(load|drive)s?": "time function",
    r"\bload histor(y|ies)|\bready histor(y|ies)|\bpiecewise history": "time function",
    r"\bcut steps?\b|\bsteps? (is|are|was|were) cut\b|\bstep cut to\b|\(\d+ cut\)":
        "rejected steps",
    r"\brichest\b": "reference model",
    r"\bdead (or follower|load|force|torque)|, dead or": "fixed-direction or follower",
    r"(turn|rotat)\w* by [^.;:]{1,60} against (it|its|the frame)":
        "rotates by ... relative to the body frame",
    r"rotated by [^.;:]{1,60} against": "rotated by ... relative to its body frame",
    r"\b(model's|body's) extent\b|\bextent of (the|a) (model|body)\b|\bof the extent\b":
        "characteristic length",
    r"\b(quarter|third|half|tenth) too (little|much|small|large)\b": "25 % too small",
    r"where methods fail|in which methods fail": "known limits",
    r"prediction of theory, measurement": "theory, measured value, how sebody reacts",
    r"\bfirst (one )?left out\b": "first omitted mode",
    r"\bmodes left out\b": "omitted modes",
    r"\biterate is not finite": "the solution diverged",
    r"\bnothing (holds|ties) (it|them|one|bodies|body|a body)\b|\bthat nothing (holds|ties)\b":
        "is not connected to anything",
    r"\bbelongs? to no body, so\b": "is not connected to anything",
    r"\btyped in\b|\bnobody types\b": "generated symbolically, not hand-coded",
    r"\bto read on\b": "further reading",
    r"\b(complex|static|steady) answers?\b": "response",
    r"\banswers of any quantit": "frequency response",
    r"\brates? of growth\b": "real parts of eigenvalues",
    r"\b(which|that) there is not\b": "which does not exist",
    r"\bis none of a body\b": "is not a mechanical DOF",
    r"\bhangs on another node\b": "follows another node",
    r"\bnodes [^.;:]{1,40} start (apart|together)\b": "do not coincide, coincide",
    r"\b(header|mapping|deck)[^.;:]{0,20} tells( of)?\b|\btells of (a|\.\.\.)": "says, lists",
    r"\bstrain tell of\b|\btells? (the|a) (full|units)\b": "indicate",
    r"\b(body|bodies|model|form|boundary) (do(es)? not |that )?knows?\b": "has, lacks",
    r"\bcannot see rotations\b|\bsteps [^.;:]{0,20}(do not see|see (least|of))\b":
        "cannot determine, miss",
    r"\bmind what is said\b|\bof which nothing can be said\b": "note the cautions",
    r"\b(answer|answers) (to|of) (a |the )?(load|harmonic|inertia|unknown)": "response",
    r"\bis none of (a|the) (matrix|displacement|structure|mechan)": "is not",
    r"\bfolds? .* which no symmetry\b|\bof which no symmetry\b": "whose symmetry is unknown",
    r"\boff by a (tenth|per cent|quarter|third)\b": "errors of 10 %",
    r"\bwhich its fastest vibrations answer\b|\bno damping takes away\b": "excites, undamped",
    r"\bquiet but for short times\b": "smooth except for short times",
    r"\bsmall force aside\b|\bwhere it should\b": "lateral force, at the right load",
    r"\bthe same command goes on\b|\bwritten anew where\b": "repeat the command, rewritten if",
    r"\bmade? poorer\b|\bpoorer in everything\b": "simplified",
    r"\bthe peer gets there\b|\berrs more than\b": "no Exudyn model reaches it, exceeds",
    r"\bturns? by [^.;:]{1,20} against it\b|\bturns by \.\.\. rad\b": "rotates relative to it",
    r"\bserve on\b|\bwobble of the energy\b": "remain usable, oscillation",
}


STRING = re.compile(r'"""(.*?)"""|"([^"\n]*)"', re.DOTALL)    # of files that a printer writes


def _texts(path: Path) -> Iterator[tuple[int, str]]:
    """Lines and texts: a whole page, or every string of a module, f-strings with gaps."""
    source = path.read_text()
    if path.suffix != ".py":
        yield 1, source
        return
    if path.parent == ROOT / "generated":       # long, and all of their strings are plain
        for found in STRING.finditer(source):
            yield source.count("\n", 0, found.start()) + 1, found[1] or found[2] or ""
        return
    inner = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.JoinedStr):
            parts = [v.value if isinstance(v, ast.Constant) else "..." for v in node.values]
            inner.update(id(v) for v in node.values)
            yield node.lineno, "".join(map(str, parts))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            if id(node) not in inner:
                yield node.lineno, node.value


def _files() -> list[Path]:
    pages = [ROOT / "README.md", *(page for folder in (*SOURCES, "tests", ".docs", ".github")
                                   for page in (ROOT / folder).rglob("*.md"))]
    parts = [path for folder in SOURCES for kind in ("py", "html", "js")
             for path in (ROOT / folder).rglob(f"*.{kind}")]
    return [path for path in sorted(pages) + sorted(parts)
            if not str(path.relative_to(ROOT)).startswith(APART)]


@pytest.fixture(scope="module")
def texts() -> str:
    """All texts, one a line, with where they are."""
    return "\n".join(f"{path.relative_to(ROOT)}:{line}: {' '.join(text.split())}"
                     for path in _files() for line, text in _texts(path))


@pytest.mark.parametrize(("phrase", "instead"), RETIRED.items(), ids=RETIRED.values())
def test_retired_phrases(texts, phrase, instead):
    pattern = re.compile(phrase, re.IGNORECASE)
    found = [f"{line.split(': ')[0]}: {match[0]!r}" for line in texts.splitlines()
             for match in pattern.finditer(line)]
    assert not found, f"write {instead!r} in place of\n" + "\n".join(found)


def test_texts_are_read(tmp_path):
    """Pages whole, strings of modules joined over lines, values of f-strings as gaps."""
    module = tmp_path / "module.py"
    module.write_text('"""What it does."""\nraise ValueError(f"{name} belongs to no "\n'
                      '                 "body, so nothing holds it")\n')
    assert [text for _, text in _texts(module)] == [
        "What it does.", "... belongs to no body, so nothing holds it"]
    page = tmp_path / "page.md"
    page.write_text("Its formulas are not\ntyped in.\n")
    assert [text for _, text in _texts(page)] == ["Its formulas are not\ntyped in.\n"]
    assert any(path.name == "README.md" for path in _files())


def test_strings_of_generated_files_are_read():
    """As the parser of Python finds them."""
    for path in sorted((ROOT / "generated").glob("*.py"))[1::40]:
        parsed = [node.value for node in ast.walk(ast.parse(path.read_text()))
                  if isinstance(node, ast.Constant) and isinstance(node.value, str)]
        read = [text for _, text in _texts(path)]
        assert set(parsed) <= set(read) and len(parsed) == len(read) > 0
