"""Comparison of quantities: at all times, by one number, below a frequency; tolerances in units.
"""

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from sebody.basics.errors import InputError
from sebody.basics.units import FORCES, LENGTHS, PRESSURES, parsed_units

KINDS = "peak", "rms", "final"
WORDS = re.compile(r"(?P<name>[^<]+?)(?: < (?P<cut>\S+) Hz)?(?: (?P<kind>peak|rms|final))?")
ORDER = 4               # of the filter, which runs forth and back
SAMPLED = 0.4           # of the sampling rate, from which a limit changes nothing that is recorded
TOLERANCE = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?) *([A-Za-z]*)", re.ASCII)
ANGLES = {"rad": 1.0, "mrad": 1e-3, "deg": np.pi / 180}
SI = "m kg N s"
REMEDY = ("give a name of results, such as tip.position, and behind it '< 50 Hz' or peak, rms or "
          "final unless the whole history is compared")


class Measure(NamedTuple):
    """A history by its name, what of it counts (``""``: all), and the frequency it is cut at."""

    name: str
    kind: str = ""
    cut: float | None = None

    @classmethod
    def of(cls, text: str) -> "Measure":
        """As ``tip.position < 50 Hz rms`` says it.

        Raises
        ------
        InputError
            Other words.
        """
        match = WORDS.fullmatch(text)
        cut = match and match["cut"] and _frequency(match["cut"], text)
        if not match:
            raise InputError(f"quantity {text!r} is unclear: {REMEDY}")
        return cls(match["name"], match["kind"] or "", cut or None)

    @property
    def words(self) -> str:
        """Part of the history that counts, as behind its name."""
        cut = "" if self.cut is None else f"< {self.cut:g} Hz"
        return f"{cut} {self.kind}".strip()

    def filtered(self, history: NDArray, h: float, grid: float) -> NDArray:
        """A history recorded with a step, without what is faster than the limit.

        Where the grid that runs are compared on is too coarse for the limit, nothing is cut.
        """
        if self.cut is None or self.cut * max(h, grid) >= SAMPLED or len(history) < 3 * ORDER:
            return history
        sections = butter(ORDER, self.cut, fs=1.0 / h, output="sos")
        padding = min(len(history) - 1, int(3.0 / (self.cut * h)))
        return sosfiltfilt(sections, history, axis=0, padlen=padding)

    def size(self, history: NDArray) -> float:
        """Size that differences are relative to: largest change from the start, or mean one."""
        changes = lengths(history - history[0])
        return float(np.sqrt(np.mean(changes**2)) if self.kind == "rms" else changes.max())

    def difference(self, one: NDArray, other: NDArray) -> tuple[float, int]:
        """Difference of two histories of the same times, and the row it is at."""
        off = lengths(one - other)
        if self.kind == "final":
            return float(off[-1]), len(off) - 1
        if self.kind == "rms":
            return float(np.sqrt(np.mean(off**2))), int(np.argmax(off))
        if self.kind == "peak":
            a, b = (lengths(history - history[0]) for history in (one, other))
            return float(abs(a.max() - b.max())), int(np.argmax(b))
        return float(off.max()), int(np.argmax(off))


def _frequency(text: str, what: str) -> float:
    """The frequency of a limit."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if value <= 0.0:
        raise InputError(f"quantity {what!r}: frequency is {text!r}: give a number above 0")
    return value


def lengths(values: NDArray) -> NDArray:
    """Norms of the states of a history, (n,)."""
    return np.sqrt((values**2).sum(axis=tuple(range(1, values.ndim))))


def absolute(tolerance: str, units: str) -> tuple[float, bool]:
    """A tolerance as text in the model's units, and whether it is absolute.

    ``1e-3`` is relative, ``2mm`` and ``0.5 deg`` are absolute. Models without units are taken to
    be in metres, newtons and seconds.

    Raises
    ------
    InputError
        No number, or a unit that is not known.
    """
    match = TOLERANCE.fullmatch(tolerance.strip())
    if not match:
        raise InputError(f"tolerance is {tolerance!r}: give a number, such as 1e-3, or one with a "
                         "unit, such as 2mm")
    number, unit = float(match[1]), match[2]
    if not unit:
        return number, False
    if unit in ANGLES:
        return number * ANGLES[unit], True
    own = parsed_units(units or SI)
    for known, words in ((LENGTHS, "length"), (FORCES, "force"), (PRESSURES, "force/length^2")):
        if unit in known:
            return number * known[unit] / own.factor(words), True
    raise InputError(f"tolerance is {tolerance!r}: the unit {unit!r} is unknown: give one of "
                     f"{', '.join((*LENGTHS, *FORCES, *PRESSURES, *ANGLES))}")
