"""Generic states of superelement kernels, for their checks."""

from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.contract.counts import first_mode
from sebody.verify.check import rigid_part
from sebody.verify.check.definitions import (
    frame_traits,
)
from sebody.verify.check.floating import (
    FOLLOWING,
    generic_constants,
    is_floating,
)
from sebody.verify.check.rigid_part import has_rigid_part
from sebody.verify.check.states import (
    Case,
    index_row,
    with_constants,
)


class Nodes(NamedTuple):
    """Nodes of the generic states of a kernel."""

    positions: int
    rotations: int
    modes: int


# what general kernels are checked with, as far as their frames can be carried: f5, f1t2r3 without
# modes, t4, f1
NODES = Nodes(5, 5, 3), Nodes(3, 4, 0), Nodes(4, 0, 2), Nodes(1, 1, 1)


def nodes_of(module: ModuleType) -> tuple[Nodes, ...]:
    """The nodes a kernel is made for, or several examples where it takes any."""
    if module.N_POSITIONS is not None:
        modes = 3 if module.N_MODES is None else module.N_MODES
        return (Nodes(module.N_POSITIONS, module.N_ROTATIONS, modes),)
    traits = frame_traits(module)
    return tuple(n for n in NODES if (n.rotations or not traits.needs_rotations)
                 and n.positions >= traits.fewest_positions[module.PLANAR])


def placed_case(module: ModuleType, seed: int, psi: float = 0.3, beta: float = 0.3,
                nodes: Nodes | None = None
                ) -> tuple[Case, dict[str, NDArray], np.random.Generator]:
    """A generic state, without constants; those of the frame and two matrices, by name."""
    random = np.random.default_rng(seed)
    npos, nrot, modes = nodes or nodes_of(module)[0]
    planar = module.PLANAR
    d, n = 2 if planar else 3, first_mode(npos, nrot, planar) + modes
    X, alpha, alpha_r = _nodes(random, npos, nrot, d)
    S, M = (A @ A.T for A in random.normal(size=(2, n, n)))
    angle = random.normal()
    base = (Rotation.from_rotvec([0, 0, angle]) if planar
            else Rotation.from_rotvec(random.normal(size=3)))
    u = (psi / 3) * random.normal(size=(npos, d))
    x = (X + u) @ base.as_matrix()[:d, :d].T + random.normal(size=d)
    turns = random.uniform(-1, 1, size=(nrot, 1 if planar else 3)) * psi / (1 if planar else 1.8)
    R = (np.zeros(0) if planar else
         np.array([(base * Rotation.from_rotvec(t)).as_matrix() for t in turns]).ravel())
    rotations = angle + turns.ravel() if planar else np.zeros(3 * nrot)
    q = np.concatenate([x.ravel(), rotations, random.normal(size=modes)])
    about = np.array([0.0, 0.0, beta]) if planar else beta * random.normal(size=3) / 1.8
    frame = (base * Rotation.from_rotvec(about)).as_matrix().ravel()
    v, a = random.normal(size=n), random.normal(size=n)
    case = Case(module, n, index_row(n, npos, nrot), np.zeros(0), q, R, v, a, frame, frame.copy())
    values = {"alphas": alpha, "fits": np.full(npos, 1 / npos), "alpha_rs": alpha_r, "X": X,
              "S": S, "M": M}
    if any(part.name == "Gam" for part in module.CONSTANTS):
        values["Gam"] = _mean_rotation(random, case, X)
    return case, values, random


def _mean_rotation(random: np.random.Generator, case: Case, X: NDArray) -> NDArray:
    """Any weights of local coordinates in the mean rotation, one of a rigid rotation, (n, r)."""
    axes = np.eye(3)[2:] if case.planar else np.eye(3)
    arms = np.column_stack([X, np.zeros(len(X))]) if case.planar else X
    rigid = np.array([np.r_[np.cross(axis, arms)[:, :case.dimension].ravel(),
                            np.tile(axis[-len(axes):], case.n_rotations),
                            np.zeros(case.n - case.first_mode)] for axis in axes]).T
    weights = rigid + 0.2 * random.normal(size=rigid.shape)
    weights[case.first_mode:] *= 0.5
    return weights @ np.linalg.inv(rigid.T @ weights)


def superelement_case(module: ModuleType, seed: int, psi: float = 0.3, beta: float = 0.3,
                      gravity: float = 0.0, damping: float = 0.0,
                      nodes: Nodes | None = None) -> Case:
    """A generic state of a superelement kernel, with the first of its `nodes_of` by default."""
    case, values, random = placed_case(module, seed, psi, beta, nodes)
    n, d, M = case.n, case.dimension, values["M"]
    of_translations, moment = random.normal(size=(n, d)), random.normal(size=d)
    values |= {"mass_columns": of_translations, "mass_rows": of_translations.T, "mc": moment,
               "full": [n], "masses": [1.3]}
    if module.DAMPED:
        values["C"] = damping * M @ M     # any positive matrix
    case = case._replace(field=gravity * random.normal(size=3))
    if is_floating(case):
        slaved, resultants = module.SECOND_ORDER or FOLLOWING[seed % len(FOLLOWING)]
        case = case._replace(slaved=slaved, resultants=resultants, damped=damping > 0)
        values |= generic_constants(random, case, values, damping)
    elif has_rigid_part(case):
        case = case._replace(damped=damping > 0)
        values |= rigid_part.generic_constants(random, case, M, damping)
    return with_constants(case, values | _declared(case, values, random))


def _nodes(random: np.random.Generator, positions: int, rotations: int,
           d: int) -> tuple[NDArray, NDArray, NDArray]:
    """Nodes in the undeformed frame, and the weights of their positions and rotations."""
    around = 2 * np.pi * np.arange(positions) / positions      # on a circle: good for all frames
    X = np.column_stack([np.cos(around), np.sin(around), 0 * around])[:, :d]
    X = X + 0.2 * random.normal(size=(positions, d))
    alpha, alpha_r = (np.ones(k) / max(k, 1) + 0.1 * random.normal(size=k)
                      for k in (positions, rotations))
    alpha += (1 - alpha.sum()) / positions
    alpha_r += (1 - alpha_r.sum()) / max(rotations, 1)
    return X - alpha @ X, alpha, alpha_r


def _declared(case: Case, values: dict, random: np.random.Generator) -> dict[str, NDArray]:
    """Generic values of the constants that the frame and inertia option add."""
    counts = case.counts
    return {part.name: random.normal(size=[counts.get(s, s) for s in part.shape])
            for part in case.module.CONSTANTS if part.name not in values}
