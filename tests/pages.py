"""Pages: their blocks of code and their commands, and how a test runs them.

Blocks of a page are one session: those in Python share their names, commands run in one folder,
which holds the files that the page links to. A comment ``<!-- setup ... -->`` is code that
runs before the next block but is not shown; ``<!-- not run: REASON -->`` exempts the next block.
"""

import os
import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from copies import ROOT

BLOCK = re.compile(r"(?:<!-- (?P<note>setup|not run: )(?P<text>.*?)-->\s*)?"
                   r"^(?P<space> *)```(?P<kind>python|sh)\n(?P<code>.*?)^ *```$",
                   re.DOTALL | re.MULTILINE)
PROGRAMS = {"gmsh", "ccx"}      # others than sebody that run, where they are installed
LINKED = re.compile(r"\]\(([^)#:\s]+\.(?:inp|geo))\)")


class Block(NamedTuple):
    """Code or commands as a page shows them."""

    kind: str           # 'python' or 'sh'
    code: str
    setup: str          # what runs before
    reason: str         # why it does not run, if it does not


def public_names() -> dict[str, set[str]]:
    """Names that users import, by package: the table that the API reference is made from, too."""
    page = (ROOT / ".docs" / "names.md").read_text()
    return {package: set(re.findall(r"`(\w+)`", names))
            for package, names in re.findall(r"^\| `([\w.]+)` \| (.*) \|$", page, re.MULTILINE)}


def all_pages() -> list[Path]:
    """Every page of the tree."""
    folders = (".docs", ".github", "sebody", "derive", "examples", "tests")
    return [ROOT / "README.md", *(page for folder in folders
                                  for page in sorted((ROOT / folder).rglob("*.md")))]


def blocks(text: str) -> list[Block]:
    """Blocks of a page."""
    found = []
    for m in BLOCK.finditer(text):
        note, said = m["note"] or "", (m["text"] or "").strip()
        code = re.sub(rf"^{m['space']}", "", m["code"], flags=re.MULTILINE)
        found.append(Block(m["kind"], code, said * (note == "setup"), said * (note != "setup")))
    return found


def commands(text: str) -> list[list[str]]:
    """Commands of the blocks of a page, in words."""
    return [words for block in blocks(text) if block.kind == "sh" for words in _words(block.code)]


def commands_in_words(text: str) -> list[list[str]]:
    """Whole commands in running text, in words: none that is named alone, or has placeholders."""
    spans = re.findall(r"`(?:python -m )?sebody ([^`]+)`", BLOCK.sub("", text))
    found = [shlex.split(span.replace("\n", " ")) for span in spans]
    return [words for words in found if len(words) > 1 and not words[1].startswith("--")
            and not any(re.fullmatch(r"\.\.\.|[A-Z]+(\.[a-z]+)?", word.rpartition("=")[2])
                        for word in words)]


def run(page: Path, folder: Path) -> Iterator[str]:
    """Run a page in a folder; programs that are not installed, by name."""
    text = page.read_text()
    for link in LINKED.findall(text):
        shutil.copy(page.parent / link, folder)
    names: dict = {"__name__": "page"}
    for block in blocks(text):
        exec(block.setup, names)
        if block.reason:
            _check(block)
            continue
        if block.kind == "python":
            exec(compile(block.code, str(page), "exec"), names)
            continue
        for words in _words(block.code):
            if words[0] == "sebody":
                _sebody(words[1:])
            elif words[0] == "pip":         # what it installs is here
                continue
            elif words[0] not in PROGRAMS:
                raise AssertionError(f"{page}: no test runs {words[0]}: write <!-- not run: REASON "
                                     "--> before the block")
            elif shutil.which(words[0]):
                assert os.spawnvp(os.P_WAIT, words[0], words) == 0, words
            else:
                yield words[0]


def _sebody(arguments: list[str]) -> None:
    from sebody.cli.entry import main

    assert main(arguments) == 0, arguments


def _check(block: Block) -> None:
    """Of a block that does not run: Python can be read, and sebody has the commands."""
    from sebody.cli.entry import _parser

    if block.kind == "python":
        compile(block.code, "page", "exec")
        return
    for words in _words(block.code):
        if words[0] == "sebody":
            _parser().parse_args(words[1:])


def _words(code: str) -> list[list[str]]:
    """Commands of a block: one a line, which ends that go on with a backslash and ``&&`` join."""
    lines = code.replace("\\\n", " ").splitlines()
    parts = [part for line in lines for part in line.split(" && ")]
    return [words for part in parts if (words := shlex.split(part, comments=True))]
