"""Parts that close a loop: sensors, and controllers with what they are given and what they set."""

from collections.abc import Callable
from dataclasses import dataclass

from numpy.typing import NDArray

from sebody.basics.tabular import counted
from sebody.compiler.user_functions import UserFunction

ROUNDING = 1e-9     # of a sample: what is no part of one
MOST_DELAY = 10_000_000     # samples, of sensors and controllers


@dataclass(frozen=True, eq=False, repr=False)
class Sensor:
    """A quantity of the model that is measured: one number."""

    name: str
    quantity: str
    period: float       # between its samples; 0 where it is read whenever a controller asks
    delay: int          # of its samples
    bias: float
    noise: float        # standard deviation
    seed: int
    axes: str = ""      # node in whose axes the quantity is; none: global ones
    gain: float = 1.0   # of the quantity: -1 of one in a plane that counts the other way

    def __repr__(self) -> str:
        rate = f", {1 / self.period:.6g} samples a unit of time" if self.period else ""
        return f"<Sensor {self.name!r} of {self.quantity}{rate}>"


@dataclass(frozen=True, eq=False, repr=False)
class Controller:
    """A compiled function that is called at every sample, or in the equations of motion."""

    name: str
    function: UserFunction
    inputs: tuple[str, ...]         # names of sensors, of signals and of actuators
    outputs: tuple[str, ...]        # names of actuators, else of signals
    period: float                   # 0 of a continuous one
    delay: float                    # of its outputs, in samples
    states: NDArray                 # at the start
    parameters: NDArray
    _refuse: Callable[[NDArray], None] | None = None    # of a ready law
    # of a continuous one whose states are those of its law: see `Flow`
    at_rest: Callable[[NDArray], NDArray] | None = None

    def check_parameters(self) -> None:
        """Refuse parameters that the builder of a ready law refuses.

        Raises
        ------
        InputError
            The message names what is wrong.
        """
        if self._refuse is not None:
            self._refuse(self.parameters)

    @property
    def whole_delay(self) -> int:
        """Whole samples of the delay."""
        return int(self.delay + ROUNDING)

    @property
    def rest(self) -> float:
        """Time from a sample to when outputs act, beside whole samples."""
        part = self.delay - self.whole_delay
        return part * self.period if part > ROUNDING else 0.0

    def __repr__(self) -> str:
        course = f"period {self.period:.6g}" if self.period else "continuous"
        return (f"<Controller {self.name!r} from {', '.join(self.inputs) or 'nothing'} to "
                f"{', '.join(self.outputs)}: {course}, "
                f"{counted(len(self.states), 'state')}>")
