"""Reductions of FE models behind one interface, all in one form.

The reduced coordinates are those of the boundary, whose shapes are the constraint modes, and
amplitudes of internal shapes that leave the boundary where it is: rigid motions of the boundary are
rigid motions of the body. The methods differ in the internal shapes and the mass.

| method | internal shapes | mass |
|---|---|---|
| ``'guyan'`` | none | projected |
| ``'craig-bampton'`` | vibration modes, boundary clamped | projected |
| ``'rubin'`` | what free vibration modes and inertia loads leave | projected |
| ``'macneal'`` | the same | of the free modes and rigid motions alone |

Rubin's and MacNeal's bases are rigid motions R, elastic modes T of the free body and residual
attachment modes, the answers to boundary forces F less what the modes answer. With inertia relief,
``(I - M R R^T) F``, these answers span, beside R, the constraint modes (forces in equilibrium) and
static responses of the clamped body to the loads M R (the others). With constraint modes Psi and
boundary values L the same space is that of Psi, ``T - Psi L T`` and those answers.

R.J. Guyan, AIAA J. 3, 1965; R.R. Craig and M.C.C. Bampton, AIAA J. 6, 1968; R.H. MacNeal, Comput.
Struct. 1, 1971; S. Rubin, AIAA J. 13, 1975.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg, sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.model import FEModel
from sebody.reduction.accuracy import Accuracy, enough_modes, reached
from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import Boundary, Items, boundary_of
from sebody.reduction.clamped import ClampedInterior, canonical_turn
from sebody.reduction.component import ComponentModes, check_count, static_modes
from sebody.reduction.constants import with_constants, with_shapes
from sebody.reduction.factor import Factor, is_strainless
from sebody.reduction.free import check_connected, check_free
from sebody.reduction.loads import fe_loads, with_residual_modes
from sebody.reduction.massless import MASSLESS
from sebody.reduction.missing import missing_of
from sebody.reduction.path_loads import PathLoads, loaded_paths
from sebody.reduction.rigid_motions import strainless_coordinates
from sebody.reduction.ties import Ties
from sebody.reduction.watch import SILENT, Watch, watching

METHODS = ("craig-bampton", "guyan", "macneal", "rubin")
_WITH_FACES = ("; of the body with its rigid faces, which are stiffer than those of the part: mean "
               "faces (rbe3) do not stiffen it")
_HELD = 1e-3        # part of a row's forces that rigid motion causes, beyond rounding of digits
_DEPENDENT = 1e-10  # strain energy of a shape beside those before it, relative to its own
_MASSLESS = 1e-12  # inverse square of a frequency that is infinite, relative to the largest


def reduce(fe_model: FEModel, boundary: Items, modes: int | Accuracy = 0,
           method: str = "craig-bampton", select: Sequence[int] | None = None,
           recover: Sequence[int] | None = None, loads: Mapping[str, ArrayLike] | None = None,
           residual_modes: bool = False, *,
           paths: Mapping[str, str | Sequence[int] | PathLoads] | None = None,
           judged: bool = False, factor: Factor | None = None,
           progress: Callable[[str], Any] | bool | None = None) -> ReducedBody:
    """Superelement of an FE model by one of four methods; see `sebody.reduction.methods`.

    Parameters
    ----------
    fe_model : FEModel
        Free FE model.
    boundary : mapping or pairs of interface and 'full', 'translation' or 'rotation'
        Interfaces in the order wanted and the DOF blocks kept there: indices of FE nodes,
        `RigidFace` or `MeanFace`, which keep both blocks where they stand by themselves. A DOF
        block not kept is an internal DOF.
    modes : int or Accuracy
        Number of vibration modes, from the lowest frequency up: of the clamped body, for 'macneal'
        and 'rubin' elastic ones of the free body, beside which there are up to 6 (planar 3) more
        internal shapes. Or what the modes are to achieve ('craig-bampton', 'rubin').
    method : 'craig-bampton', 'guyan', 'macneal' or 'rubin'
    select : sequence of int, optional
        For 'craig-bampton': which of the modes to keep, counted from 0; default all.
    recover : sequence of int, optional
        FE nodes whose motion and stress shall be known afterwards, of a large model; all by
        default. Stresses need all nodes of the elements around.
    loads : mapping of str to (n_dofs,), optional
        Loads on the FE DOFs by name, see `sebody.fem.loads`; applied with `Model.body_load`.
    residual_modes : bool
        For 'craig-bampton' and 'guyan': internal modes that make the static response to every
        load exact.
    paths : mapping of str to str, sequence of int or PathLoads, optional
        For 'craig-bampton' and 'guyan', paths by name that nodes of a model will slide along:
        node sets, or FE nodes in order. Static modes of unit loads at 7 of the nodes of each, in
        both directions across, are further internal modes, or as `PathLoads` says; the shapes at
        all its nodes are kept, and `Model.path` takes the name for its `nodes`.
    judged : bool
        Note up to which frequencies the modes are good ('craig-bampton', 'guyan', 'rubin').
    factor : function, optional
        Factors the stiffness in the place of SuperLU, or of PARDISO where pypardiso is installed
        and the matrix is large: of a sparse symmetric matrix (n, n), both
        triangles, an object whose ``solve`` gives the solutions (n, k) of right-hand sides (n, k).
    progress : function of a text, or True, optional
        Is told what takes long, what it will cost, and what costs less; True for lines on standard
        error.

    Returns
    -------
    ReducedBody
        With the constants of its exact inertia if the model has a mass field
        (MacNeal's mass has no mass field), and with those of its stiffening where it has a
        geometric stiffness; see `ReducedBody.summary`.

    Raises
    ------
    InputError
        Unknown or repeated interfaces, blocks that nodes do not have, more modes than there are,
        a boundary that leaves a mechanism inside, loads of another length, or paths that are none.
    """
    inputs.instance(fe_model, "fe_model", FEModel, "give an FEModel")
    if factor is not None:
        inputs.function(factor, "factor", "give a function of a sparse matrix, or leave it out")
    method = inputs.choice(method, "method", METHODS)
    residual_modes = inputs.flag(residual_modes, "residual_modes")
    _check_options(method, modes, select, residual_modes,
                   isinstance(paths, Mapping) and bool(paths))
    watch = watching(progress)
    names, forces = fe_loads(loads, fe_model.stiffness.shape[0])
    edge = boundary_of(fe_model, boundary)
    loaded = loaded_paths(fe_model, paths, edge.nodes)
    matrices, interior, static = clamped(fe_model, edge, watch, method, factor)
    notes = [f"{method} from {matrices[0].shape[0]} DOFs, factored by {interior.factored_by}",
             *edge.notes, *(one.note for one in loaded.values())]
    free = None
    if method in ("craig-bampton", "guyan"):
        if isinstance(modes, Accuracy):
            wanted = modes
            modes, error = enough_modes(static, interior, matrices, wanted, watch)
            what = ("free frequencies" if wanted.of == "frequencies" else
                    "dynamic stiffness of the interface")
            notes.append(f"{what} within {error:.2g} up to the frequency {wanted.up_to:g}")
        component = static.with_vibrations(interior, modes, select)
        left_out = interior.left_out(len(component.omega_squared)) if select is None else 0
    else:
        free = _FreeModes(edge, *matrices, modes, watch, factor)
        component, left_out = free.component(static, interior), free.left_out
    if left_out:
        count = len(component.omega_squared if free is None else free.squares)
        notes.append(_of_equal_frequency(count, left_out))
    forces = edge.ties.gather(forces)
    answered = [*[forces] * residual_modes,
                *(edge.ties.gather(one.forces) for one in loaded.values())]
    if answered:
        component = with_residual_modes(component, interior, matrices[1], np.hstack(answered))
    reduced = component.project(*matrices)
    if method == "macneal":
        component, reduced = _without_residual_mass(component, reduced[0], free, matrices[1])
    body = ReducedBody(*reduced, edge.coordinates, edge.keeps, len(component.omega_squared),
                       damping=None if fe_model.damping is None else
                       component.project_damping(edge.ties.project(fe_model.damping)),
                       notes=tuple(notes),
                       loads=dict(zip(names, forces.T @ component.basis, strict=True)),
                       missing=missing_of(fe_model, method), materials=fe_model.materials,
                       units=fe_model.units)
    if method == "macneal":
        body = with_shapes(body, fe_model, edge, component)
    else:
        body = with_constants(body, fe_model, edge, component, interior, forces, watch)
    if inputs.flag(judged, "judged") and select is None and method != "macneal":
        told = (free.accuracy() if method == "rubin" else
                reached(static, interior, matrices, modes))
        body = replace(body, notes=(*body.notes,
                                    f"accuracy: {told}" + _WITH_FACES * edge.stiffened))
    body = replace(body, paths={name: one.nodes for name, one in loaded.items()})
    watch.close()
    return body if recover is None else body.recovering(recover)


def clamped(fe_model: FEModel, edge: Boundary, watch: Watch = SILENT,
            method: str = "craig-bampton", factor: Factor | None = None
            ) -> tuple[tuple[sparse.csc_array, sparse.csc_array], ClampedInterior, ComponentModes]:
    """Stiffness and mass of independent DOFs, the interior, and the constraint modes of a boundary.

    Raises
    ------
    InputError
        Several parts, a stiffness that resists rigid motion, or a mechanism inside.
    """
    ties = edge.ties
    stiffness, mass = (ties.project(m) for m in (fe_model.stiffness, fe_model.mass))
    check_connected(fe_model, ties, stiffness)
    # where the boundary holds the body, few printed digits are judged by what they do to the body
    held = edge.means.shape[0] == 0 and method in ("craig-bampton", "guyan")
    check_free(fe_model, ties, stiffness, _HELD if held else 0.0)
    interior = ClampedInterior(stiffness, mass, edge.held, edge.means, ties.rigid, ties.lengths,
                               ties.name, watch, factor)
    static = static_modes(stiffness, interior, *edge.unit_motions())
    rigid = ties.rigid / ties.lengths[:, None]
    if is_strainless(stiffness, rigid):
        static = static.with_rigid(rigid, edge.values(rigid), strainless_coordinates(
            edge.keeps, edge.coordinates.shape[1]))
    return (stiffness, mass), interior, static


def _of_equal_frequency(modes: int, left_out: int) -> str:
    """That a repeated frequency is cut: the body is less symmetric than the structure."""
    others = f"the {left_out} next ones, which are" if left_out > 1 else "the next one, which is"
    return (f"the last of {modes} modes has the frequency of {others} left out: the body is less "
            f"symmetric than its FE model, with {modes + left_out} modes it is not")


def _check_options(method: str, modes: int | Accuracy, select: Sequence[int] | None,
                   residual_modes: bool, paths: bool) -> None:
    if residual_modes and method not in ("craig-bampton", "guyan"):
        raise InputError("residual_modes is for methods 'craig-bampton' and 'guyan', whose modes "
                         f"are of the clamped body; {method!r} has residual shapes of its own")
    if paths and method not in ("craig-bampton", "guyan"):
        raise InputError("paths are for methods 'craig-bampton' and 'guyan', whose internal modes "
                         f"may be static ones of the clamped body; {method!r} has others")
    if method == "guyan" and (isinstance(modes, Accuracy) or inputs.integer(modes, "modes") != 0):
        raise InputError(f"modes is {inputs.shown(modes)}, but method 'guyan' has none: leave it "
                         "out, or choose another method")
    if select is not None and method != "craig-bampton":
        raise InputError(f"select is for method 'craig-bampton'; {method!r} keeps all its modes")
    if not isinstance(modes, Accuracy):
        return
    if method not in ("craig-bampton", "rubin") or select is not None:
        raise InputError("modes=Accuracy(...) chooses the number of modes of methods "
                         "'craig-bampton' and 'rubin' without select; give a number")
    if method == "rubin" and modes.of == "stiffness":
        raise InputError("the dynamic stiffness of method 'rubin' has no estimate: give "
                         "Accuracy(..., of='frequencies'), or take 'craig-bampton'")


class _FreeModes:
    """Rigid motions and lowest elastic modes of the free body, of unit modal mass.

    The elastic modes are those of ``(K, M)`` with momenta ``R^T M q`` of zero: inertia relief.
    """

    def __init__(self, edge: Boundary, stiffness: sparse.csc_array, mass: sparse.csc_array,
                 modes: int | Accuracy, watch: Watch, factor: Factor | None = None):
        self._edge, self._stiffness, self._mass = edge, stiffness, mass
        free, self.rigid = _free_interior(edge.ties, stiffness, mass, watch, factor)
        count = (_within(free, modes, watch) if isinstance(modes, Accuracy) else
                 check_count(modes, free, "body has {} elastic modes"))
        self.squares, self.elastic = free.vibrations(count)
        self.left_out = free.left_out(count)

    def accuracy(self) -> str:
        """Accuracy of the modes, in words."""
        last = np.sqrt(self.squares[-1]) / (2 * np.pi) if len(self.squares) else 0.0
        return (f"the {len(self.squares)} free frequencies up to {last:.4g} are those of the FE "
                "model (in cycles per unit of time)")

    def component(self, static: ComponentModes, interior: ClampedInterior) -> ComponentModes:
        """The constraint modes and the internal shapes that these modes and inertia loads leave."""
        loads = self._mass @ self.rigid
        trial = np.hstack([interior.displacement(loads),
                           self.elastic - static.constraint @ self._edge.values(self.elastic)])
        trial[self._edge.held] = 0.0        # not only to rounding
        trial = trial / np.linalg.norm(trial, axis=0).clip(np.finfo(float).tiny)
        trial = trial @ _independent(trial.T @ (self._stiffness @ trial))
        omega_squared, turn = _vibrations(trial.T @ (self._stiffness @ trial),
                                          trial.T @ (self._mass @ trial))
        shapes = trial @ turn
        turn = canonical_turn(omega_squared, shapes)
        return replace(static, fixed_interface=shapes @ turn, omega_squared=omega_squared)


def _free_interior(ties: Ties, stiffness: sparse.csc_array, mass: sparse.csc_array, watch: Watch,
                   factor: Factor | None = None) -> tuple[ClampedInterior, NDArray]:
    """The free body without momenta, and its rigid motions of unit modal mass.

    A rigid motion without inertia has no momentum: the mean of the motion itself is zero.
    """
    rigid = ties.rigid / ties.lengths[:, None]
    inertia = rigid.T @ (mass @ rigid)
    unit = np.sqrt(np.diag(inertia).clip(np.finfo(float).tiny))
    values, turn = np.linalg.eigh(inertia / np.outer(unit, unit))
    bare = values <= MASSLESS * values[-1]      # a bar with lumped masses spins without inertia
    turn = turn / unit[:, None]
    held, rigid = rigid @ turn[:, bare], rigid @ (turn[:, ~bare] / np.sqrt(values[~bare]))
    momenta = sparse.csr_array(np.hstack([mass @ rigid, held / np.linalg.norm(held, axis=0)]).T)
    return ClampedInterior(stiffness, mass, np.zeros(0, dtype=int), momenta, ties.rigid,
                           ties.lengths, ties.name, watch, factor), rigid


def free_frequencies(fe_model: FEModel, count: int = 6,
                     progress: Callable[[str], Any] | bool | None = None) -> NDArray:
    """Lowest elastic frequencies of a free FE model, without any interface.

    Rigid faces of a reduction stiffen a body; the difference to these frequencies says how much.
    The stiffness is factored once more, so it takes about as long as the modes of a reduction.

    Parameters
    ----------
    fe_model : FEModel
        Free FE model.
    count : int
        Number of frequencies.
    progress : function of a text, or True, optional
        See `reduce`.

    Returns
    -------
    (count,)
        In cycles per unit of time; fewer if the model has fewer.

    Raises
    ------
    InputError
        A model of several parts or one that is held.
    """
    inputs.instance(fe_model, "fe_model", FEModel, "give an FEModel")
    count, watch = inputs.integer(count, "count", least=1), watching(progress)
    ties = Ties(fe_model, ())
    check_connected(fe_model, ties, fe_model.stiffness)
    check_free(fe_model, ties, fe_model.stiffness, 0.0)
    free, _ = _free_interior(ties, fe_model.stiffness, fe_model.mass, watch)
    squares, _ = free.lowest(min(count, free.count))
    watch.close()
    return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)


def _within(free: ClampedInterior, accuracy: Accuracy, watch: Watch) -> int:
    """Number of the elastic modes of the free body up to the end of a band."""
    wanted = 12
    while True:
        squares, _ = free.lowest(wanted)
        if len(squares) < wanted or squares[-1] > accuracy.omega**2:
            return int(np.sum(squares <= accuracy.omega**2))
        watch.remark(f"{wanted} free modes up to {np.sqrt(squares[-1]) / (2 * np.pi):.4g}, the "
                     f"band ends at {accuracy.up_to:g}")
        wanted *= 2


def _without_residual_mass(component: ComponentModes, stiffness: NDArray, free: _FreeModes,
                           mass: sparse.csc_array) -> tuple[ComponentModes, tuple]:
    """MacNeal's mass: that of the parts of the shapes along rigid motions and free modes."""
    momenta = np.hstack([free.rigid, free.elastic]).T @ (mass @ component.basis)
    boundary = component.constraint.shape[1]
    inner = momenta[:, boundary:]
    omega_squared, turn = _vibrations(np.diag(component.omega_squared), inner.T @ inner)
    turn = turn @ canonical_turn(omega_squared, component.fixed_interface @ turn)
    component = replace(component, fixed_interface=component.fixed_interface @ turn,
                        omega_squared=omega_squared)
    momenta = np.hstack([momenta[:, :boundary], inner @ turn])
    reduced = linalg.block_diag(stiffness[:boundary, :boundary], np.diag(omega_squared))
    return component, (reduced, momenta.T @ momenta)


def _independent(energies: NDArray) -> NDArray:
    """Combinations (k, m) of shapes with these strain energies (k, k) that are independent."""
    scale = np.sqrt(np.diag(energies)).clip(np.finfo(float).tiny)
    values, vectors = linalg.eigh(energies / np.outer(scale, scale))
    kept = values > _DEPENDENT * values.max(initial=0.0)
    return vectors[:, kept] / scale[:, None] / np.sqrt(values[kept])


def _vibrations(stiffness: NDArray, mass: NDArray) -> tuple[NDArray, NDArray]:
    """omega^2 (m,) and mass-normalised vectors (k, m), without those of infinite frequency."""
    inverse, vectors = linalg.eigh(mass, stiffness)
    inverse, vectors = inverse[::-1], vectors[:, ::-1]
    kept = inverse > _MASSLESS * inverse.max(initial=0.0)
    omega_squared = 1 / inverse[kept]
    return omega_squared, vectors[:, kept] * np.sqrt(omega_squared)
