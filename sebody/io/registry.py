"""The table of sources: kinds of files, their readers, and what must be installed for them."""

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from sebody import inputs
from sebody.errors import InputError
from sebody.io import calculix
from sebody.io.reading import Reading


class Source(NamedTuple):
    """One way into the program.

    Parameters
    ----------
    name : str
        As ``--format`` takes it.
    suffixes : tuple of str
        Endings of the files it reads.
    read : function
        `Reading` of a path.
    summary : str
        For lists.
    needs : str
        Package that must be importable; empty for none.
    extra : str
        The extra of this package that brings it.
    """

    name: str
    suffixes: tuple[str, ...]
    read: Callable[[Path], Reading]
    summary: str
    needs: str = ""
    extra: str = ""


SOURCES = (
    Source("calculix", (".inp", ".sti", ".mas", ".dof"), calculix.read,
           "deck and the matrices of *FREQUENCY, SOLVER=MATRIXSTORAGE beside it"),
)


def read_source(path: str | Path, kind: str | None = None) -> Reading:
    """What the files of an FE program say.

    Parameters
    ----------
    path : str or Path
        One of the files; those beside it with the same stem are found.
    kind : str, optional
        Name of the source; guessed from the files by default.

    Raises
    ------
    InputError
        An unknown kind, a package that is not installed, or files that cannot be used.
    """
    path = inputs.path(path, "file to import")
    if not path.exists():
        raise InputError(f"file to import {path} does not exist: give the path of a file of an FE "
                         "program")
    source = _guessed(path) if kind is None else _named(kind)
    if source.needs and not _installed(source.needs):
        raise InputError(f"files of {source.name} are read by {source.needs}, which is not "
                         f'installed: pip install "sebody[{source.extra}]"')
    return source.read(path)


def _named(kind: str) -> Source:
    by_name = {source.name: source for source in SOURCES}
    return by_name[inputs.choice(kind, "format", by_name)]


def _guessed(path: Path) -> Source:
    """The source of a file by its ending and the files beside it."""
    fits = [source for source in SOURCES if path.suffix.lower() in source.suffixes]
    for source in fits[1:]:
        # endings that several programs share: the first is meant unless files of another are there
        own = [end for end in source.suffixes if end not in fits[0].suffixes]
        if path.suffix.lower() in own or any(path.with_suffix(end).exists() for end in own):
            return source
    if fits:
        return fits[0]
    known = "; ".join(f"{source.name} ({', '.join(source.suffixes)})" for source in SOURCES)
    raise InputError(f"{path} is of no known kind: give --format, or a file of {known}")


def _installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:     # of a package within one that is not there
        return False
