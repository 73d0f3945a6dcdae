"""A model ready to be exported: its state at the start, memory, inputs, outputs and functions."""

import re
from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.control import begin
from sebody.assembly.equal_bodies import evaluate_alone
from sebody.assembly.motions import motion_kernel
from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.units import parsed_units
from sebody.compiler.choice import way
from sebody.compiler.user_functions import ControlFunction
from sebody.engine.control_data import OUTPUT
from sebody.engine.row_exchanges import Exchanges
from sebody.engine.state import EVALUATED, Scheme
from sebody.engine.system import System
from sebody.export.functions import kernel_module
from sebody.export.image import Image, members
from sebody.export.interface import PARAMETER, Input, placed, with_inputs
from sebody.export.linking import Part
from sebody.export.outputs import Quantities
from sebody.export.settings import settings
from sebody.kernels.loader import element_kernel_name
from sebody.model.control_order import sampled
from sebody.model.model import Model
from sebody.model.path_joints import PATH
from sebody.quantities.reading import Reading
from sebody.results.result import Result
from sebody.results.units import unit
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance
from sebody.runs.user_faults import functions

ROUTINES = "refactorize", "restart", "sample"       # in the order of System.routines


class Run(NamedTuple):
    """The run of an exported model: arguments of `Simulation`."""

    h: float
    tolerance: Tolerance | None = None
    scheme: Scheme | None = None
    start: Result | None = None


