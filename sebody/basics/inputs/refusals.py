"""Messages about values that cannot be used."""

import numpy as np

from sebody.basics.errors import InputError

LONGEST_SHOWN = 60      # characters of a value in a message


def shown(value: object) -> str:
    """A value as messages show it: on one line, and not long."""
    try:
        text = repr(value.tolist() if isinstance(value, np.generic | np.ndarray) else value)
    except Exception:       # of whatever class a user passes by mistake
        text = f"of class {type(value).__name__}"
    text = " ".join(text.split())
    return text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN - 3] + "..."


def refusal(what: str, value: object, remedy: str) -> InputError:
    """The exception for a value that cannot be used."""
    return InputError(f"{what} is {shown(value)}: {remedy}")
