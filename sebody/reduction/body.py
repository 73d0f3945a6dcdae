"""The superelement in the form the multibody code takes: reduced matrices and their layout."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from weakref import WeakKeyDictionary, WeakValueDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import counted
from sebody.basics.units import parsed_units
from sebody.fem.materials import Material, checked_materials
from sebody.reduction import checks
from sebody.reduction.damping import modal_damping
from sebody.reduction.invariant_checks import check_invariants
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.loads import named_outputs, named_vectors
from sebody.reduction.missing import checked_missing, lacks, sentences
from sebody.reduction.preload import Preload, preload_of
from sebody.reduction.recovery import Recovery
from sebody.reduction.recovery_checks import check_recovery, checked_paths
from sebody.reduction.rigid_motions import first_moment, rigid_motions, strainless_coordinates
from sebody.reduction.summary import mode_lines, place

# bodies that are in use, by the rotation of what they were made of
_rotated: WeakKeyDictionary[ReducedBody, WeakValueDictionary[bytes, ReducedBody]] = (
    WeakKeyDictionary())


ORTHONORMAL = 1e-14     # defect of a rotation up to which it is one but for rounding


def _read_only(array: NDArray) -> NDArray:
    """The array itself, refusing changes: what is computed of a body once stays true."""
    array.flags.writeable = False
    return array


@dataclass(frozen=True, eq=False)
class ReducedBody:
    """Reduced stiffness and mass of a free body, in the axes of its FE model (24), (37).

    The reduced coordinates are ordered ``y = (u_B, psi_B, y_I)``: position DOF blocks of the
    boundary nodes that keep them, in node order, rotation DOF blocks likewise, internal modes.
    Planar bodies have (x, y) and one angle instead of DOF blocks.

    Parameters
    ----------
    stiffness, mass : (n, n)
        Reduced matrices; stored exactly symmetric and read-only.
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
        Boundary nodes in the FE axes [length].
    keeps : tuple of 'full', 'translation' or 'rotation', one per boundary node
        DOF blocks kept at each node (23), (39).
    modes : int
        Number of internal modes.
    damping : (n, n), optional
        Reduced damping matrix, acting on the rates of deformation; see `damped`.
    invariants : InertiaInvariants, optional
        What inertia option C needs beyond the reduced matrices.
    recovery : Recovery, optional
        Shapes of the FE model, for `displacements`.
    notes : tuple of str
        How the body was made, in sentences, for `summary`.
    loads : mapping of str to (n,), optional
        Reduced loads by name, ``Phi^T p``; see `Model.body_load`.
    outputs : mapping of str to (m, n)
        Output matrices by name, such as stresses of unit reduced coordinates that an FE program has
        computed: the quantities ``<body>.<name>.values`` of results.
    missing : mapping of str to str
        Why the body has no 'stresses', 'stiffening' or 'exact inertia', ``why; what to do``.
    materials : tuple of Material
        What it is made of.
    units : str
        Units of its numbers, such as ``mm t N s``; empty if they are not known.
    base : int, optional
        Boundary node that is the base of a body held to the ground, see `grounded_body`.
    preload : Preload or (n,), optional
        Forces on the interfaces that hold the undeformed body, which is under stress. They are
        carried by lines between the interfaces, whose stiffness is not in `stiffness`: models get
        springs in their place, see `sebody.reduction.preload`.
    paths : mapping of str to (k,) of int
        FE nodes of paths by name, in order, which `Model.path` takes for its nodes; by their
        numbers in the FE model, among those of the recovery.

    Raises
    ------
    InputError
        Shapes that do not fit, values that are not finite, asymmetric matrices, indefinite mass,
        no mass, negative stiffness, or a stiffness that resists rigid motion.
    """

    stiffness: NDArray
    mass: NDArray
    coordinates: NDArray
    keeps: tuple[str, ...]
    modes: int = 0
    damping: NDArray | None = None
    invariants: InertiaInvariants | None = None
    recovery: Recovery | None = None
    notes: tuple[str, ...] = ()
    loads: Mapping[str, NDArray] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)
    materials: tuple[Material, ...] = ()
    units: str = ""
    outputs: Mapping[str, NDArray] = field(default_factory=dict)
    base: int | None = None
    preload: Preload | None = None
    paths: Mapping[str, NDArray] = field(default_factory=dict)
    # of a rotated body what it was made of, and the rotation; `replace` does not take it over
    _made_of: tuple[ReducedBody, NDArray] | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        coordinates = inputs.reals(self.coordinates, "coordinates",
                                   "give one row of numbers per boundary node")
        keeps = tuple(inputs.items(self.keeps, "keeps", "give a text per boundary node"))
        object.__setattr__(self, "modes", inputs.integer(self.modes, "modes", least=0))
        checks.check_layout(coordinates, keeps)
        rows = np.shape(self.stiffness)[:1]
        if rows and self.modes > rows[0]:
            raise inputs.refusal("modes", self.modes, f"the stiffness has {rows[0]} rows in all, "
                                 "give fewer")
        names = checks.coordinate_names(keeps, coordinates.shape[1], self.modes)
        if self.base is not None:
            checks.check_base(self.base, keeps)
        self._store("coordinates", coordinates)
        object.__setattr__(self, "keeps", keeps)
        remedy = "give a list of texts"
        notes = inputs.items(self.notes, "notes", remedy)
        if not all(isinstance(note, str) for note in notes):
            raise inputs.refusal("notes", self.notes, remedy)
        object.__setattr__(self, "notes", tuple(notes))
        for name in ("stiffness", "mass", "damping"):
            if (matrix := getattr(self, name)) is not None or name != "damping":
                self._store(name, checks.symmetric_matrix(matrix, name, names, coordinates))
        rigid = self.rigid_modes_about(coordinates.mean(axis=0))
        # a point without rotary inertia is a body: what moves it as a whole may be left out
        checks.check_live(self.stiffness, self.mass, names,
                          strainless_coordinates(keeps, coordinates.shape[1]))
        checks.check_stiffness(self.stiffness, rigid, names)
        checks.check_mass(self.mass, rigid, names)
        if self.preload is not None:
            object.__setattr__(self, "preload", preload_of(self.preload, coordinates, keeps,
                                                           len(names)))
        if self.damping is not None:
            checks.check_damping(self.damping, rigid, names)
        if self.invariants is not None:
            inputs.instance(self.invariants, "invariants", InertiaInvariants,
                            "give InertiaInvariants, as a reduction makes them")
            check_invariants(self.invariants, self.stiffness, self.mass,
                             self.rigid_modes_about(self.invariants.origin), names)
        if self.recovery is not None:
            inputs.instance(self.recovery, "recovery", Recovery,
                            "give a Recovery, as a reduction makes it")
            check_recovery(self.recovery, self.planar, len(names), len(names) - self.modes,
                           self.invariants and self.invariants.slaved)
        loads = named_vectors(self.loads, len(names), "coordinates of the body")
        object.__setattr__(self, "loads", {n: _read_only(load) for n, load in loads.items()})
        object.__setattr__(self, "outputs", {name: _read_only(matrix) for name, matrix in
                                             named_outputs(self.outputs, len(names)).items()})
        object.__setattr__(self, "paths", {name: _read_only(nodes) for name, nodes in
                                           checked_paths(self.paths, self.recovery).items()})
        object.__setattr__(self, "missing", checked_missing(self.missing))
        object.__setattr__(self, "materials", checked_materials(self.materials))
        object.__setattr__(self, "units", str(parsed_units(self.units) or ""))

    def _store(self, name: str, array: NDArray) -> None:
        object.__setattr__(self, name, _read_only(array))

    @property
    def planar(self) -> bool:
        """Tell whether the body lives in the xy plane."""
        return self.coordinates.shape[1] == 2

    @cached_property
    def position_nodes(self) -> tuple[int, ...]:
        """Boundary nodes that keep their position."""
        return tuple(i for i, keep in enumerate(self.keeps) if keep != "rotation")

    @cached_property
    def rotation_nodes(self) -> tuple[int, ...]:
        """Boundary nodes that keep their rotation."""
        return tuple(i for i, keep in enumerate(self.keeps) if keep != "translation")

    @cached_property
    def rests(self) -> bool:
        """Tell whether its base must stay at rest: it is held and has no coupling with its base."""
        if self.base is None:
            return False
        at = [*self._rows_of("position", self.base), *self._rows_of("rotation", self.base)]
        return not self.mass[at].any()

    def _rows_of(self, kind: str, node: int) -> range:
        """Reduced coordinates of a DOF block of a boundary node that keeps it."""
        d, r = (2, 1) if self.planar else (3, 3)
        if kind == "position":
            return range(first := d * self.position_nodes.index(node), first + d)
        first = d * len(self.position_nodes) + r * self.rotation_nodes.index(node)
        return range(first, first + r)

    @cached_property
    def rigid_modes(self) -> NDArray:
        """Unit rigid translations and rotations about the FE origin, (n, 6), planar (n, 3)."""
        return _read_only(self.rigid_modes_about(np.zeros(self.coordinates.shape[1])))

    def rigid_modes_about(self, point: ArrayLike) -> NDArray:
        """Rigid modes with rotations about `point`: rows e, e x (X_i - point); e; zero."""
        point = inputs.vector(point, "point", self.coordinates.shape[1])
        return rigid_motions(self.coordinates, self.keeps, len(self.mass), point)

    @cached_property
    def total_mass(self) -> float:
        """Mass from the rigid translations."""
        dimension = self.coordinates.shape[1]
        translations = self.rigid_modes[:, :dimension]
        return float(np.trace(translations.T @ self.mass @ translations) / dimension)

    @cached_property
    def centre_of_mass(self) -> NDArray:
        """Centre of mass in the FE axes, (3,), planar (2,) [length]."""
        # About the nodes' mean, so that a body far from the origin loses no digits.
        middle = self.coordinates.mean(axis=0)
        first = first_moment(self.mass, self.rigid_modes_about(middle))
        return _read_only(middle + first / self.total_mass)

    @property
    def lacks(self) -> dict[str, str]:
        """The reasons why the body lacks stresses, stiffening or exact inertia."""
        return lacks(self._stressed, self.invariants is not None, self.missing)

    @property
    def cautions(self) -> list[str]:
        """The same in sentences ``no stresses: why; what to do``."""
        return sentences(self.lacks, self._stressed)

    @property
    def _stressed(self) -> bool:
        return self.recovery is not None and bool(self.recovery.stress)

    def __repr__(self) -> str:
        nodes = ", ".join(self.keeps)
        return (f"<ReducedBody: mass {self.total_mass:.6g}, nodes {nodes}, "
                f"{counted(self.modes, 'mode')}>")

    def summary(self) -> str:
        """Order, mass, frequencies and effective masses of the internal modes, and the notes."""
        nodes, n = len(self.coordinates), len(self.mass)
        centre = self.centre_of_mass
        kept = zip(self.coordinates, self.keeps, strict=True)
        return "\n".join([
            f"{nodes} boundary node{'s' * (nodes > 1)}, {n - self.modes} boundary coordinates, "
            f"{self.modes} internal modes",
            f"mass {self.total_mass:.6g}, centre of mass {place(centre)}"
            + " (of motions relative to the base alone)" * self.rests,
            *(f"boundary node {k} at {place(point)} keeps {keep!r}"
              for k, (point, keep) in enumerate(kept)),
            *mode_lines(self.stiffness, self.mass, self.rigid_modes_about(centre), self.modes),
            *([] if self.preload is None else [self.preload.told]),
            *self.notes, *(f"caution: {text}" for text in self.cautions)])

    def displacements(self, y: ArrayLike) -> NDArray:
        """Displacements of all FE nodes, with those of second order, (n_nodes, dofs_per_node).

        Parameters
        ----------
        y : (n,)
            Reduced coordinates, relative to the body's frame.

        Raises
        ------
        InputError
            The body is made of reduced matrices alone.
        """
        if self.recovery is None:
            raise InputError("the body has no shapes of an FE model, so it knows no displacements "
                             "inside; reduce the FE model with craig_bampton")
        y = inputs.vector(y, "y", len(self.mass))
        field = self.recovery.all_dofs(self.with_followers(y[None]))
        return field.reshape(len(self.recovery.coordinates), -1)

    def with_followers(self, y: NDArray) -> NDArray:
        """Reduced coordinates (k, n) with those that follow in second order, (k, N)."""
        if self.invariants is None:
            return y
        return np.hstack([y, np.einsum("ki,bij,kj->kb", y, self.invariants.Q, y) / 2])

    def recovering(self, nodes: Iterable[int]) -> ReducedBody:
        """The same body with the shapes of some FE nodes alone, and of those of its paths.

        Parameters
        ----------
        nodes : iterable of int
            Their numbers in the FE model.

        Raises
        ------
        InputError
            No shapes, no node, or one that is unknown.
        """
        if self.recovery is None:
            raise InputError("recover: the body has no shapes of an FE model to keep a part of")
        count = len(self.recovery.coordinates)
        remedy = f"give nodes of the FE model, from 0 to {count - 1}"
        numbers = [inputs.integer(node, "recover: a node", least=0, most=count - 1, remedy=remedy)
                   for node in inputs.items(nodes, "recover", remedy)]
        if not numbers:
            raise InputError(f"recover names no node: {remedy}")
        numbers += self.recovery.places(self.paths)
        return replace(self, recovery=self.recovery.restricted(np.array(numbers)))

    def damped(self, ratio: float | Sequence[float] = 0.0, *, mass: float = 0.0,
               stiffness: float = 0.0) -> ReducedBody:
        """The same body with structural damping of its deformation.

        Parameters
        ----------
        ratio : float or sequence of float
            Part of critical damping of every free vibration mode, or of each from the lowest
            frequency up; the last number is also that of all modes beyond.
        mass, stiffness : float
            Rayleigh's coefficients, ``mass * M + stiffness * K`` on the vibration modes; rigid
            motion is not damped.

        Raises
        ------
        InputError
            A number that is negative or not finite, more ratios than modes, or a body with
            massless coordinates.
        """
        return replace(self, damping=modal_damping(
            self.stiffness, self.mass, self.rigid_modes,
            strainless_coordinates(self.keeps, self.coordinates.shape[1]), ratio, mass, stiffness))

    def rotated(self, rotation: ArrayLike) -> ReducedBody:
        """The same body rotated by `rotation` about the FE origin, in the old axes.

        Bodies rotated alike are one object as long as it is in use.

        Parameters
        ----------
        rotation : (3, 3), planar (2, 2)
            Proper rotation; a vector of the body a becomes ``rotation @ a``.

        Raises
        ------
        InputError
            `rotation` is not a rotation of the body's dimension.
        """
        rotation = inputs.rotation(rotation, "rotation", self.coordinates.shape[1])
        known = _rotated.setdefault(self, WeakValueDictionary())
        body = known.get(rotation.tobytes())
        if body is None:
            body = known[rotation.tobytes()] = self._rotated(rotation)
            original, before = self.unrotated
            turn = rotation @ before
            if np.abs(turn.T @ turn - np.eye(len(turn))).max() < ORTHONORMAL:
                object.__setattr__(body, "_made_of", (original, _read_only(turn)))
        return body

    @property
    def unrotated(self) -> tuple[ReducedBody, NDArray]:
        """The body this one is by a rotation, and the rotation; itself if `rotated` made it not."""
        return self._made_of or (self, np.eye(self.coordinates.shape[1]))

    def _rotated(self, rotation: NDArray) -> ReducedBody:
        angles = len(self.rotation_nodes)
        by = block_diag(
            np.kron(np.eye(len(self.position_nodes)), rotation),
            np.eye(angles) if self.planar else np.kron(np.eye(angles), rotation),
            np.eye(self.modes),
        )
        return replace(
            self,
            stiffness=by @ self.stiffness @ by.T,
            mass=by @ self.mass @ by.T,
            damping=None if self.damping is None else by @ self.damping @ by.T,
            coordinates=self.coordinates @ rotation.T,
            invariants=self.invariants and self.invariants.rotated(rotation, by),
            recovery=self.recovery and self.recovery.rotated(rotation, by),
            loads={name: by @ load for name, load in self.loads.items()},
            outputs={name: matrix @ by.T for name, matrix in self.outputs.items()},
            preload=self.preload and self.preload.rotated(rotation),
        )
