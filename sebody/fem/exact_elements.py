"""Two-node beam elements that curve, twist and taper, by their exact flexibility.

Section forces of an element without loads follow from those at its second end, n = (N, M), by
equilibrium alone, whatever the shape of the beam and its sections (the code takes them in the
middle of the chord). All in axes of the model, with
the place r(s) and the sections' flexibility C(s) along the element:

    (1) f = L n,   L = [[1, 0], [skew(r_b - r), 1]]
    (2) F = int L^T C L ds,   K = T^T F^-1 T,
        T u = (u_b - u_a - theta_a x (r_b - r_a), theta_b - theta_a)
    (3) (gamma, kappa) = C L F^-1 T u,   gamma = u' - theta x r',  kappa = theta'
    (4) theta = theta_a + int kappa,
        u = u_a + theta_a x (r - r_a) + int gamma + int r x kappa - r x int kappa

(integrals from the first end). Curvature, twist, taper and any coupling are in F, nothing is the
mean of an element; uniform straight elements are those of `sebody.fem.beam_element`. The shapes (4)
make the mass of sections with the centre of mass c and the inertia J about it, and the damping of
sections whose strains have retardation times:

    (5) M = int m v^T v + theta^T J theta ds,   v = u + theta x R c
    (6) D = int (gamma, kappa)^T S (gamma, kappa) ds

Integrals are Gauss's, with five points between kinks of the axis and the sections; where the axis
or the twist turn much there are more. Those of (4) integrate the polynomial through these points.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sebody.basics.vectors import skew
from sebody.fem.beam_elements import IN_PLANE, AtEnds, BeamElements, symmetric
from sebody.fem.general_section import GeneralSection, central_inertia, centre_of_mass
from sebody.fem.section import StiffnessSection
from sebody.fem.section_along import AnySection, kinks_of, section_at

GAUSS = 5
TURN = 0.4              # turn of the sections' axes within five points [rad]
SAMPLES = 9             # places at which this turn is measured
INSIDE = 1e-9           # of an element: next to an end, where a kink has two sides
_X, _W = np.polynomial.legendre.leggauss(GAUSS)
PLACES, WEIGHTS = (1 + _X) / 2, _W / 2
_POWERS = np.arange(1, GAUSS + 1)
# (g, g): integrals from 0 to each point of the polynomial through values at all of them
UPTO = (PLACES[:, None]**_POWERS / _POWERS) @ np.linalg.inv(np.vander(PLACES, increasing=True))


class Line(Protocol):
    """The axis of a beam: `sebody.fem.axis.Axis`, or a straight line."""

    length: float
    kinks: NDArray

    def position(self, places: NDArray) -> NDArray:
        """Points (n, 3)."""

    def axes(self, places: NDArray) -> NDArray:
        """Matrices (n, 3, 3) of the sections' axes."""


class Straight:
    """A straight line between two points, with axes of its sections that are the same all along.

    Parameters
    ----------
    first, last : (3,)
    axes : (3, 3)
        Columns: tangent, y and z.
    """

    def __init__(self, first: NDArray, last: NDArray, axes: NDArray):
        self._first, self._way, self._axes = first, last - first, axes
        self.length = float(np.linalg.norm(self._way))
        self.kinks = np.zeros(0)

    def position(self, places: NDArray) -> NDArray:
        """Points (n, 3)."""
        return self._first + np.asarray(places)[:, None] * self._way

    def axes(self, places: NDArray) -> NDArray:
        """Matrices (n, 3, 3) of the sections' axes."""
        return np.broadcast_to(self._axes, (len(places), 3, 3))


