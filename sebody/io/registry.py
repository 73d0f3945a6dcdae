"""The table of sources: kinds of files, their readers, and what must be installed for them."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files.reading import existing
from sebody.io import abaqus, ansys, calculix, extptfm, matrix_market, nastran, sid
from sebody.io.reading import Reading
from sebody.io.text import read_text


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
    sign : str
        Regular expression found at the beginning of such a file, where others have its endings.
    needs : str
        Package that must be importable; empty for none.
    extra : str
        The extra of this package that brings it.
    """

    name: str
    suffixes: tuple[str, ...]
    read: Callable[[Path], Reading]
    summary: str
    sign: str = ""
    needs: str = ""
    extra: str = ""


SOURCES = (
    Source("calculix", (".inp", ".sti", ".mas", ".dof"), calculix.read,
           "deck and the matrices of *FREQUENCY, SOLVER=MATRIXSTORAGE beside it"),
    Source("matrix-market", (".mtx",), matrix_market.read,
           "NAME_K.mtx, NAME_M.mtx, NAME.mapping and NAME.nodes, as of Ansys HBMAT and NLIST",
           r"\A%%MatrixMarket"),
    Source("abaqus-substructure", (".mtx",), abaqus.read_substructure,
           "*SUBSTRUCTURE MATRIX OUTPUT with the deck beside it; reduced already",
           r"(?im)^\*USER ELEMENT"),
    Source("abaqus-matrices", (".mtx",), abaqus.read_generated,
           "JOB_STIF1.mtx and JOB_MASS1.mtx of *MATRIX GENERATE with the deck JOB.inp"),
    Source("ansys", (".full",), ansys.read, ".full with the nodes of .rst or .cdb beside it",
           needs="ansys.mapdl.reader", extra="ansys"),
    Source("nastran-op4", (".op4",), nastran.read_op4,
           "OP4 of EXTSEOUT with .asm or bulk data beside it; reduced already",
           needs="pyyeti", extra="nastran"),
    Source("nastran-dmig", (".pch", ".op2"), nastran.read_dmig,
           "DMIG in a punch or OP2 file with GRID cards; reduced already", needs="pyyeti",
           extra="nastran"),
    Source("extptfm", (".dat",), extptfm.read,
           "OpenFAST's ExtPtfm, FlexASCII or GuyanASCII; reduced already, held to the ground"),
    Source("sid", (".sid_fem", ".sid"), sid.read,
           "Standard Input Data, where its modes span the motions of the nodes"),
)
_HEAD = 4000        # characters in which a sign is looked for


def read_source(path: str | Path, kind: str | None = None) -> Reading:
    """Contents of the files of an FE program.

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
    path = existing(path, "file to import", "give the path of a file of an FE program")
    source = _guessed(path) if kind is None else _named(kind, path)
    if source.needs and not _installed(source.needs):
        raise InputError(f"files of {source.name} are read by {source.needs}, which is not "
                         f'installed: pip install "sebody[{source.extra}]"')
    with naming(path):
        return source.read(path)


@contextmanager
def naming(path: str | Path) -> Iterator[None]:
    """Input errors of matrices, with the name of their file."""
    try:
        yield
    except InputError as error:
        if Path(path).stem in str(error):
            raise
        raise InputError(f"{path}: {error}") from error


def _named(kind: str, path: Path) -> Source:
    """The source of a name, refused where the file has the ending of another one."""
    by_name = {source.name: source for source in SOURCES}
    chosen = by_name[inputs.choice(kind, "format", by_name)]
    ending = path.suffix.lower()
    others = [source.name for source in SOURCES if ending in source.suffixes]
    if others and chosen.name not in others:
        raise InputError(f"{path} is a file of {' or '.join(others)}, by its ending, and the "
                         f"format is {kind}, which reads {', '.join(chosen.suffixes)}: leave the "
                         "format out, or give it the ending of its kind")
    return chosen


def _guessed(path: Path) -> Source:
    """The source of a file by its ending, and its beginning where several have this ending."""
    fits = [source for source in SOURCES if path.suffix.lower() in source.suffixes]
    if len(fits) > 1:
        head = read_text(path, "file to import", "give another one")[:_HEAD]
        fits = [source for source in fits if re.search(source.sign, head)]
    if fits:
        return fits[0]
    known = "; ".join(f"{source.name} ({', '.join(source.suffixes)})" for source in SOURCES)
    raise InputError(f"{path} is of an unknown kind: give --format, or a file of {known}")


def _installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:     # of a package within one that is not there
        return False
