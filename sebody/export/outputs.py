"""Outputs by name: as channels of sensors, or in other ways that compiled code evaluates."""

from collections.abc import Iterable

from sebody.assembly.channels import channel
from sebody.assembly.numbering import Numbering
from sebody.basics.errors import InputError
from sebody.contract.law_row import OUTSIDE
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.export.nodal import MISES, STRESSES, Nodal
from sebody.export.program import Program, Term
from sebody.export.quantities import VALUE, Outputs
from sebody.export.terms import Terms
from sebody.model.control_parts import Sensor
from sebody.model.mechanism import Mechanism
from sebody.results import naming
from sebody.results.field_quantities import FENodes


class Quantities:
    """What compiled code evaluates of a model.

    Parameters
    ----------
    gravity_set : bool
        Whether gravity is an input: stresses follow from what it is here.
    """

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State,
                 gravity_set: bool = False):
        self.model, self.numbering, self.system, self.state = model, numbering, system, state
        self._gravity_set = gravity_set
        self._terms = Terms(model, numbering, system, state)

    def names(self, names: Iterable[str]) -> list[str]:
        """Names of numbers: of a vector those of its components.

        Raises
        ------
        InputError
            A name that nothing has.
        """
        listed = []
        for name in names:
            values = naming.look_up(self._terms.recording(), name)
            listed += [name + "." * bool(label) + label
                       for label in naming.component_names(values, name)]
        return listed

    def made(self, names: list[str], sensors: list[Sensor]) -> Outputs:
        """Outputs of some numbers, then of what sensors measure.

        Raises
        ------
        InputError
            A quantity that compiled code cannot evaluate.
        """
        asked = [(name, "") for name in names] + [(s.quantity, s.axes) for s in sensors]
        program, read = Program(len(asked)), dict[int, str]()
        nodal = Nodal(self.model, self.numbering, self._terms.recording(), program)
        for k, (name, axes) in enumerate(asked):
            self._put(program, nodal, read, k, name, axes)
        own = [(k, name) for k, (name, _) in enumerate(asked) if program.channels[k] is None]
        if own:
            known = {k: self._terms.values(name, self._terms.states) for k, name in read.items()
                     if k >= len(asked)}
            values = program.evaluated(self._terms.numbers_of(program), known)
            for k, name in own:
                if not self._terms.agree(name, values[k]):
                    raise _refused(name)
        return program.outputs(self.state)

    def _put(self, program: Program, nodal: Nodal, read: dict[int, str], k: int, name: str,
             axes: str) -> None:
        """Enter a quantity as output k; `read` has the names of those that channels read."""
        own = channel(self.model, self.numbering, name, axes)
        if own.places[0] != OUTSIDE:
            program.channels[k], read[k] = own, name
            return
        if axes:
            raise _refused(name)
        recording = self._terms.recording()
        whole, components = naming.split(recording, name)
        if components[-1:] == [naming.NORM]:
            self._put_norm(program, nodal, read, k, name.rpartition(".")[0])
            return
        owner, _, quantity = whole.rpartition(".")
        if owner not in self.model.nodes and owner in FENodes(recording):
            if self._gravity_set and quantity in (*STRESSES, MISES):
                raise InputError(f"output {name!r} follows from gravity, which is an input here: "
                                 "leave one of them out")
            if not nodal.put(k, owner, quantity, ".".join(components)):
                raise _refused(name)
            return
        terms = self._terms.found(name)
        if terms is None or self.system.regularized[0] and self._terms.shared.intersection(
                factor for term in terms for factor in term.factors):
            raise _refused(name)
        program.put(k, terms)

    def _put_norm(self, program: Program, nodal: Nodal, read: dict[int, str], k: int,
                  vector: str) -> None:
        """Enter the length of a vector as output k."""
        parts = []
        for name in self.names([vector]):
            parts.append(program.add(()))
            self._put(program, nodal, read, parts[-1], name, "")
        program.put_root(k, [Term(1.0, ((VALUE, part), (VALUE, part))) for part in parts])


def _refused(name: str) -> InputError:
    return InputError(
        f"output {name!r} cannot be compiled: motion of nodes, modes and FE nodes, angles of "
        "joints, forces and moments of joints, loads and supports, stresses, works, energies, "
        "sensors and signals can; forces cannot where constraints are redundant")


def no_outputs() -> Outputs:
    """Outputs of nothing, for their types."""
    return Program(0).outputs(None)
