"""The pages of the tree, copied with what they link to; the README is the front page.

Every page has the place that it has in the tree, so that links between pages hold. Three things
move: the README becomes ``index.md``, ``.docs`` becomes ``guide`` and ``.github`` becomes
``project``, as servers of pages leave out dot folders.
"""

import os
import re
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path

FOLDERS = (".docs", "sebody", "derive", "examples", "tests", ".github")
MOVED = {".docs/README.md": "project/pages.md", ".docs/": "guide/", ".github/": "project/"}
SECTIONS = (        # captions of the navigation: a page is in the first whose folder contains it
    ("Tutorials", "guide/tutorials/"), ("Guide", "guide/"), ("By subject", "sebody/"),
    ("Derivation", "derive/"), ("Measurements", "tests/"), ("Project", "project/"))
LINK = re.compile(r"(?<=\]\()([^)#:\s]+)(?=[)#])")


def write(root: Path, pages: Path, made: Sequence[str]) -> None:
    """Copy all pages of a tree and write the front page.

    Parameters
    ----------
    root, pages : Path
        The tree, and the folder that Sphinx reads.
    made : sequence of str
        Pages that were made there, to be listed in the navigation below the guide.
    """
    found = sorted(find(root))
    for page in found:
        _copy(root, page, pages)
    front = pages / "index.md"
    front.write_text(front.read_text() + _navigation([place(page) for page in found], made))


def find(root: Path) -> Iterator[str]:
    """All pages of the tree by their paths."""
    yield "README.md"
    for folder in FOLDERS:
        for path in (root / folder).rglob("*.md"):
            yield path.relative_to(root).as_posix()


def place(path: str) -> str:
    """Where a file of the tree is among the pages."""
    if path == "README.md":
        return "index.md"
    return next((new + path[len(old):] for old, new in MOVED.items() if path.startswith(old)),
                path)


def _copy(root: Path, page: str, pages: Path) -> None:
    """Copy a page and the files that it links to."""
    def moved(match: re.Match) -> str:
        target = os.path.normpath(os.path.join(os.path.dirname(page), match[1]))
        if (root / target).is_dir():
            target += "/README.md"
        if not target.endswith(".md") and (root / target).is_file():
            copied = pages / place(target)
            copied.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(root / target, copied)
        return os.path.relpath(place(target), os.path.dirname(place(page)) or ".")

    copied = pages / place(page)
    copied.parent.mkdir(parents=True, exist_ok=True)
    copied.write_text(LINK.sub(moved, (root / page).read_text()))


def _navigation(found: Sequence[str], made: Sequence[str]) -> str:
    """Tables of contents of the front page, shown in the sidebar alone."""
    sections: dict[str, list[str]] = {caption: [] for caption, _ in SECTIONS}
    for page in found:
        caption = next((name for name, folder in SECTIONS if page.startswith(folder)), None)
        if caption:
            sections[caption].append(page.removesuffix(".md"))
    sections["Guide"] += made
    text = ""
    for caption, names in sections.items():
        listed = "\n".join(f"/{name}" for name in names)
        text += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{listed}\n```\n"
    return text
