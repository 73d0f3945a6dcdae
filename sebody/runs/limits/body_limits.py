"""Limits of one body: what theory says of its spin, its local rotations and its axial force."""

from collections.abc import Collection, Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.contract.counts import Counts
from sebody.model.frames import FRAMES, mass_off_line
from sebody.model.parts import Superelement
from sebody.runs.limits.axial import Axial
from sebody.runs.limits.spin_stability import cautious_limit, divergence, first_frequency, reach
from sebody.runs.limits.thresholds import AXIAL, BENT, FAST, FLAT, LINEAR, MISSED, TURNED


class Finding(NamedTuple):
    """A limit that a body exceeds."""

    kind: str
    body: str           # its name
    excess: float       # how far; of findings of a kind the largest is the worst
    message: str


class Limits(NamedTuple):
    """Numbers that the states of a body are compared with."""

    spin: float             # below which nothing is compared
    crooked: bool           # its mass is off the line of its nodes
    off_line: bool          # and its frame follows rotations
    axial: Axial | None     # None where no axial force matters


def limits_of(bodies: Iterable[Superelement]) -> dict[str, Limits]:
    """Those of some bodies by name, equal ones computed once."""
    known: dict[tuple, Limits] = {}
    limits = {}
    for body in bodies:
        key = body.reduced, body.frame, body.inertia, body.stiffening, tuple(body.alpha_r)
        if key not in known:
            crooked = mass_off_line(body.reduced)
            known[key] = Limits(np.inf if body.stiffening else FAST * cautious_limit(body),
                                crooked, crooked and _follows_rotations(body), Axial.of(body))
        limits[body.name] = known[key]
    return limits


def exceeded(body: Superelement, limits: Limits, y: NDArray, spins: NDArray, local: float,
             between: float, said: Collection[str]) -> Iterator[Finding]:
    """Limits that a body exceeds in some states, of kinds that are not in `said`.

    Parameters
    ----------
    y : (k, n)
        Reduced coordinates.
    spins : (k, 3) or (k, 1)
        Of the frame, in its axes.
    local : float
        Largest rotation of a node relative to the frame [rad].
    between : float
        The same of a node relative to another one.
    """
    name = body.name
    if local > LINEAR:
        yield Finding("turn", name, local, f"local rotation {local:.2g} rad of body {name!r} "
                      f"exceeds the linear range, {LINEAR} rad: divide the body")
    elif between > TURNED and limits.crooked:
        yield Finding("ends", name, between, f"interfaces of body {name!r}, which is not straight, "
                      f"turn by {between:.2g} rad against each other (limit {TURNED} rad): places "
                      f"are off by about {MISSED * between**2:.1g} of its size, {MISSED} of the "
                      "square, at any step and number of modes; divide the body")
    if local > BENT and limits.off_line:
        yield Finding("bent", name, local, f"local rotation {local:.2g} rad of body {name!r}, "
                      "whose frame follows the rotations of its nodes while its mass is off "
                      f"their line (limit {BENT} rad): its inertia depends too much on how it "
                      "is bent, and energy may grow; take the frame 'mean_axes', or "
                      "divide the body")
    speeds = np.linalg.norm(spins, axis=1)
    if "spin" not in said and speeds.max() > limits.spin:
        row = int(np.argmax(speeds))
        yield from _too_fast(body, spins[row], speeds[row])
    elif limits.axial is not None and "axial" not in said:
        yield from _too_strong(body, limits.axial, y)


def flat(body: Superelement) -> Finding | None:
    """Tell whether a frame follows positions that lie nearly on a line."""
    spread, traits = _spread(body), FRAMES[body.frame].traits
    if traits.needs_rotations or traits.modes or body.reduced.planar or spread >= FLAT:
        return None
    return Finding("flat", body.name, 1.0 / max(spread, 1e-300), f"nodes of body {body.name!r} lie "
                   f"nearly on a line (spread {spread:.1e} of their length): its frame turns about "
                   "it with every small deflection; keep a rotation and take another frame, or a "
                   "node off the line")


