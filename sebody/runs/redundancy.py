"""Solution for accelerations and multipliers where constraints are redundant or mass is missing."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, diags

from sebody.basics.errors import InputError
from sebody.engine.matrix import THIN
from sebody.engine.regularization import LIGHT
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.numbering import Numbering
from sebody.runs.kkt_solver import LeastSquares, Relaxed, Scaled

WEAK = 1e-6             # pivot of a redundant constraint; of another one, its strength
ROUNDED = 1e-12         # of squares of velocities, what is left of them where they cancel
CONTRADICTION = 1e-7    # residual that contradicting constraints leave, relative to the largest
MASSLESS = 1e-13        # inertia of a motion that has none, relative to that of its body
SHARED = 0.1            # residual of a constraint that has part in a contradiction, of the largest
EXERTED = 1e-10         # force of multipliers, in scaled unknowns, that is rounding
SHARPENED = 3           # times that `Relaxed.unmoved` leaves REGULARIZATION of what exerts a force
UNSHARED = 1e-6         # part in what exerts no force that is rounding, of the largest
PROBES = 8              # iterations after which the motion with the least inertia is left
HALF = 0.5              # of such a motion, `Relaxed.unmoved` leaves all; of others little


def least(matrix: csc_matrix, system: System,
          direct: Scaled | None = None) -> Callable[[NDArray], NDArray]:
    """Solver for given right sides: with least norm where the matrix is singular.

    Parameters
    ----------
    direct : Scaled, optional
        Factors of the matrix, if there are any yet.
    """
    direct = direct or Scaled(matrix)
    if direct.regular:
        return direct.solve
    if not system.massless[0]:
        regularized = Relaxed(matrix, part_sizes(matrix, system), system)
        return lambda demand: regularized.least(demand)[0]
    scale = _scales(matrix, system)
    squares = LeastSquares(csc_matrix(diags(scale) @ matrix @ diags(scale)))
    return lambda demand: scale * squares.solve(scale * demand)


def _scales(matrix: csc_matrix, system: System) -> NDArray:
    """Scales, (n,), that make inertias and constraints about one; norms depend on no axes then.

    The engine has the same for its least norms (`sebody.engine.row_exchanges`).
    """
    held, part = multiplying(system), system.part[:matrix.shape[0]]
    sizes = np.bincount(part, np.where(held, 0.0, np.abs(matrix.diagonal())), len(part))
    usual = system.inertias[:len(part)]     # of the model: those of the matrix may be made larger
    sizes = np.where(sizes[part] > 0.0, sizes[part],
                     np.where(usual > 0.0, usual, part_sizes(matrix, system)))
    strengths = np.where(held, matrix.power(2) @ np.where(held, 0.0, 1.0 / sizes), 0.0)
    return 1.0 / np.sqrt(np.where(held, np.bincount(part, strengths, len(part))[part], sizes))


def part_sizes(matrix: csc_matrix, system: System) -> NDArray:
    """Largest diagonal entry of every unknown's position or rotation, (n,).

    Where these are zero, a typical one of the model by the magnitudes of coordinates.
    """
    n = matrix.shape[0]
    diagonal, part = np.abs(matrix.diagonal()), system.part[:n]
    # of a model whose only place is the origin: magnitudes are zero
    magnitude = np.where(system.magnitude[:n] > 0.0, system.magnitude[:n], 1.0)
    sizes = np.zeros(n)
    np.maximum.at(sizes, part, diagonal)
    sizes = sizes[part]
    typical = (diagonal * magnitude**2).max() or 1.0    # one of a model without any inertia
    empty = sizes == 0.0
    sizes[empty] = typical / magnitude[empty]**2
    return sizes


def units(matrix: csc_matrix, system: System) -> NDArray:
    """Units, (n,), in which inertias are about one and constraints at most about one.

    They are powers of two. Without them a body with a mass of 1e-14 beside entries of constraints,
    or beside modal masses, of one would count as a body without mass.
    """
    entries, held = matrix.tocoo(), multiplying(system)
    found = 1.0 / np.sqrt(part_sizes(matrix, system))
    of = held[entries.col] & ~held[entries.row] & (entries.data != 0.0)
    smallest = np.full(len(found), np.inf)
    np.minimum.at(smallest, entries.col[of],
                  1.0 / (np.abs(entries.data[of]) * found[entries.row[of]]))
    found = np.where(held, np.where(np.isfinite(smallest), smallest, 1.0), found)
    return np.exp2(np.round(np.log2(found)))


class Solver:
    """Masses and constraints at the start; finds redundant constraints and missing mass.

    Parameters
    ----------
    matrix : (n, n)
        Masses and constraints.
    resisting : function
        The same with stiffness.

    Attributes
    ----------
    redundant : tuple of str
        Joints with constraints that those numbered before them contain.
    shared : tuple of str
        Joints whose multipliers are not unique.
    massless : bool
        Whether a motion has stiffness and no mass, as of MacNeal's bodies.

    Raises
    ------
    InputError
        Something with neither mass nor stiffness can move.
    """

    def __init__(self, matrix: csc_matrix, system: System, numbering: Numbering,
                 resisting: Callable[[], csc_matrix]):
        self.system = Scaled(matrix, units(matrix, system))
        self.names, self.multiplying = numbering.names, multiplying(system)
        self.redundant: tuple[str, ...] = ()
        self.shared: tuple[str, ...] = ()
        self.massless = not self.system.regular
        self.regularized: Relaxed       # where a pivot is suspicious, and nothing else asks
        if self.system.suspicious:
            system.massless_axes[:matrix.shape[0]] = massless_axes(matrix, system)
            self.regularized = Relaxed(matrix, part_sizes(matrix, system), system)
            self._check_mass(system, resisting)
            self._find_redundant(matrix, system)

    def check(self, residual: NDArray, speed: float) -> None:
        """Refuse redundant constraints that demand what no accelerations give.

        Parameters
        ----------
        residual : (n,)
            Without accelerations and multipliers.
        speed : float
            The largest velocity: constraints demand its square, which cancels where they agree.

        Raises
        ------
        InputError
            Constraints that contradict each other.
        """
        relaxed = self.regularized
        answer, left = relaxed.least(residual)
        rounding = ROUNDED * speed**2 * relaxed.scale[self.multiplying].max(initial=0.0)
        if left.max() <= max(CONTRADICTION * np.abs(relaxed.scale * residual).max(), rounding,
                             1e-300):
            return
        parties = parties_of(self.names, np.where(self.multiplying, left, 0.0))
        gap = self._without_force(relaxed.scale * (residual - relaxed.matrix @ answer))
        force = relaxed.scale * (relaxed.matrix @ (relaxed.scale * gap))
        if np.abs(force).max() > EXERTED * np.abs(gap).max():
            raise InputError(f"the constraints of {parties} nearly repeat each other: they are so "
                             "close together that rounding spoils the forces that they need for "
                             "what they hold; put them further apart, or one joint in their place")
        raise InputError(f"the constraints of {parties} contradict each other: they demand "
                         "different values of the same acceleration; remove one, or give drives "
                         "the same motion")

    def _find_redundant(self, matrix: csc_matrix, system: System) -> None:
        """Joints with constraints whose pivots are those of the regularization.

        Whether constraints contain or contradict each other is no matter of masses: where these are
        missing, pivots are rounding, so all have some more.
        """
        multipliers, sizes = multiplying(system), part_sizes(matrix, system)
        heavier = Relaxed(matrix + diags(np.where(multipliers, 0.0, LIGHT * sizes)), sizes, system)
        weak = (heavier.pivots < WEAK) & multipliers
        self.redundant = joints(self.names, weak)
        if not self.redundant:
            return
        self.massless = _lacks_mass(matrix, system)
        if self.massless:
            self.regularized = heavier
        part = np.where(multipliers, np.random.default_rng(0).normal(size=weak.size), 0.0)
        part = self._without_force(part)    # it has, at random, part of every one without force
        self.shared = joints(self.names, np.abs(part) > UNSHARED * np.abs(part).max())

    def _without_force(self, multipliers: NDArray) -> NDArray:
        """The part of multipliers, in scaled unknowns, that exerts no force, or hardly one."""
        for _ in range(SHARPENED):
            multipliers = np.where(self.multiplying, self.regularized.unmoved(multipliers), 0.0)
        return multipliers

    def _check_mass(self, system: System, resisting: Callable[[], csc_matrix]) -> None:
        """Refuse a motion that the constraints leave free and that has no mass and no stiffness."""
        moving = ~multiplying(system)
        probe = np.where(moving, np.random.default_rng(0).normal(size=moving.size), 0.0)
        for _ in range(PROBES):
            probe /= np.linalg.norm(probe)
            probe = np.where(moving, self.regularized.unmoved(probe), 0.0)
            if not probe.any():
                return
        shape = self.regularized.scale * probe / np.linalg.norm(probe)
        if np.linalg.norm(probe) <= HALF or shape @ (self.regularized.matrix @ shape) >= MASSLESS:
            return
        held, motion = self._held(system, resisting())
        if not held:
            name = self.names[int(np.argmax(np.abs(probe if motion is None else motion)))]
            raise InputError(f"the mass matrix is singular: {name} moves no mass, and nothing "
                             "stiff holds it; add mass or inertia there, fix it, or leave it out")

    def _held(self, system: System, resisting: csc_matrix) -> tuple[bool, NDArray | None]:
        """Tell if stiffness holds all motions without mass, and name one that it does not hold.

        Motions are found from all unknowns without inertia at once. What a load adds to the
        stiffness of a body that turns under it has no part among these motions.
        """
        moving = ~multiplying(system)
        thin = np.flatnonzero((system.massless_axes[:moving.size] > 0.0) & moving)
        motions = np.zeros((moving.size, thin.size))
        motions[thin, np.arange(thin.size)] = 1.0
        for _ in range(PROBES):
            motions = np.where(moving[:, None], self.regularized.unmoved(motions), 0.0)
        left, sizes, _ = np.linalg.svd(motions, full_matrices=False)
        left = left[:, sizes > HALF]
        if not left.size:
            return False, None
        scale = diags(self.regularized.scale)
        stiffness = (scale @ resisting @ scale).tocsc()
        own, strengths, _ = np.linalg.svd(left.T @ (stiffness @ left))
        largest = abs(stiffness[moving][:, moving]).max()
        return bool(strengths[-1] > MASSLESS * largest), left @ own[:, -1]


def _lacks_mass(matrix: csc_matrix, system: System) -> bool:
    """Tell whether a motion has no mass and no constraint; constraints may be redundant.

    Constraints that give way, by an amount of the order of one, have unique multipliers.
    """
    scale = units(matrix, system)
    giving = diags(np.where(multiplying(system), -1.0 / scale**2, 0.0))
    return not Scaled(csc_matrix(matrix + giving), scale).regular


def contradiction(system: System, state: State, numbering: Numbering) -> str:
    """Demand that a failed step cannot meet: constraints, or a force on something without mass.

    Empty if that is a force on something with mass: then the step is too long, or diverged.
    """
    n = system.diagonal.size
    left = np.abs(state.scale[:n] * (state.residual[:n] + state.constraint_residuals[:n]))
    worst = int(np.argmax(left))
    if not multiplying(system)[worst]:
        has_inertia = system.inertias[worst] > 0.0 and system.massless_axes[worst] == 0.0
        if has_inertia and not system.massless[0]:
            return ""
        return (f"a force acts on {numbering.names[worst]}, which moves no mass: add mass or "
                "inertia there, or fix it")
    parties = parties_of(numbering.names, np.where(multiplying(system), left, 0.0))
    return (f"the constraints of {parties} contradict each other: no motion satisfies all of them; "
            "remove one, or give the drives motions that the joints allow")


def parties_of(names: list[str], left: NDArray) -> str:
    """Joints whose constraints are left with nearly the largest residual, (unknowns,), in words."""
    return ", ".join(joints(names, left > SHARED * left.max()))


def joints(names: list[str], chosen: NDArray) -> tuple[str, ...]:
    """Names of the joints of some multipliers, (unknowns,) of bool, by the names of these."""
    return tuple(dict.fromkeys(names[k].partition(" of ")[2] for k in np.flatnonzero(chosen)))


def massless_axes(matrix: csc_matrix, system: System) -> NDArray:
    """Sizes of the positions and rotations with nearly no inertia along an axis, zeros else."""
    n = matrix.shape[0]
    part, inertias = system.part[:n], system.inertias[:n]
    blocks = np.tile(np.eye(3), (n, 1, 1))
    entries = matrix.tocoo()
    inertial = (part[entries.row] == part[entries.col]) & ~multiplying(system)[entries.row]
    row, column, value = entries.row[inertial], entries.col[inertial], entries.data[inertial]
    first = part[row]
    diagonal = np.arange(n) - part
    blocks[part, diagonal, diagonal] = 0.0
    np.add.at(blocks, (first, row - first, column - first), value / inertias[first])
    least = np.linalg.eigvalsh(blocks)[:, 0]
    return np.where((least[part] < THIN) & ~multiplying(system), inertias, 0.0)


def multiplying(system: System) -> NDArray:
    """Unknowns that are multipliers, (n,) of bool."""
    return system.is_multiplier[:system.diagonal.size] > 0.0
