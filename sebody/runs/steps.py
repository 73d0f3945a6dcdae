"""The number of steps of a run, and the last of them."""

from sebody.basics import inputs
from sebody.basics.errors import InputError

MOST_STEPS = 1e12       # of a run: weeks, at a microsecond each
OFF_GRID = 1e-6         # of a step: further away, a time is none of the grid's


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


def whole_steps(t_end: float, h: float) -> int:
    """The number of steps that a time is a multiple of.

    Raises
    ------
    InputError
        It is none, or too many steps away.
    """
    check_steps(t_end, h)
    steps = round(t_end / h)
    if steps < 1 or abs(t_end / h - steps) > OFF_GRID:
        raise InputError(f"t_end is {t_end:g}, which is not a multiple of the step {h:g}: give one")
    return steps


def last_step(t_end: float, h: float, time: float, grid: int) -> int:
    """The grid step nearest to the end of a run that has reached a time, and a step of the grid.

    Raises
    ------
    InputError
        A time that is past, less than half a step away, or too many steps away.
    """
    past = f"cannot run to t = {inputs.shown(t_end)} from t = {time}: give a later time"
    t_end = inputs.number(t_end, "t_end", remedy=past)
    check_steps(t_end, h)
    steps = t_end / h
    if round(steps) < grid:
        raise InputError(past)
    there = abs(t_end - time) <= OFF_GRID * min(h, max(t_end, time))
    if round(steps) == grid and not there:
        raise InputError(f"cannot run to t_end = {t_end:g} from t = {time:g}: the step is "
                         f"{h:g}; give a later time or a smaller step (the step comes first)")
    return round(steps)
