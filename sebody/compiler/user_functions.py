"""Compiled functions of users and controllers, with the arguments of their last fault.

A function has a fault where it raises, or gives what is not finite.
"""

from collections.abc import Callable, Mapping

import numpy as np

from sebody.basics.inputs import shown

FAULT, TIME, OTHERS = range(3)      # of a record: whether there was a fault, its arguments


class UserFunction:
    """A compiled function, and the arguments of its last fault.

    Parameters
    ----------
    function : callable
        As the user wrote it.
    arguments : int
        Numbers it gets, the time included.

    Attributes
    ----------
    interpreted : callable
        The function with helpers of Python alone, which tells what it did at a fault.
    read : mapping
        Values from outside that it was compiled with, by name.
    """

    def __init__(self, function: Callable, arguments: int):
        self.function = self.interpreted = function
        self.read: Mapping[str, object] = {}
        self.record = np.zeros(1 + arguments)
        self.shared = None              # machine code of all equal functions, and what passes
        self.compiled = None            # the record on to it; by `compile_history` and others
        self.alone: Callable            # compiles it without the record, for exports

    @property
    def address(self) -> int:
        """The address of the machine code."""
        return self.compiled.address

    @property
    def ctypes(self) -> Callable:
        """The compiled function, to be called from Python."""
        return self.compiled.ctypes

    def forget(self) -> None:
        """Forget the last fault."""
        self.record[FAULT] = 0.0

    def fault(self, since: float, until: float = np.inf) -> str:
        """The last fault of the function, with its time, in words; empty if at another time."""
        if not (self.record[FAULT] and since <= self.record[TIME] <= until):
            return ""
        t, others = float(self.record[TIME]), self.record[OTHERS:].copy()
        others.flags.writeable = False
        force = np.zeros(others.size // 2)
        try:
            with np.errstate(all="ignore"):
                value = (self.interpreted(t, *np.split(others, 2), force) if others.size else
                         self.interpreted(t))
            did = f"gave {shown(force if others.size else value)}"
        except Exception as error:      # whatever the user's function raises
            did = f"raised {type(error).__name__}: {error}"
        return f"{did} at t = {t:.6g}"


class ControlFunction(UserFunction):
    """A compiled controller, and the arguments of its last fault.

    Parameters
    ----------
    sizes : tuple of int
        Of y, x, u and the parameters.
    rates : int
        How many of the results are rates of x, before those in u: of a continuous law.
    """

    def __init__(self, function: Callable, sizes: tuple[int, int, int, int], rates: int = 0):
        super().__init__(function, 1 + sum(sizes))
        self.sizes, self.rates = sizes, rates

    def fault(self, since: float, until: float = np.inf) -> str:
        """The last fault of the controller, with its time, in words; empty if at another time."""
        if not (self.record[FAULT] and since <= self.record[TIME] <= until):
            return ""
        t = float(self.record[TIME])
        inputs = np.split(self.record[OTHERS:].copy(), np.cumsum(self.sizes)[:-1])
        for k in (0, 3):
            inputs[k].flags.writeable = False
        try:
            with np.errstate(all="ignore"):
                self.interpreted(t, *inputs)
            did = f"gave {self._shown(inputs)}"
        except Exception as error:      # whatever the user's function raises
            did = f"raised {type(error).__name__}: {error}"
        return f"{did} at t = {t:.6g}"

    def _shown(self, inputs: list[np.ndarray]) -> str:
        """The results that are not finite, rates before what is in u; else the states."""
        found = {"rates": inputs[2][:self.rates], "u": inputs[2][self.rates:]}
        wrong = [f"{name} = {shown(values)}" for name, values in found.items()
                 if not np.isfinite(values).all()]
        return " and ".join(wrong) or f"states {shown(inputs[1])}"
