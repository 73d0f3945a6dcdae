"""``sebody verify``: cases of others, what other programs, books and benchmark libraries publish.

Every case is a module of this folder: it builds the model, names its source and holds its numbers.
See `sebody.verify.outside.case` for the tolerances.
"""

import warnings
from collections.abc import Iterable
from importlib import import_module

from sebody.basics.errors import LimitWarning
from sebody.basics.spelling import unknown
from sebody.verify.outside.case import Case, Row, rows

__all__ = ["CASES", "Case", "Row", "as_dict", "check_names", "load", "measure", "report", "summary"]

CASES = (
    # mechanisms of rigid bodies
    "simple-pendulum", "n-four-bar", "squeezer", "bricard", "flyball-governor",
    "spatial-slider-crank", "heavy-top",
    # beams at rest
    "composite-beam", "twisted-beam", "curved-beam", "curved-superelements", "two-beam-cantilever",
    "turning-self-weight", "pin-beam", "princeton-beam", "roll-up",
    # vibrations and rotation
    "double-cross", "off-centre-masses", "deep-beam", "string-in-tension", "l-frame",
    "rotating-cantilever", "rotating-rod", "rotating-blade", "spinning-ring", "rotor-in-bearings",
    "whirling-shaft", "jacket",
    # motion of flexible bodies
    "composite-beam-dynamics", "slewing-beam", "misaligned-four-bar", "lateral-buckling",
    "rotating-shaft", "spin-up-rounded", "moving-mass",
)


def check_names(names: Iterable[str]) -> None:
    """Refuse unknown cases.

    Raises
    ------
    InputError
        The first one that is unknown, with those that were perhaps meant.
    """
    for name in names:
        if name not in CASES:
            raise unknown("case", name, CASES)


def load(name: str) -> Case:
    """A case by its name.

    Raises
    ------
    InputError
        An unknown case.
    """
    check_names([name])
    return import_module(f"{__name__}.{name.replace('-', '_')}").CASE


def measure(name: str, whole: bool = True, division: int = 1) -> list[Row]:
    """Run a case; warnings of models that others have defined so are not given.

    Parameters
    ----------
    name : str
    whole : bool
        All numbers; otherwise those that take little time.
    division : int
        Twice as many elements, bodies or steps, if 2.

    Raises
    ------
    InputError
        An unknown case.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)
        return rows(name, load(name), whole, division)


def report(found: list[Row]) -> str:
    """Title, source and note of a case, and a line for every number."""
    own = load(found[0].case)
    wide = max(len(row.quantity) for row in found)
    lines = [f"{found[0].case}: {own.title}", f"  source  {own.source}"]
    lines += [f"  note    {own.note}"] if own.note else []
    lines.append(f"  {'quantity':{wide}}  {'reference':>16} {'value':>16} {'difference':>10} "
                 f"{'tolerance':>9} {'source':>8} {'seconds':>7}")
    lines += [f"  {row.quantity:{wide}}  {row.reference:16.9g} {row.value:16.9g} "
              f"{row.difference:10.1e} {row.tolerance:9.1e} {_bound(row):>8} {row.seconds:7.2f}"
              f"{'' if row.passed else '  EXCEEDED'}" for row in found]
    return "\n".join(lines)


def _bound(row: Row) -> str:
    return "-" if row.source_tolerance is None else f"{row.source_tolerance:.1e}"


def summary(found: list[Row]) -> str:
    """Last line: how many numbers agree, and the time."""
    seconds = {row.case: row.seconds for row in found}
    agree = sum(row.passed for row in found)
    return (f"{agree} of {len(found)} numbers of {len(seconds)} case{'s' * (len(seconds) != 1)} "
            f"within tolerance, {sum(seconds.values()):.1f} s")


def as_dict(found: list[Row]) -> dict[str, list[dict]]:
    """All numbers for programs, one entry each."""
    return {"cases": [row._asdict() for row in found]}