class Prepared:
    """A model ready to be exported.

    Attributes
    ----------
    name : str
    identifier : str
        The name as C can have it.
    run : Simulation
        At the start.
    system : System
        Of the run, with a corner to spare for a time that is no output step.
    inputs : list of Input
    names, units : list of str
        Of outputs, which are numbers.
    outputs : Reading
        These, then what sensors measure that the loop cannot read.
    sensors : list of (int, Sensor)
        These sensors and their numbers.
    settings : Settings
        What parameters set.
    image : Image
    kernels : list of str
    called : list of str
        Functions that are called by address.
    calls : list of (int, str)
        Offsets of addresses in the image, and the function that each is of.
    """

    def __init__(self, model: Model, name: str, run: Run, inputs_of: Iterable[str],
                 outputs_of: Iterable[str]):
        self.name = inputs.name(name, "name of the export")
        self.identifier = re.sub(r"\W", "_", name, flags=re.ASCII)
        if not self.identifier[0].isalpha():
            self.identifier = f"model_{self.identifier}"
        refuse_paths(model)
        made, asked = with_inputs(model, inputs_of)
        self.run = Simulation(made, run.h, run.scheme, 1, run.tolerance, run.start)
        evaluate_alone(made, self.run.system)       # others need this machine's vectors
        self.model, self._numbering = made, self.run.numbering
        called_at_samples = {one.name for one in sampled(made)}
        if any(one.name.rpartition(".parameters.")[0] in called_at_samples for one in asked):
            self._ask_for_first_samples()
        self.system = _with_spare_corner(self.run.system)
        quantities = Quantities(made, self._numbering, self.run.system, self.run.state)
        self.names = quantities.names(outputs_of)
        if len(set(self.names)) < len(self.names):
            twice = next(one for one in self.names if self.names.count(one) > 1)
            raise InputError(f"output {twice!r} is given twice: leave one out")
        self.sensors = [(k, sensor) for k, sensor in enumerate(self._numbering.memory.sensors)
                        if self.system.control.sensors[k, OUTPUT] == 0]
        sensors = [s for _, s in self.sensors]
        self.outputs: Reading = quantities.made(self.names, sensors)
        self.settings = settings(
            self.run, self.outputs, [one.name for one in asked if one.kind == PARAMETER],
            lambda *parts: Quantities(made, *parts).made(self.names, sensors))
        units = parsed_units(made.units)
        self.units = [unit(one, units) for one in self.names]
        self.exchanges = Exchanges.of(self._numbering.free, self.system.rows.size)
        self.image = self._image()
        self.inputs: list[Input] = [
            one._replace(unit=units.of(one.unit) if units else one.unit)
            for one in placed(asked, self._numbering, self.system, self.run.state, self.image,
                              self.settings)]
        self._find_calls()

    @property
    def differentiable(self) -> bool:
        """Tell whether outputs have derivatives by inputs: not where motions have no mass.

        An input moves these in the next step, however short it is.
        """
        return not self.system.massless[0]

    def _ask_for_first_samples(self) -> None:
        """Take back the samples of t = 0: parameters of controllers may be set before them."""
        state, bodies = self.run.state, 9 * len(self.model.bodies)
        begin(self.model, self._numbering, self.run.system.control, state.memory, state.frames)
        state.frames_old[bodies:] = state.frames[bodies:]
        self.run.sampling.begin()

    def _image(self) -> Image:
        system, state = self.system, self.run.state
        outputs = self.outputs
        changing = [*members(state), outputs.values, outputs.numbers, outputs.row,
                    outputs.loads, outputs.sums, outputs.moved, outputs.residues,
                    outputs.frames, outputs.work, system.corners, system.jumps,
                    system.table_times, system.table_pieces, *self.settings.arrays,
                    *members(self.settings.values), *members(self.exchanges)]
        state.work[:] = 0.0
        if state.control.wanted == EVALUATED:       # so matrices are made before they are read
            for matrix in (state.J, state.matrix, state.inverse):
                matrix[...] = 0.0
        return Image([system, state, self.outputs, self.exchanges, self.settings.values], changing,
                     [state.work, *members(self.exchanges)])

    def _find_calls(self) -> None:
        """Find addresses in the arrays, and forget them: they are of this process."""
        model, system = self.model, self.system
        bodies = {body.kernel for body in model.bodies.values()}
        elements = {element_kernel_name(one.kind) for one in (
            *model.rigid_bodies.values(), *model.constraints, *model.loads)}
        kernels = {kernel_module(name).kernel.address: name for name in bodies | elements}
        moved = {motion_kernel(body) for body in model.bodies.values()} if (
            self.outputs.bodies.size) else set()
        kernels |= {kernel_module(name).kernel.address: name for name in moved}
        self.kernels = sorted(kernels.values())
        self._users = {function.address: (f"user_{k}", function)
                       for k, (_, function) in enumerate(functions(model))}
        users = {address: name for address, (name, _) in self._users.items()}
        self.calls = [
            *self._in(system.address, kernels), *self._in(system.index, kernels | users),
            *self._in(self.outputs.bodies, kernels),
            *self._in(system.functions, users),
            *self._in(system.control.controllers, users),
            *((self.image.at(system.routines, k), name) for k, name in enumerate(ROUTINES))]
        self.called = list(dict.fromkeys(name for _, name in self.calls))
        self.image.clear([*(at for at, _ in self.calls), self.image.at(system.aid)])

    def _in(self, array: NDArray, known: dict[int, str]) -> list[tuple[int, str]]:
        flat = array.ravel()
        return [(self.image.at(array, int(k)), known[int(flat[k])])
                for k in np.flatnonzero(np.isin(flat, list(known)))]

    def users(self) -> list[Part]:
        """Users' functions without the records of faults."""
        histories = set(self.system.functions.ravel().tolist())
        return [Part(name, "history" if address in histories else
                     "controller" if isinstance(function, ControlFunction) else "force",
                     way().code_of(function.alone()))
                for address, (name, function) in self._users.items()]


def _with_spare_corner(system: System) -> System:
    return replace(system, corners=np.append(system.corners, np.inf),
                   jumps=np.append(system.jumps, 1))


def refuse_paths(model: Model) -> None:
    """Refuse joints on paths, which are looked up by functions that exports do not have."""
    for joint in model.joints:
        if joint.kind == PATH:
            raise InputError(f"joint {joint.name!r} is on a path, which is not exported: leave the "
                             "joint out, or simulate the model in Python")
    for load in model.loads:
        if load.path is not None:
            raise InputError(f"force {load.name!r} moves along a path, which is not exported: "
                             "leave the force out, or simulate the model in Python")
