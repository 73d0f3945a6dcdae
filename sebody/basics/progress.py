"""The bar of a long run."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from inspect import signature
from typing import Any

from sebody.basics import inputs

BAR = 40                # characters
PATIENCE = 1.0          # seconds before it appears
NOTEBOOK = "ZMQInteractiveShell"        # of IPython: that of a notebook


class Progress:
    """A bar, shown when a run takes longer than a second: on standard error if it is a terminal.

    A notebook shows it as one line that changes; pipes and files have none.

    Parameters
    ----------
    t_end : float, optional
        End of the run [time]; none of work that is no run.
    """

    def __init__(self, t_end: float | None = None) -> None:
        self.began = time.perf_counter()
        self.shown = False
        self._t_end = t_end
        self._repeats = 0               # of runs within a tolerance, which begin again
        self._first = self._last = 0.0, self.began      # part that was done, and when
        self._width = 0
        self._notebook = _notebook()
        self._line: Any = None          # of a notebook, once there is something to show

    def __call__(self, fraction: float) -> None:
        """Draw the part of the run that is done, between 0 and 1, its rate and the time left."""
        now = time.perf_counter()
        if fraction < self._last[0]:
            self._repeats += 1
            self._first = 0.0, self._last[1]
        elif self._last[1] == self.began and not self._repeats:
            self._first = fraction, now         # a run that goes on begins somewhere
        self._last = fraction, now
        if now - self.began < PATIENCE or not (self._notebook or sys.stderr.isatty()):
            return
        done = round(BAR * fraction)
        line = (f"[{'#' * done}{'.' * (BAR - done)}] {100 * fraction:3.0f} %"
                f"{self._remarks(fraction, now)}")
        if self._notebook:
            self._display(line)
            return
        print("\r" + line.ljust(self._width), end="", file=sys.stderr, flush=True)
        self._width = len(line)
        self.shown = True

    def close(self) -> None:
        """End the line of the bar."""
        if self.shown:
            print(file=sys.stderr)

    def _display(self, line: str) -> None:
        """Show a line in a notebook in the place of the one before."""
        content = {"text/plain": line}
        if self._line is None:
            self._line = self._notebook.display(content, raw=True, display_id=True)
        else:
            self._line.update(content, raw=True)

    def _remarks(self, fraction: float, now: float) -> str:
        """Simulated time, rate and time left."""
        passed, part = now - self._first[1], fraction - self._first[0]
        going = passed > 0 and part > 0
        left = f"{_duration((1.0 - fraction) * passed / part)} left" if going else ""
        if self._t_end is None:
            return f"  {left}"
        text = f"  t = {self._t_end * fraction:.4g} of {self._t_end:.4g}"
        if going:
            text += f", {self._t_end * part / passed:.3g} a second, {left}"
        return text + (f", run {self._repeats + 1}" if self._repeats else "")


@contextmanager
def showing(progress: Callable[[float], None] | bool | None, t_end: float | None = None
            ) -> Iterator[Callable[[float], None] | None]:
    """Callback of a run: a function, or a bar for True.

    Parameters
    ----------
    t_end : float, optional
        As of `Progress`.

    Raises
    ------
    InputError
        Anything else.
    """
    if progress is True:
        bar = Progress(t_end)
        try:
            yield bar
        finally:
            bar.close()
    elif progress is None or progress is False:
        yield None
    else:
        remedy = "give a function of the part that is done, or True for a bar"
        inputs.function(progress, "progress", remedy)
        try:
            signature(progress).bind(0.5)
        except TypeError as error:
            raise inputs.refusal("progress", progress, remedy) from error
        except ValueError:      # a function that does not tell what it takes
            pass
        yield progress


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02d} min"
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"


def _notebook() -> Any:
    """Display of the notebook that the program runs in; None if it runs elsewhere."""
    shell = sys.modules.get("IPython")
    if shell is None or type(shell.get_ipython()).__name__ != NOTEBOOK:
        return None
    return shell.display
