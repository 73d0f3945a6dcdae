"""Results of a run by name: histories of nodes and bodies, energies, the output file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.units import Units, parsed_units
from sebody.engine.clock import CONTROL
from sebody.engine.scalars import record
from sebody.model.summary import table
from sebody.quantities import names
from sebody.results import dataframes, naming
from sebody.results.cautions import cautions, kernels_that_pay
from sebody.results.contact_states import normal_forces
from sebody.results.field import Field
from sebody.results.field_quantities import field_of
from sebody.results.hot_spots import HotSpots, hot_spots
from sebody.results.least_norm import arm
from sebody.results.naming import saved
from sebody.results.recording import Recording
from sebody.results.saving import unpacked, write
from sebody.results.static_summary import is_static, static_lines
from sebody.results.vtk_series import save_vtk

LABELS = 21             # columns of the labels of a summary

# names that other programs have, and what is meant here
MEANT = {"time": "result.t", "times": "result.t",
         "plot": 'sebody.results.plot(result, "tip.position")',
         "animate": 'sebody.results.animate(result, "file.html")',
         "at": 'result["tip.position"][k] in the state k, of the time result.t[k]',
         "keys": "result.names()", "quantities": "result.names()"}


class Result(Recording):
    """Histories on the output grid; ``result["tip.position"]`` by the rule ``<node>.<quantity>``.

    `names` lists what there is, ``"tip.position" in result`` says whether there is something.
    Components of a quantity have its name and theirs, ``result["tip.position.y"]``, (n,): x, y, z
    and norm of vectors, also of rotations by their rotation vector, xx, xy, ... of rotation
    matrices and stresses, 0, 1, ... of everything else. Plots, ensembles, sweeps, advice and
    frequency responses have the same names.

    Quantities of a node: position, velocity, acceleration (n, 3), rotation (n, 3, 3),
    angular_velocity and angular_acceleration (n, 3), all in global axes; in a plane (n, 2) and
    (n,); where it is fixed or prescribed reaction and reaction_moment.
    Of the model: energy.kinetic, energy.strain (springs included), energy.potential,
    energy.external_work (n,), momentum and angular_momentum about the origin (n, 3),
    constraints.position and constraints.velocity, the largest residuals (n,).

    Forces and moments are in global axes and in balance with the motion of the bodies. Moments on
    a node are about this node; in a plane they are numbers (n,).

    ============================  ==================================================================
    ``<joint>.force, .moment``    (n, 3) what the joint gives `node`, the first of its arguments,
                                  from `to` or the ground; the other gets the opposite. Joints
                                  that take no equation have theirs from the balance of the nodes
    ``<joint>.local_force``       (n, 3) the same in the axes of the joint: the first along its axis
    ``<joint>.local_moment``      (of a universal joint `axis`, then `other`; of a distance the line
                                  to the other node, tension is positive), turning with `node`, of a
                                  slider with `to`; global axes at the start if it has no axis
    ``<joint>.multipliers``       (n, m) of its equations
    ``<joint>.angle, .rate``      (n,) of a joint that turns about one axis, from the start
    ``<joint>.displacement``      (n,) of a joint that slides, and ``<joint>.speed``, its rate; on a
                                  path ``<joint>.way`` and ``<joint>.rate``
    ``<contact>.normal_force``    (n,) of contacts, stops and friction; also gap, sticks,
                                  dissipation
    ``<sensor>.value``            (n,) of sensors, signals and actuators
    ``<drive>.torque, .thrust``   (n,) of a drive of an angle or a displacement: positive where it
                                  drives the motion onwards. Times the rate of the motion it is the
                                  power
    ``<load>.force, .moment``     (n, 3) of a load, spring or bushing on its node, the first if it
                                  has two
    ``<name>.power, .work``       (n,) given to the model by a load, damper or drive
    ``<body>.<node>.force``       (n, 3) of everything else on a body at one of its nodes, and
    ``<body>.<node>.moment``      likewise the moment
    ``<body>.forces``             (n, coordinates) the same of all its places: positions, then
                                  rotations, then modes
    ``<body>.modes``              (n, m) of a superelement
    ``<body>.node<k>.velocity``   (n, 3) of an FE node inside a superelement: position, velocity,
                                  acceleration, displacement, stress (n, 6), von_mises (n,), of
                                  beams section_forces (n, ends of elements, 6); see `field`
    ============================  ==================================================================
    """

    if not TYPE_CHECKING:       # for them, a result has the attributes that are written here
        def __getattr__(self, name):
            """Refuse what there is not, and say what does what some names ask for."""
            meant = f": use {MEANT[name]}" if name in MEANT else ""
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}{meant}",
                                 name=name, obj=self)

    @property
    def t(self) -> NDArray:
        """Output times [time]."""
        return self["t"]

    @property
    def steps(self) -> int:
        """Accepted steps, those of reduced size included."""
        return int(record(CONTROL, self.counters).steps)

    @property
    def cuts(self) -> int:
        """Rejected steps, repeated with shorter ones.

        Newton's iteration did not converge, or energy grew although nothing supplied it.
        """
        return int(record(CONTROL, self.counters).cuts)

    @property
    def matrices(self) -> int:
        """Number of factorizations of the iteration matrix."""
        return int(record(CONTROL, self.counters).matrices)

    @property
    def iterations_per_step(self) -> float:
        """Newton iterations a step."""
        return float(record(CONTROL, self.counters).iterations) / max(self.steps, 1)

    @property
    def microseconds_per_step(self) -> float:
        """Time in the compiled loop per step."""
        return 1e6 * self.seconds / max(self.steps, 1)

    def __getitem__(self, name: str) -> NDArray:
        """History of a quantity, a component or a group by name; see the class.

        Raises
        ------
        InputError
            A name that nothing has; the message has names that are like it.
        """
        return naming.look_up(self, name)

    def __contains__(self, name: object) -> bool:
        """Tell whether there is a quantity, a component or a group of this name."""
        return naming.is_known(self, name)

    def __iter__(self) -> Iterator[str]:
        """The names of `names`."""
        return iter(self.names())

    def names(self) -> list[str]:
        """Names of all quantities, those of FE nodes inside bodies left out: these are many."""
        return names.names(self)

    def field(self, name: str) -> Field:
        """Displacements, velocities and accelerations of the FE nodes of a superelement.

        Raises
        ------
        InputError
            No such superelement, or one without the shapes of an FE model.
        """
        inputs.name(name, "name of a superelement")
        return field_of(self, name)

    def hot_spots(self, name: str, count: int = 10, apart: float = 0.0) -> HotSpots:
        """The most stressed FE nodes of a superelement over the whole run, as a table.

        Parameters
        ----------
        name : str
            Of the superelement.
        count : int
            How many nodes.
        apart : float
            Least distance between two of them, so that neighbours count as one spot [length].

        Raises
        ------
        InputError
            No such superelement, or one without stresses; the message says why.
        """
        return hot_spots(self.field(name), count, apart, self.units)

    @property
    def units(self) -> Units | None:
        """Units of the model, if it has some."""
        return parsed_units(self.model.units)

    @property
    def cautions(self) -> list[str]:
        """Lacks of bodies, and why: stresses, stiffening, exact inertia; implausible materials."""
        return cautions(self.model)

    @cached_property
    def advice(self) -> dict[str, list[str]]:
        """Commands that make faster kernels, and the bodies that gain by each."""
        return kernels_that_pay(self.model)

    def arrays(self) -> dict[str, NDArray]:
        """All named histories, as they are saved."""
        return {name: self[name] for name in saved(self)}

    def save(self, path: str | Path) -> Path:
        """Write a file .npz or .h5: all named histories, and all that `load` needs.

        The second (extra ``hdf5``) has units in words, too.

        Raises
        ------
        InputError
            A target that cannot be written, see `check_target`, or h5py is missing.
        WriteError
            Writing fails; an older file is unchanged.
        """
        return write(self, self.arrays(), self.advice, path)

    def save_vtk(self, path: str | Path, every: int = 1) -> Path:
        """Write a series .pvd of VTK files, which ParaView opens (extra ``vtk``).

        Places, displacements of deformation, velocities and von Mises's stress of all FE nodes,
        and the nodes of the model; see `sebody.results.vtk_series.save_vtk`.

        Parameters
        ----------
        path : str or Path
            ``NAME.pvd``; the files of the states go to a folder NAME beside it.
        every : int
            Write every so many recorded states.

        Raises
        ------
        InputError
            A target that cannot be written, or meshio is missing.
        WriteError
            Writing fails; the states that are written remain, with a series of them.
        """
        return save_vtk(self, path, every)

    def to_pandas(self, names: Iterable[str] | None = None) -> dataframes.DataFrame:
        """Histories as columns, ``tip.position.x``, indexed by time (extra ``tables``).

        Parameters
        ----------
        names : iterable of str, optional
            Of quantities; those an output file holds by default.

        Raises
        ------
        InputError
            pandas is missing, or a name that nothing has.
        """
        return dataframes.to_pandas(self, names)

    def to_xarray(self, names: Iterable[str] | None = None) -> dataframes.Dataset:
        """Histories as variables with their units in words (extra ``tables``); see `to_pandas`."""
        return dataframes.to_xarray(self, names)

    @classmethod
    def load(cls, path: str | Path) -> Result:
        """A result that `save` has written: it can be asked for all that the saved one could be.

        Its `model` is a description: compiled functions are left out, so it cannot be run.

        Raises
        ------
        InputError
            No such file, or one of another kind or version.
        """
        return unpacked(cls, path)

    def _repr_html_(self) -> str:
        """HTML that notebooks show: the summary as a table."""
        lines = (line.partition("  ") if len(line) < LABELS else (line[:LABELS], "", line[LABELS:])
                 for line in self.summary().splitlines())
        return table(("run", ""), [(name.strip(), value.strip()) for name, _, value in lines])

    def summary(self) -> str:
        """A few lines: steps, iterations, time, balances, works, changes of the initial state.

        Of an equilibrium load steps, iterations and the largest force out of balance.
        """
        lines = static_lines(self) if is_static(self) else [
            f"unknowns             {self.numbering.free}",
            f"steps                {self.steps} ({self.cuts} rejected), to t = {self.t[-1]:.6g}",
            f"iterations per step  {self.iterations_per_step:.2f} "
            f"({self.matrices} iteration matrices)",
            f"time per step        {self.microseconds_per_step:.2f} us in the compiled loop",
            f"energy balance       {self.energy_balance():.2e} of the energy exchanged",
            f"momentum at the end  {_vector(self['momentum'][-1])}, moment "
            f"{_vector(self['angular_momentum'][-1])}",
        ]
        if self.numbering.multipliers and not is_static(self):
            lines.append(f"constraints          largest residual "
                         f"{self['constraints.position'].max():.1e}, of their rates "
                         f"{self['constraints.velocity'].max():.1e}")
        lines += [f"normal forces        of {text}" for text in normal_forces(self.model)]
        # laws do none, nor do welds that lock
        idle = {load.name for load in self.model.loads if load.law is not None} | {
            joint.name for joint in self.model.joints if joint.kind == "weld"}
        lines += [] if is_static(self) else [
            f"work                 {self.recorded('works')[-1, k]:.6g} by {name}"
            for k, name in enumerate(self.numbering.port_names) if name not in idle]
        if self.stability:
            lines.append(f"stability            {self.stability}")
        if self.error is not None:
            lines.insert(2, f"error                {self.error:.2f} of the tolerance, estimated; "
                            f"{1e3 * self.all_seconds:.3g} ms including the coarser runs")
        elif self.all_seconds:
            lines.insert(2, "planned steps        by a run with a larger tolerance, "
                            f"{1e3 * self.all_seconds:.3g} ms including it")
        if self.start and self.start.changed:
            lines.append("solved for           initial velocity of "
                         + ", ".join(f"{name} (by {change:.3g})"
                                     for name, change in self.start.changed.items()))
        if self.start and self.start.untaken:
            lines += [f"not taken over       {', '.join(self.start.untaken)}",
                      f"energy lost          {self.start.lost:.6g} at the start, by the impulse "
                      "that makes velocities fit the joints"]
        lines += [f"at t = {one.time:<14.9g} {one.what}; energy lost {one.lost:.6g}"
                  for one in self.events]
        if self.start and self.start.redundant:
            lines.append("redundant            constraints of " + ", ".join(self.start.redundant)
                         + f"; multipliers of {', '.join(self.start.shared)} are not unique, given "
                         f"are those of least norm (moments divided by {arm(self.model):.4g})")
        lines += [f"general kernel       used for {', '.join(bodies)}: for a faster, specific "
                  f"kernel run {command}"
                  for command, bodies in self.advice.items()]
        lines += [f"caution              {text}" for text in self.cautions]
        lines += [f"WARNING              {message}" for message in self.warnings]
        return "\n".join(lines + ([f"FAILED               {self.failure}"] if self.failure else []))


def _vector(values: NDArray) -> str:
    return "(" + ", ".join(f"{v:.4g}" for v in values) + ")"
