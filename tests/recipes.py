"""The recipes of CONTRIBUTING.md, read and followed in a copy of the tree.

The line before a block of code says where it goes: ``At the end of `FILE`:``, ``New file `FILE`:``,
``In `FILE`, below `TEXT`:`` (or above, or in place of), where TEXT is on one line of the file.
"""

import re
import shutil
from pathlib import Path
from typing import NamedTuple

from copies import ROOT, python

PLACE = re.compile(r"(?:At the end of|New file|In) `(?P<file>[^`]+)`"
                   r"(?:, (?P<side>below|above|in place of) `(?P<anchor>[^`]+)`)?:\n\n"
                   r" *```python\n(?P<code>.*?)^ *```$", re.DOTALL | re.MULTILINE)
INSTALLED = {"derive/": "sebody/derive/", "generated/": "sebody/generated/",
             "examples/": "sebody/scenes/"}


class Block(NamedTuple):
    """Code of a recipe and the place it goes to; at a line, or the end of the file."""

    file: str
    side: str | None
    anchor: str | None
    code: str


def recipe(title: str) -> list[Block]:
    """Blocks of the recipe with a heading."""
    text = (ROOT / ".github" / "CONTRIBUTING.md").read_text()
    section = re.split(rf"^## {title}$", text, flags=re.MULTILINE)[1]
    return blocks(re.split(r"^## ", section, flags=re.MULTILINE)[0])


def blocks(section: str) -> list[Block]:
    """Blocks of a text, each of which needs a place."""
    found = [Block(m["file"], m["side"], m["anchor"], _code(m)) for m in PLACE.finditer(section)]
    assert len(found) == section.count("```python"), "a block has no place that can be read"
    return found


def _code(match: re.Match) -> str:
    """Code without the indentation of its fence, which may be in a list."""
    fence = re.search(r"^( *)```$", match[0].splitlines()[-1])[1]
    return re.sub(rf"^{fence}", "", match["code"], flags=re.MULTILINE)


def apply(tree: Path, blocks: list[Block]) -> None:
    """Follow a recipe in a copy of the tree."""
    for block in blocks:
        name = next((block.file.replace(old, new, 1) for old, new in INSTALLED.items()
                     if block.file.startswith(old)), block.file)
        path = tree / name
        if block.side is None:
            old = path.read_text() + "\n\n" if path.exists() else ""
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(old + block.code)
            continue
        lines = path.read_text().splitlines(keepends=True)
        at = next((k for k, line in enumerate(lines) if block.anchor in line), None)
        assert at is not None, f"{block.file} has no line with {block.anchor!r}: adapt the recipe"
        code = block.code + "\n\n" * block.code.startswith("def ")
        at += block.side == "below"
        lines[at:at + (block.side == "in place of")] = [code]
        path.write_text("".join(lines))


def copy_tests(tree: Path) -> None:
    """What tests that a recipe adds need: settings, helpers and the malformed cases."""
    shutil.copy(ROOT / "pyproject.toml", tree)
    shutil.copytree(ROOT / "tests" / "malformed", tree / "tests" / "malformed",
                    ignore=shutil.ignore_patterns("__pycache__"))
    for path in (ROOT / "tests").glob("*.py"):
        if not path.name.startswith("test_"):
            shutil.copy(path, tree / "tests")


def run(tree: Path, code: str, *arguments: str) -> str:
    """What code prints on a copy, with arguments; it has to end well."""
    done = python(tree, code, *arguments)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def sebody(tree: Path, *arguments: str) -> str:
    """What a command prints."""
    return run(tree, "from sebody.cli.entry import main; sys.exit(main(sys.argv[1:]))", *arguments)


def run_tests(tree: Path, *arguments: str) -> str:
    """What pytest prints of tests of a copy, which have to pass."""
    return run(tree, "import pytest; sys.exit(pytest.main(sys.argv[1:]))", "-p",
               "no:cacheprovider", *arguments)