class Rule(NamedTuple):
    """Points of integration of an element and their sections."""

    places: NDArray     # (g,) along the line
    weights: NDArray    # (g,) [length]
    ends: NDArray       # (2,)
    sections: list      # at the points
    at_ends: AtEnds     # at both

    @property
    def middle(self) -> StiffnessSection | GeneralSection:
        """The section in the middle."""
        return self.sections[len(self.sections) // 2]

    @property
    def uniform(self) -> bool:
        """Tell whether all sections are the same."""
        first = self.sections[0]
        return all(one is first or one == first for one in self.sections)


def rules_of(line: Line, section: AnySection, places: NDArray) -> list[Rule]:
    """Points of integration of the elements between places of a line.

    Raises
    ------
    InputError
        Something that is no section.
    """
    kinks = np.concatenate([line.kinks, kinks_of(section)])
    return [_rule(line, section, kinks, a, b) for a, b in pairwise(places)]


def _rule(line: Line, section: AnySection, kinks: NDArray, first: float, last: float) -> Rule:
    near = INSIDE * (last - first)
    cuts = np.unique([first, *kinks[(kinks > first + near) & (kinks < last - near)], last])
    places, weights = [], []
    for a, b in pairwise(cuts):
        count = max(1, int(np.ceil(_turn(line, a, b) / TURN)))
        for k in range(count):
            step = (b - a) / count
            places.append(a + step * (k + PLACES))
            weights.append(step * WEIGHTS * line.length)
    at = np.concatenate(places)
    if callable(section):
        found = [section_at(section, float(place)) for place in at]
        at_ends = section_at(section, first + near), section_at(section, last - near)
    else:
        one = section_at(section, 0.0)
        found, at_ends = [one] * len(at), (one, one)
    made = Rule(at, np.concatenate(weights), np.array([first, last]), found, at_ends)
    return made._replace(at_ends=(found[0],) * 2) if made.uniform else made


def _turn(line: Line, first: float, last: float) -> float:
    """The turn of the sections' axes between two places [rad]."""
    near = INSIDE * (last - first)
    R = line.axes(np.linspace(first + near, last - near, SAMPLES))
    chords = np.linalg.norm(R[1:] - R[:-1], axis=(1, 2)) / np.sqrt(8)
    return float(2 * np.arcsin(np.minimum(chords, 1.0)).sum())


def exact_elements(line: Line, rules: list[Rule], pairs: NDArray, planar: bool = False
                   ) -> list[BeamElements]:
    """Elements on a line; those with equally many points of integration together.

    Parameters
    ----------
    rules : list of n Rule
    pairs : (n, 2)
        Nodes at both ends of each.
    """
    counts = np.array([len(one.places) for one in rules])
    made = []
    for count in np.unique(counts):
        own = np.flatnonzero(counts == count)
        each = [_element(line, rules[k], planar) for k in own]
        stacked = {name: np.array([one[name] for one in each]) for name in each[0]}
        made.append(BeamElements(pairs[own], sections=[rules[k].at_ends for k in own], **stacked))
    return made


def _element(line: Line, own: Rule, planar: bool) -> dict[str, NDArray]:
    r, w = line.position(own.places), own.weights
    ra, rb = line.position(own.ends)
    r, rb, origin = r - ra, rb - ra, ra
    R = line.axes(own.places)
    both = np.zeros((len(r), 6, 6))
    both[:, :3, :3] = both[:, 3:, 3:] = R
    C = both @ np.array([one.flexibility for one in own.sections]) @ both.transpose(0, 2, 1)
    S = both @ np.array([one.damping for one in own.sections]) @ both.transpose(0, 2, 1)
    # with the resultants in the middle and in the axes there, what is stiff stands by itself
    turned = both[len(r) // 2]
    levers = _levers(rb / 2 - r) @ turned                                       # (1)
    flexibility = np.einsum("gji,gjk,gkl,g->il", levers, C, levers, w)          # (2)
    T = turned.T @ np.hstack([-_levers(rb / 2).T, _levers(-rb / 2).T])
    resultants = _inverse(flexibility) @ T
    forces = levers @ resultants                                                # (3)
    strains = C @ forces
    theta, u, slopes = _shapes(strains, r, w, R[:, :, 0])
    D = np.einsum("gia,gij,gjb,g->ab", strains, S, strains, w)                  # (6)
    M = np.array([one.inertia for one in own.sections])
    m, arms = M[:, 0, 0] * w, np.einsum("gij,gj->gi", R, centre_of_mass(M))
    J = symmetric(R @ central_inertia(M) @ R.transpose(0, 2, 1)) * w[:, None, None]
    v = u - skew(arms) @ theta                                                  # (5)
    mass = (np.einsum("gia,gib,g->ab", v, v, m)
            + np.einsum("gia,gij,gjb->ab", theta, J, theta))
    d, a, k = (2, slice(2, 3), IN_PLANE) if planar else (3, slice(0, 3), np.arange(12))
    inner, ends = np.ix_(k, k), _at_ends(line, own, rb, turned @ resultants)
    return {"stiffness": symmetric(T.T @ resultants)[inner], "mass": symmetric(mass)[inner],
            "damping": symmetric(D)[inner], "points": (origin + r + arms)[:, :d],
            "masses": m, "inertia": J[:, a, a], "translation": v[:, :d, k],
            "rotation": theta[:, a, k], "weights": w, "tangents": R[:, :, 0],
            "fields": np.concatenate([theta, slopes, strains[:, 3:]], axis=1)[:, :, k],
            "forces": forces[:, :, k], "end_forces": ends[:, :, k]}


def _shapes(strains: NDArray, r: NDArray, w: NDArray, tangents: NDArray
            ) -> tuple[NDArray, NDArray, NDArray]:
    """Rotation, displacement and its derivative by length of unit DOFs, (g, 3, 12) each: (4)."""
    gamma, kappa = strains[:, :3], strains[:, 3:]
    turned = _integrated(kappa, w)
    u = _integrated(gamma + skew(r) @ kappa, w) - skew(r) @ turned
    u[:, :, :3] += np.eye(3)
    u[:, :, 3:6] -= skew(r)
    turned[:, :, 3:6] += np.eye(3)
    return turned, u, gamma - skew(tangents) @ turned


def _integrated(values: NDArray, w: NDArray) -> NDArray:
    """Integrals (g, ...) from the first end to each point, piece after piece."""
    found, before = np.zeros_like(values), np.zeros(values.shape[1:])
    for first in range(0, len(values), GAUSS):
        piece = slice(first, first + GAUSS)
        length = w[piece].sum()
        found[piece] = before + np.einsum("gh,hij->gij", UPTO, values[piece]) * length
        before = before + np.einsum("g,gij->ij", w[piece], values[piece])
    return found


def _levers(arms: NDArray) -> NDArray:
    """Matrices (..., 6, 6) of forces (N, M) at the ends of arms (..., 3), at their beginnings."""
    found = np.zeros((*arms.shape[:-1], 6, 6))
    found[..., range(6), range(6)] = 1.0
    found[..., 3:, :3] = skew(arms)
    return found


def _inverse(flexibility: NDArray) -> NDArray:
    """Inverse of a symmetric matrix in units that make its diagonal one."""
    scale = 1 / np.sqrt(np.diag(flexibility))
    return symmetric(np.linalg.inv(symmetric(flexibility) * np.outer(scale, scale))
                     ) * np.outer(scale, scale)


def _at_ends(line: Line, own: Rule, rb: NDArray, middle: NDArray) -> NDArray:
    """Section forces of unit DOFs at both ends in axes of the sections there, (2, 6, 12)."""
    near = INSIDE * np.diff(own.ends)
    R = line.axes(own.ends + np.concatenate([near, -near]))
    forces = np.stack([_levers(rb / 2) @ middle, _levers(-rb / 2) @ middle])
    return np.concatenate([R.transpose(0, 2, 1) @ forces[:, :3],
                           R.transpose(0, 2, 1) @ forces[:, 3:]], axis=1)
