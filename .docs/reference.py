"""Pages of the API: one for each package in the table of public names."""

import inspect
import re
from importlib import import_module
from pathlib import Path
from types import ModuleType

TABLE = Path(__file__).with_name("names.md")
# also what a class has from others, but for those of Python
MEMBERS = "\n   :members:\n   :inherited-members: tuple, dict, object, BaseException"


def packages() -> list[ModuleType]:
    """Packages that users import names from."""
    names = re.findall(r"^\| `([\w.]+)` \|", TABLE.read_text(), re.MULTILINE)
    return [import_module(name) for name in names]


def write(pages: Path) -> str:
    """Write the pages and their index, whose name is returned."""
    folder = pages / "reference"
    folder.mkdir(parents=True)
    shown: dict[int, str] = {}
    for package in packages():
        (folder / f"{package.__name__}.md").write_text(_page(package, shown))
    listed = "\n".join(package.__name__ for package in packages())
    (folder / "index.md").write_text(
        "# API reference\n\nEvery public name, by the package that it is imported from: the "
        "[table of names](../guide/names.md), or the {ref}`index <genindex>`.\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{listed}\n```\n")
    return "reference/index"


def _page(package: ModuleType, shown: dict[int, str]) -> str:
    """The page of a package: what it says of itself, then its names.

    What an earlier page shows, by `id`, is named alone.
    """
    text = f"# {package.__name__}\n\n{inspect.getdoc(package)}\n\n"
    for name in sorted(package.__all__, key=str.lower):
        value, full = getattr(package, name), f"{package.__name__}.{name}"
        if (first := shown.setdefault(id(value), full)) != full:
            text += f"`{name}` is {{py:obj}}`{first}`.\n\n"
        elif isinstance(value, dict | tuple):
            entries = [str(one) if isinstance(value, dict) else one.name for one in value]
            text += _rst(f".. py:data:: {full}\n\n   Entries: " +
                         ", ".join(f"``{one}``" for one in entries) + ".")
        else:
            kind = "class" if inspect.isclass(value) else "function"
            text += _rst(f".. auto{kind}:: {full}" + MEMBERS * (kind == "class"))
    return text


def _rst(text: str) -> str:
    return f"```{{eval-rst}}\n{text}\n```\n\n"
