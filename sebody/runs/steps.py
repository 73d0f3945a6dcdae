"""How many steps a run may have."""

from sebody.errors import InputError

MOST_STEPS = 1e12       # of a run: weeks, at a microsecond each


def check_steps(t_end: float, h: float) -> None:
    """Refuse an end that is too many steps away.

    Raises
    ------
    InputError
        There are more than `MOST_STEPS`; the message names the end, the number and the step.
    """
    if not t_end / h <= MOST_STEPS:
        raise InputError(f"t_end is {t_end:g}: that is {t_end / h:.3g} steps of {h:g}, give an "
                         "earlier time or a longer step")
