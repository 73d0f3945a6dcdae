"""Names that nothing has: the exception, with those that were perhaps meant."""

from collections.abc import Callable, Iterable
from difflib import get_close_matches
from functools import wraps
from inspect import Parameter, signature
from typing import ParamSpec, TypeVar

from sebody.basics.errors import InputError
from sebody.basics.inputs import shown

MOST = 40           # names that a message lists
# what textbooks call by a symbol, and the name of the argument
SYMBOLS = {"E": "youngs_modulus", "nu": "poisson_ratio", "rho": "density",
           "G": "youngs_modulus and poisson_ratio, of which G = E / (2 (1 + nu))"}
ALIKE = 0.6         # of two names, so that one may have been meant for the other


Arguments = ParamSpec("Arguments")
Made = TypeVar("Made")


def without_symbols(make: Callable[Arguments, Made], what: str = "") -> Callable[Arguments, Made]:
    """A function that names its arguments where a symbol of theirs is given; see `SYMBOLS`."""
    told = naming_arguments(make)

    @wraps(make)
    def named(*args: Arguments.args, **given: Arguments.kwargs) -> Made:
        if symbols := [symbol for symbol in given if symbol in SYMBOLS]:
            raise InputError(f"{what or make.__name__} has no {'=, '.join(symbols)}=: give "
                             + ", ".join(SYMBOLS[symbol] for symbol in symbols))
        return told(*args, **given)
    return named


def naming_arguments(function: Callable[Arguments, Made]) -> Callable[Arguments, Made]:
    """A function that lists its arguments where one that it does not have is given by name."""
    @wraps(function)
    def named(*args: Arguments.args, **given: Arguments.kwargs) -> Made:
        try:
            return function(*args, **given)
        except TypeError:
            refuse_arguments(function, given)
            raise
    return named


def refuse_arguments(function: Callable, given: Iterable[str], first: int = 0,
                     others: Iterable[str] = ()) -> None:
    """Refuse arguments by names that a function does not have; its own from `first` on are listed.

    Parameters
    ----------
    others : iterable of str
        Names that it takes by ``**``; without them a function that takes any is not looked at.

    Raises
    ------
    TypeError
    """
    own = list(signature(function).parameters.values())
    listed = [one.name for one in own[first:] if one.kind is not Parameter.VAR_KEYWORD]
    names = [*listed, *others]
    odd = [name for name in given if name not in names]
    if odd and (len(names) > len(listed) or len(listed) == len(own) - first):
        raise TypeError(f"{function.__name__} has no {'=, '.join(odd)}=: its arguments are "
                        f"{', '.join(names)}") from None


def unknown(what: str, name: object, known: Iterable[str], have: str = "there are",
            none: str = "there is none") -> InputError:
    """The exception for a name that nothing has.

    Parameters
    ----------
    what : str
        What it should be the name of.
    known : iterable of str
        Names there are: those alike are shown, all if there are none.
    have, none : str
        Words before all names, and in place of them.
    """
    return InputError(f"{what} {shown(name)} is unknown: {offered(name, known, have, none)}")


def offered(name: object, known: Iterable[str], have: str = "there are",
            none: str = "there is none") -> str:
    """Names that were perhaps meant, else all there are; see `unknown`."""
    known = list(dict.fromkeys(known))
    if near := alike(name, known):
        return f"did you mean {' or '.join(map(repr, near))}?"
    if not known:
        return none
    listed = known if not any(set(one) & set(" ,'") for one in known) else [
        repr(one) for one in known]
    more = len(known) - MOST
    return f"{have} {', '.join(listed[:MOST])}" + (f" and {more} more" if more > 0 else "")


def alike(name: object, known: Iterable[str], most: int = 3, cutoff: float = ALIKE) -> list[str]:
    """Names that are like another one, the most alike first, in whatever case."""
    if not isinstance(name, str):
        return []
    by_lower: dict[str, str] = {}
    for one in known:
        by_lower.setdefault(one.lower(), one)
    return [by_lower[one] for one in get_close_matches(name.lower(), by_lower, most, cutoff)]
