"""Times of runs on a machine that does other things, too."""

import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from sebody.basics.errors import LimitWarning
from sebody.runs.simulation import Simulation

LEAST, MOST = 3, 9      # runs of each
AGREE = 1.05            # ratio of the two quickest runs from which the quickest is trusted
BARS = (f"time: the processor's, of the quickest of {LEAST} to {MOST} runs that take turns; bars "
        "end at the slowest")
LONG = 20.0             # seconds of all runs of one, after which it does not run again


class Times(NamedTuple):
    """Times of the quickest and of the slowest of several runs [s]."""

    quickest: float
    slowest: float


@contextmanager
def poor_variants() -> Iterator[None]:
    """Variants of a chart may be poor: that is what it shows, and nothing to warn of."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)
        yield


def processor_seconds(run: Simulation, t_end: float) -> float:
    """Run to a time, and the seconds that the processor worked on it, not those it did not.

    The seconds of a run that planned its steps come on top.
    """
    begin = time.thread_time()
    run.run_to(t_end)
    return time.thread_time() - begin + run.plan.seconds


def repeated(runs: Sequence[Callable[[], float]], least: int = LEAST, most: int = MOST
             ) -> list[Times]:
    """Run each several times, until its two quickest runs agree or it has taken long enough.

    All have their turn before one has its next, so that a while in which the machine is busy does
    not fall on all runs of one.

    Parameters
    ----------
    runs : sequence of callable
        Each runs once and returns the seconds this took.
    least, most : int
        How often.
    """
    seconds: list[list[float]] = [[] for _ in runs]
    for round_ in range(most):
        for run, times in zip(runs, seconds, strict=True):
            if sum(times) < LONG and (round_ < least or not _settled(times)):
                times.append(run())
    return [Times(min(times), max(times)) for times in seconds]


def _settled(seconds: list[float]) -> bool:
    quickest, second, *_ = sorted(seconds)
    return second <= AGREE * quickest
