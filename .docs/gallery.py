"""The gallery: a page for every shipped scene, made from its file and from a run.

A scene's docstring says what the scene is and, in a last paragraph that begins with ``Look at``,
what is worth seeing; quantities between double backticks in this paragraph are plotted.
"""

import ast
import re
import shlex
import sys
import textwrap
from functools import cache
from inspect import getdoc
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from still import write_still

from sebody import simulate
from sebody.catalogue import builder, scenes
from sebody.results import animate, plot

ROOT = Path(__file__).parents[1]
LONGEST = 40        # lines of code; of longer files only `build` is shown


class Entry(NamedTuple):
    """What a page says of a scene."""

    name: str
    summary: str            # first paragraph of the docstring
    more: str               # the others but the last
    look: str
    quantities: list[str]
    code: str
    file: Path

    @property
    def title(self) -> str:
        return self.name.replace("-", " ").capitalize()


def entry(name: str) -> Entry:
    """Read the file of a scene."""
    module = sys.modules[builder(name).__module__]
    paragraphs = getdoc(module).split("\n\n")
    look = paragraphs.pop() if paragraphs[-1].startswith("Look at") else ""
    return Entry(name, paragraphs[0], "\n\n".join(paragraphs[1:]), look,
                 _quantities(look), _code(module), Path(module.__file__))


def _quantities(look: str) -> list[str]:
    """Quantities that a paragraph names; settings, ``NAME=VALUE``, are none."""
    named = (" ".join(word.split()) for word in re.findall(r"``([^`]+)``", look))
    return [word for word in named if "=" not in word]


def tests_of(scene: Entry) -> list[str]:
    """Tests that build the scene."""
    word = re.compile(rf"\b{scene.file.stem}\b.*\b(build|scenes)\b|"
                      rf"\b(scenes|import)\b.*\b{scene.file.stem}\b|\"{scene.name}\"")
    return [path for path, text in _tests().items() if word.search(text)]


@cache
def _tests() -> dict[str, str]:
    """Text of every file of tests."""
    return {path.relative_to(ROOT).as_posix(): path.read_text()
            for path in sorted((ROOT / "tests").rglob("test_*.py"))}


def write(pages: Path, extra: Path) -> str:
    """Run all scenes; write their pages and the index, whose name is returned.

    Parameters
    ----------
    pages, extra : Path
        Folders of what Sphinx reads, and of what it copies as it is: interactive pages.
    """
    folder = pages / "gallery"
    folder.mkdir(parents=True)
    (extra / "scenes").mkdir(parents=True)
    found = [entry(name) for name in scenes()]
    for scene in found:
        _draw(scene, folder, extra / "scenes")
        (folder / f"{scene.name}.md").write_text(_page(scene))
    cards = "\n".join(f'<a href="{scene.name}.html"><img src="../scenes/{scene.name}.png" alt="">'
                      f"<b>{scene.title}</b><span>{_html(scene.summary)}</span></a>"
                      for scene in found)
    listed = "\n".join(scene.name for scene in found)
    (folder / "index.md").write_text(
        f"# Gallery\n\nThe {len(found)} scenes that are shipped. Every picture was made by the run "
        "that its page shows, when these pages were built.\n\n"
        f'```{{raw}} html\n<div class="cards">\n{cards}\n</div>\n```\n\n'
        f"```{{toctree}}\n:hidden:\n\n{listed}\n```\n")
    return "gallery/index"


def _draw(scene: Entry, folder: Path, extra: Path) -> None:
    """Run the scene; draw its quantities, a still and an interactive page."""
    made = builder(scene.name)()
    result = simulate(made.model, made.h, made.t_end)
    plot(result, *scene.quantities, output=folder / f"{scene.name}-plot.png")
    animate(result, extra / f"{scene.name}.html", *scene.quantities, title=scene.title)
    write_still(result, extra / f"{scene.name}.png")


def _page(scene: Entry) -> str:
    quantities = shlex.join(scene.quantities)
    confirmed = ", ".join(f"`{path}`" for path in tests_of(scene))
    return f"""# {scene.title}

{scene.summary}

{scene.more}

```{{raw}} html
<iframe class="scene" loading="lazy" title="{scene.title}" src="../scenes/{scene.name}.html">
</iframe>
```

{scene.look}

![{scene.title}: {", ".join(scene.quantities)}]({scene.name}-plot.png)

```sh
sebody run {scene.name} --output {scene.name}.npz
sebody plot {scene.name}.npz {quantities} --output {scene.name}.png
sebody animate {scene.name}.npz --output {scene.name}.html
```

The model, from `examples/{scene.file.name}`; `sebody list {scene.name}` explains its parameters:

```python
{scene.code}
```

Confirmed by {confirmed}.
"""


def _code(module: ModuleType) -> str:
    """The file without docstrings and what makes it a script, if that is not long.

    Otherwise its `build`, and functions that `build` calls as long as they fit.
    """
    source = Path(module.__file__).read_text()
    tree = ast.parse(source)
    parts = [node for node in tree.body if not isinstance(node, ast.If | ast.Expr)]
    whole = "\n".join(_without_docstring(source, part) for part in parts)
    if whole.count("\n") < LONGEST:
        return whole
    functions = {part.name: _without_docstring(source, part) for part in parts
                 if isinstance(part, ast.FunctionDef)}
    shown = {"build": functions.pop("build")}
    for name, code in functions.items():
        longer = {name: code} | shown
        if f"{name}(" in shown["build"] and "\n".join(longer.values()).count("\n") < LONGEST:
            shown = longer
    return "\n".join(shown.values())


def _without_docstring(source: str, part: ast.stmt) -> str:
    lines = source.splitlines()[part.lineno - 1:part.end_lineno]
    if isinstance(part, ast.FunctionDef) and ast.get_docstring(part):
        doc = part.body[0]
        del lines[doc.lineno - part.lineno:doc.end_lineno - part.lineno + 1]
    space = "\n" if isinstance(part, ast.FunctionDef) else ""
    return space + textwrap.dedent("\n".join(lines))


def _html(text: str) -> str:
    return text.replace("\n", " ").replace("<", "&lt;").replace("`", "")