def local_rotations(y: NDArray, counts: Counts) -> NDArray:
    """Rotation vectors of the nodes in their body frames, (states, bodies, nodes, turns)."""
    first, turns = counts["D"] * counts["N_POSITIONS"], counts["turns"]
    return y[..., first:first + turns * counts["N_ROTATIONS"]].reshape(*y.shape[:2], -1, turns)


def between_nodes(psi: NDArray) -> NDArray:
    """Largest rotation of a node relative to another one, (states, bodies), to second order.

    Of the node that has turned most against the first, relative to all others: of many nodes the
    largest may be a seventh larger.
    """
    if not psi.shape[2]:
        return np.zeros(psi.shape[:2])
    furthest = np.linalg.norm(psi - psi[:, :, :1], axis=3).argmax(axis=2)
    chosen = np.take_along_axis(psi, furthest[:, :, None, None], axis=2)
    return np.linalg.norm(psi - chosen, axis=3).max(axis=2)


def _follows_rotations(body: Superelement) -> bool:
    """True for a body of option C with its frame on rotations."""
    return body.inertia == "floating_field" and FRAMES[body.frame].traits.needs_rotations


def _too_fast(body: Superelement, spin: NDArray, speed: float) -> Iterator[Finding]:
    """A spin that bodies without stiffening do not follow."""
    axis = np.array([0.0, 0.0, 1.0]) if body.reduced.planar else spin / speed
    felt, limit = speed * reach(body, axis), divergence(body, axis)
    first = first_frequency(body)
    if felt > limit:
        yield Finding("spin", body.name, felt / limit, f"spin {speed:.3g} rad/s is above the limit "
                      f"{limit:.3g} of body {body.name!r}, whose stiffness does not grow with it: "
                      f"{remedy(body)}")
    elif felt > FAST * min(limit, first):
        yield Finding("fast", body.name, felt / min(limit, first), f"body {body.name!r} spins at "
                      f"{speed:.3g} rad/s, more than a quarter of {_compared(limit, first)}: its "
                      "stiffness does not grow with the spin, and frequencies have errors of "
                      f"1 % and more; {remedy(body)}")


def _too_strong(body: Superelement, axial: Axial, y: NDArray) -> Iterator[Finding]:
    """An axial force that bodies without stiffening take no notice of."""
    bounds = axial.bound(y)
    if bounds.max() <= AXIAL:
        return
    load = axial.load(y[np.argmax(bounds)])
    if load.share > AXIAL:
        yield Finding("axial", body.name, load.share, f"{load.described} in body {body.name!r} "
                      f"counts {load.share:.2g} times as much as its own bending stiffness (limit "
                      "a third), which does not depend on it: bending has errors of 10 % and more"
                      f"{load.consequence}; {remedy(body)}")


def remedy(body: Superelement) -> str:
    """Remedy for a spin, or an axial force."""
    if body.reduced.invariants is None:
        return "divide the body in two, or reduce it from an FE model with its mass"
    if body.inertia != "floating_field":
        return "divide the body in two, or take inertia='floating_field'"
    if body.reduced.invariants.stiffens:
        return "divide the body in two, or let it stiffen with stiffening=True"
    return "divide the body in two, or give its FE model a geometric stiffness"


def _compared(limit: float, first: float) -> str:
    """Limit that a fast spin is compared with."""
    if first < limit:
        return f"{first:.3g}, the body's first frequency with one node held"
    return f"{limit:.3g}, where it diverges"


def _spread(body: Superelement) -> float:
    """Second largest extent of the nodes that keep a position, of the largest."""
    points = body.reduced.coordinates[list(body.reduced.position_nodes)]
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return float(extents[1] / extents[0]) if len(extents) > 1 and extents[0] > 0 else 0.0
