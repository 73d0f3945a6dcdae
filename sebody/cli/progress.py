"""The bar of a long run."""

import sys
import time

BAR = 40                # characters
PATIENCE = 1.0          # seconds before it appears


class Progress:
    """A bar on standard error, shown on a terminal when a run takes longer than a second."""

    def __init__(self) -> None:
        self.began = time.perf_counter()
        self.shown = False

    def __call__(self, fraction: float) -> None:
        """Draw the part of the run that is done, between 0 and 1."""
        if time.perf_counter() - self.began < PATIENCE or not sys.stderr.isatty():
            return
        done = round(BAR * fraction)
        bar = "#" * done + "." * (BAR - done)
        print(f"\r[{bar}] {100 * fraction:3.0f} %", end="", file=sys.stderr, flush=True)
        self.shown = True

    def close(self) -> None:
        """End the line of the bar."""
        if self.shown:
            print(file=sys.stderr)
