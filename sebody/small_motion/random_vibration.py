"""Random vibration: spectral densities, rms values and zero crossings of stationary responses.

Of inputs that do not depend on each other, with one-sided densities S_j, a quantity i has

    S_i(f) = sum_j |H_ij(f)|^2 S_j(f),    rms^2 = integral of S_i df

with H of `state_space`, and of inputs that do with the terms ``H_ij* H_ik g_jk sqrt(S_j S_k)`` of
all pairs, g_jk their complex coherence.

The integrals are Gauss quadratures of POINTS nodes over panels between the rows of the tables,
halved until none is longer than the distance of its centre from any pole of H in the complex plane,
and from f = 0. Gauss's error then falls by ``(2 + sqrt 3)^-2`` with every
node, however small the damping is. Upward zero crossings are ``sqrt(m_2 / m_0)`` in a unit of time,
m_n the integral of ``f^n S df`` (S. O. Rice, Bell System Technical Journal 24, 1945, p. 46).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import eig, matrix_balance, schur

from sebody.basics import inputs, tabular
from sebody.basics.errors import InputError
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.small_motion.given_state import state_of
from sebody.small_motion.state_space import StateSpace, state_space

POINTS = 10         # of a panel: errors of 4e-12
AT_ONCE = 2000      # frequencies
SEEN = 1e-12        # part of a mode's vectors, of inputs and quantities, that is no rounding
SHARE = 1e-9        # of the largest share of the response: no mode
ZERO = 1e-6         # of the typical pole: those at zero are double, off by the root of rounding
TINY = 1e-300
COHERENT = 1e-9     # of the smallest eigenvalue of coherences, below zero, that is rounding
DAMPED = 1e-9       # least part of critical damping that is more than rounding
HEADS = "quantity", "rms", "zero crossings"


class RandomResponse(NamedTuple):
    """Stationary random response of quantities; see `random_response`."""

    frequency: NDArray              # (k,) ascending, dense about resonances [1/time]
    psd: dict[str, NDArray]         # (k,) one-sided spectral densities [unit^2 time]
    rms: dict[str, float]           # over the frequencies of the tables [unit]
    crossings: dict[str, float]     # upward zero crossings in a unit of time [1/time]

    def __repr__(self) -> str:
        return tabular.text(*self._table())

    def _repr_html_(self) -> str:
        """Tables that notebooks show."""
        return tabular.titled(*self._table())

    def _table(self) -> tuple[str, tuple[str, ...], list[tuple[str, ...]]]:
        title = (f"random response from {self.frequency[0]:.6g} to {self.frequency[-1]:.6g} cycles "
                 "in a unit of time")
        return title, HEADS, [(name, f"{value:.6g}", f"{self.crossings[name]:.6g}")
                              for name, value in self.rms.items()]


def random_response(run: Simulation | Result | Model, psd: Mapping[str, ArrayLike],
                    quantities: str | Iterable[str], spin: ArrayLike | None = None,
                    frame: str = "auto", hub: Node | str | None = None,
                    coherence: Mapping[tuple[str, str], ArrayLike] | None = None
                    ) -> RandomResponse:
    """Response of quantities to stationary random loads and base accelerations.

    Parameters
    ----------
    run : Simulation, Result or Model
        At rest or in steady rotation, as `equilibrium` leaves it; of a model, the state is that.
    psd : mapping of str to (rows, 2) array_like
        One-sided power spectral densities by the names of inputs. Rows are frequencies in cycles
        per unit of time (Hz where it is the second) and densities; between rows a
        density is a power of the frequency, as in specifications of vibration tests (straight in a
        log-log diagram); outside it is zero. Of a load, the density is that of its amplitude
        [unit^2/Hz]. Of a prescribed motion or a drive (`move`), it is that
        of the acceleration in units of the model [(m/s^2)^2/Hz, not g^2/Hz].
    quantities : str or iterable of str
        Names of quantities, as of a `Result`. Those with components are told by component, as
        ``"tip.position.x"`` and, of stresses of solids at FE nodes, ``"block.node12.stress.xx"``.
        All are changes from the state of the run, of first order.
    spin, frame, hub
        Of a steady rotation, see `modes`.
    coherence : mapping of (str, str) to complex, or to (rows, 2) complex array_like, optional
        By pairs of inputs (a, b) the complex coherence ``S_ab / sqrt(S_a S_b)``, with S_ab the
        cross-spectral density, the mean of ``conj(a) b``: a number, or rows of frequency and value,
        linear between them and constant outside. Pairs that are left out are independent; 1 is
        motion in phase, as of supports on one table, ``exp(-2j * pi * f * T)`` that of b after the
        time T.

    Returns
    -------
    RandomResponse
        By name: ``found.rms["tip.acceleration.x"]``.

    Raises
    ------
    InputError
        No such input or quantity, a wrong table, coherences that no motions have, a
        motion without damping in the range of the tables, or one that grows.
    """
    tables = {name: _table(name, rows) for name, rows in inputs.mapping(
        psd, "psd", "give tables (frequency, density) by the names of inputs").items()}
    if not tables:
        raise inputs.refusal("psd", psd, "name at least one input")
    run = state_of(run, spin, hub)
    _refuse_crooked(run, quantities)
    system = state_space(run, list(tables), quantities, spin, frame, hub)
    pairs = _coherences(coherence, list(tables))
    rows = np.unique(np.concatenate([table[:, 0] for table in tables.values()]))
    inner = np.concatenate([rows, *(pair.frequencies for pair in pairs)])
    rows = np.unique(inner[(inner >= rows[0]) & (inner <= rows[-1])])
    f, weights = _nodes(rows, _poles(system, rows) / (2 * np.pi))
    answers = []        # of each input, times the root of its density: (len(f), outputs)
    for j, table in enumerate(tables.values()):
        inside = (f > table[0, 0]) & (f < table[-1, 0])
        density = np.exp(np.interp(np.log(f[inside]), *np.log(table).T))
        answers.append(np.zeros((len(f), len(system.outputs)), dtype=complex))
        answers[-1][inside] = (_responses(system, j, 2 * np.pi * f[inside])
                               * np.sqrt(density)[:, None])
    squares = np.sum(np.abs(answers)**2, axis=0)
    for pair in pairs:
        squares += 2.0 * np.real(answers[pair.first].conj() * answers[pair.second]
                                 * pair.at(f)[:, None])
    squares = np.maximum(squares, 0.0)      # rounding, where answers cancel
    m0, m2 = weights @ squares, (weights * f**2) @ squares
    crossings = np.sqrt(m2 / np.where(m0 > 0.0, m0, 1.0))
    return RandomResponse(f, dict(zip(system.outputs, squares.T, strict=True)),
                          dict(zip(system.outputs, map(float, np.sqrt(m0)), strict=True)),
                          dict(zip(system.outputs, map(float, crossings), strict=True)))


def _refuse_crooked(run: Simulation | Result, quantities: str | Iterable[str]) -> None:
    """Refuse stresses that do not follow a small motion in proportion."""
    names = [quantities] if isinstance(quantities, str) else inputs.items(
        quantities, "quantities", "give names of quantities")
    bodies = run.model.bodies
    for name in filter(lambda one: isinstance(one, str), names):
        owner, _, inside = name.rpartition(".node")
        body = bodies.get(owner)
        recovery = None if body is None else body.reduced.recovery
        parts = inside.split(".")[1:2]
        if parts == ["von_mises"]:
            raise InputError(f"quantity {name!r} is no linear function of the motion, so random "
                             "response has no density of it: name components of stress")
        if parts == ["stress"] and recovery is not None and recovery.fibred:
            raise InputError(f"quantity {name!r} is the stress of the most stressed fibre, another "
                             "at every instant: name section_forces of the node")


def _table(name: Any, rows: ArrayLike) -> NDArray:
    """Frequencies and densities of an input."""
    what = f"psd of {inputs.name(name, 'name of an input')!r}"
    table = inputs.array(rows, what, (None, 2), remedy="give rows (frequency, density)")
    if len(table) < 2 or table.min() <= 0.0 or np.any(np.diff(table[:, 0]) <= 0.0):
        raise InputError(f"{what} needs two rows or more, of ascending frequencies and of "
                         "densities that are all positive: in log-log diagrams there is no zero")
    return table


class _Pair(NamedTuple):
    """Two inputs by number, and their complex coherence over the frequency."""

    first: int
    second: int
    frequencies: NDArray
    values: NDArray

    def at(self, f: NDArray) -> NDArray:
        """Coherence at frequencies."""
        return (np.interp(f, self.frequencies, self.values.real)
                + 1j * np.interp(f, self.frequencies, self.values.imag))


def _coherences(given: Mapping[tuple[str, str], ArrayLike] | None, names: list[str]
                ) -> list[_Pair]:
    """Pairs of inputs that depend on each other.

    Raises
    ------
    InputError
        Names that are no pair of inputs, values that are no table, or coherences that are too
        large together.
    """
    pairs: list[_Pair] = []
    remedy = "give a complex number, or rows (frequency, complex number), by pairs of inputs"
    for pair, value in ({} if given is None else
                        inputs.mapping(given, "coherence", remedy)).items():
        what = f"coherence of {inputs.shown(pair)}"
        if (not isinstance(pair, tuple) or len(pair) != 2 or pair[0] == pair[1]
                or not all(name in names for name in pair)):
            raise InputError(f"{what}: name two inputs that have a psd, {', '.join(names)}")
        try:
            table = np.array(value, dtype=complex)
        except (TypeError, ValueError) as error:
            raise inputs.refusal(what, value, remedy) from error
        table = np.array([[1.0, table]]) if table.ndim == 0 else table
        if (table.ndim != 2 or table.shape[1] != 2 or not len(table) or not np.isfinite(table).all()
                or np.any(table[:, 0].imag) or np.any(np.diff(table[:, 0].real) <= 0.0)):
            raise inputs.refusal(what, value, remedy + ", frequencies ascending")
        pairs.append(_Pair(*map(names.index, pair), table[:, 0].real, table[:, 1]))
    if len({frozenset(pair[:2]) for pair in pairs}) < len(pairs):
        raise InputError("coherence: a pair of inputs is given twice: give one order alone")
    _refuse_impossible(pairs, names)
    return pairs


def _refuse_impossible(pairs: list[_Pair], names: list[str]) -> None:
    """Refuse coherences whose matrix is not positive at some frequency: between rows it is then."""
    for f in np.unique(np.concatenate([[1.0], *(pair.frequencies for pair in pairs)])):
        matrix = np.eye(len(names), dtype=complex)
        for pair in pairs:
            value = complex(pair.at(np.array([f]))[0])
            matrix[pair.first, pair.second] = value
            matrix[pair.second, pair.first] = value.conjugate()
        if np.linalg.eigvalsh(matrix)[0] < -COHERENT:
            raise InputError(f"coherence at the frequency {f:.6g}: no motions have such values "
                             "together, since their matrix is not positive: give smaller ones")


def _poles(system: StateSpace, rows: NDArray) -> NDArray:
    """Poles about which the response varies fast: all with damping, without those at zero.

    Raises
    ------
    InputError
        Responses that are not stationary, or have no bounds in the range of the tables.
    """
    if not len(system.A):
        return np.zeros(0, dtype=complex)
    A, (size, _) = matrix_balance(system.A, permute=False, separate=True)
    poles, left, right = eig(A, left=True, right=True)
    kept = np.abs(poles) > ZERO * np.median(np.abs(poles))
    poles, left, right = poles[kept], left[:, kept].conj().T, right[:, kept]
    slack, f = DAMPED * np.abs(poles), np.abs(poles.imag) / (2 * np.pi)
    seen = _seen(poles, left, right, system.B / size[:, None], system.C * size)
    growing = seen & (poles.real > slack)
    if growing.any():
        raise InputError("the response is not stationary: the model has a motion that grows, at "
                         f"the rate {poles.real[growing].max():.6g}; modes() has its shape")
    bare = poles.real > -slack
    within = seen & bare & (f > rows[0] * (1 - 1e-6)) & (f < rows[-1] * (1 + 1e-6))
    if within.any():
        raise InputError(f"the response has no bound: the motion at {f[within].min():.6g} cycles "
                         "in a unit of time has no damping; add some, or leave out this frequency")
    return poles[~bare]


def _seen(poles: NDArray, left: NDArray, right: NDArray, B: NDArray, C: NDArray) -> NDArray:
    """Tell whether some input moves a mode that some quantity shows, by more than rounding."""
    moved, shown = np.abs(left @ B), np.abs(C @ right).T
    clear = moved > SEEN * np.linalg.norm(B, axis=0), shown > SEEN * np.linalg.norm(C, axis=1)
    masses = np.abs(np.einsum("ij,ji->i", left, right)) * np.abs(poles)
    shares = moved[:, :, None] * shown[:, None, :] / np.maximum(masses, TINY)[:, None, None]
    large = shares > SHARE * shares.max(axis=0, initial=0.0)
    return (large & clear[0][:, :, None] & clear[1][:, None, :]).any(axis=(1, 2))


def _nodes(rows: NDArray, poles: NDArray) -> tuple[NDArray, NDArray]:
    """Nodes and weights of the quadrature between rows; `poles` in cycles per unit of time."""
    singular = np.append(poles, 0.0)
    low, high, done = rows[:-1], rows[1:], []
    while len(low):
        centre, length = (low + high) / 2, high - low
        near = np.full(len(low), np.inf)
        for pole in singular:
            near = np.minimum(near, np.abs(1j * centre - pole))
        fine = length <= near
        done.append(np.stack([centre[fine], length[fine]]))
        low, middle, high = low[~fine], centre[~fine], high[~fine]
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    centre, length = np.hstack(done)
    order = np.argsort(centre)
    points, weights = np.polynomial.legendre.leggauss(POINTS)
    f = centre[order, None] + length[order, None] / 2 * points
    return f.ravel(), (length[order, None] / 2 * weights).ravel()


def _responses(system: StateSpace, column: int, omega: NDArray) -> NDArray:
    """Responses to an input, (k, outputs): by Schur's form, whatever poles coincide."""
    B = system.B[:, column]
    found = np.tile(system.D[:, column].astype(complex), (len(omega), 1))
    if not len(B):
        return found
    A, (size, _) = matrix_balance(system.A, permute=False, separate=True)
    T, Z = schur(A, output="complex")
    push, shown = Z.conj().T @ (B / size), (system.C * size) @ Z
    for first in range(0, len(omega), AT_ONCE):
        w = omega[first:first + AT_ONCE]
        X = np.zeros((len(B), len(w)), dtype=complex)
        for i in reversed(range(len(B))):
            X[i] = (push[i] + T[i, i + 1:] @ X[i + 1:]) / (1j * w - T[i, i])
        found[first:first + AT_ONCE] += (shown @ X).T
    return found
