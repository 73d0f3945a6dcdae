"""The numbering of a model: its coordinates, multipliers, power ports and stored numbers."""

from typing import NamedTuple

from numpy.typing import NDArray

from sebody.model.control_parts import Sensor
from sebody.model.histories import of_columns
from sebody.model.parts import DofBlock, Element, Superelement
from sebody.model.time_functions import TimeFunction


class MemoryMap(NamedTuple):
    """Places in `State.frames`."""

    memories: dict[Element, list[int]]  # element -> the numbers that it keeps
    inputs: dict[int, int]      # port of an input -> its first number
    ports: dict[str, int]       # name of an input -> port
    sensors: list[Sensor]       # those of the model, then of quantities that controllers name
    values: dict[str, int]      # name of a sensor, signal or input -> its value
    states: dict[str, int]      # controller -> its first state
    size: int                   # of `State.frames`


class Numbering(NamedTuple):
    """Coordinates: unknowns first, then fixed and prescribed ones, then dependent positions."""

    free: int                           # number of unknowns
    total: int                          # number of coordinates
    dof_blocks: dict[DofBlock, int]        # DOF block -> first coordinate
    rotations: dict[DofBlock, int]       # DOF block -> number of its rotation matrix
    modes: dict[str, int]               # superelement -> first modal amplitude
    multipliers: dict[Element, int]     # constraint -> first multiplier
    names: list[str]                    # of every coordinate
    dependent: list[DofBlock]              # positions at the ends of rigid links
    ports: dict[Element | Superelement, int]    # constraint, load, spring, body -> power port
    port_names: list[str]               # of every power port
    time_functions: list[TimeFunction]            # of every power port
    prescribed: list[tuple[int, int, int, float]]   # coordinate, port, 1 for a rotation, factor
    groups: NDArray                     # where the unknowns of each body begin
    # body, constraint or load -> its first force in State.g
    forces_at: dict[Element | Superelement, int] = {}
    memory_map: MemoryMap | None = None      # what is stored from step to step
    # body or element -> its row in System.constants
    constants_at: dict[Element | Superelement, int] = {}
    bristles: dict[Element, float] = {}     # element -> stiffness of its bristles in the run
    reads: dict[Element, list[int]] = {}    # element -> multipliers of a joint that it reads
    jumps: list[list[float]] = []       # of every power port: when accelerations jump with it
    forced: list[bool] = []             # of every power port: whether it is of a load
    gravity: list[tuple[int, NDArray]] = []     # ports of gravity over time, and their fields
    series: dict[Element, int] = {}     # load -> first amplitude of its series in State.loads

    @property
    def memories(self) -> dict[Element, list[int]]:
        """Memories of elements: places in `State.frames`."""
        return self.memory.memories

    @property
    def courses(self) -> list[tuple[str, TimeFunction]]:
        """Time functions of all power ports, and of the columns of series of loads, with names."""
        found = list(zip(self.port_names, self.time_functions, strict=True))
        for load in self.series:
            assert load.series is not None
            found += [(f"column {column} of {load.name}", one) for column, one in zip(
                load.series.names, of_columns(load.series), strict=True)]
        return found

    @property
    def memory(self) -> MemoryMap:
        """Map of what is stored from step to step, of a numbering that is complete."""
        assert self.memory_map is not None
        return self.memory_map


def coordinates(numbering: Numbering, dof_block: DofBlock) -> list[int]:
    """Coordinates of a DOF block."""
    first = numbering.dof_blocks[dof_block]
    return list(range(first, first + dof_block.start.size))


def stretch(numbering: Numbering, dof_block: DofBlock) -> slice:
    """Coordinates of a DOF block, as a slice."""
    first = numbering.dof_blocks[dof_block]
    return slice(first, first + dof_block.start.size)


def record_counts(numbering: Numbering) -> dict[str, int]:
    """The counts of a model that sizes in `layout.RECORD` and `layout.ENERGIES` refer to."""
    return {"ports": len(numbering.time_functions), "coordinates": numbering.total,
            "rotations": len(numbering.rotations), "stored": numbering.memory.size}
