"""Outputs by name, as a tape that compiled code evaluates."""

from collections.abc import Iterable

from sebody.basics.errors import InputError
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.control_parts import Sensor
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.quantities.expressions import Tape
from sebody.quantities.reading import Reading, reading
from sebody.quantities.symbols import NoTape
from sebody.results import naming
from sebody.results.tapes import States


class Quantities:
    """Outputs that compiled code evaluates of a model."""

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State):
        self._parts = model, numbering, system, state, state.now.copy()
        self._recording = States(*self._parts).recording

    def names(self, names: Iterable[str]) -> list[str]:
        """Names of numbers: of a vector those of its components.

        Raises
        ------
        InputError
            A name that nothing has.
        """
        listed = []
        for name in names:
            values = naming.look_up(self._recording, name)
            listed += [name + "." * bool(label) + label
                       for label in naming.component_names(values, name)]
        return listed

    def made(self, names: list[str], sensors: list[Sensor]) -> Reading:
        """Outputs of some numbers, then of what sensors measure.

        Raises
        ------
        InputError
            A quantity that compiled code cannot evaluate.
        """
        states = States(*self._parts)
        for name, axes in [(name, "") for name in names] + [(s.quantity, s.axes) for s in sensors]:
            try:
                states.put(name, axes)
            except NoTape as error:
                raise InputError(
                    f"output {name!r} cannot be compiled, as {error} cannot: motion of nodes, "
                    "modes and FE nodes, angles of joints, forces and moments of joints, loads and "
                    "supports, stresses, works, energies, sensors and signals can") from error
        return states.reading()


def no_outputs() -> Reading:
    """Outputs of nothing, for their types."""
    return reading(Tape())
