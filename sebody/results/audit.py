"""Judgements of a run by what mechanics keeps: energy, momenta, constraints."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import rotational
from sebody.basics.vectors import moment_of
from sebody.contract.layout import ENERGIES
from sebody.model.extent import extent
from sebody.model.numbering import record_counts, stretch
from sebody.model.parts import Element, Node, Superelement
from sebody.quantities import forces
from sebody.results import energy_balance
from sebody.results.histories import histories
from sebody.results.recording import Recording

DRIFT = 1e-5        # constraints, of the model's size or rad: a thousand times a step's tolerance
GOOD = 0.2          # of a limit, up to which a number is good
IMPULSE = 0.05      # share of the impulse exchanged, as of energies
RATES = 1e-3        # rates of constraints, of the largest speed: as errors of a step may be
SAMPLED = 0.5       # of a difference: sampling that explains so much of it
VERDICTS = "good", "acceptable", "bad", "not judged"


class Finding(NamedTuple):
    """One thing that was audited."""

    what: str
    value: str
    verdict: str        # one of VERDICTS
    reason: str         # what the value is compared with, and what to do if it is bad


def audit(result: Recording) -> list[Finding]:
    """Completion, energy, momenta and constraints of a run, each with a verdict."""
    lines = [_completion(result), _energy(result)]
    lines += [_momentum(result, name) for name in ("momentum", "angular momentum")]
    if result.numbering.multipliers:
        lines += _constraints(result)
    if result.error is not None:
        lines.append(Finding("error in time", f"{result.error:.2g} of the tolerance",
                             "good" if result.error <= 1 else "bad",
                             "estimated from the difference of two runs; limit 1"))
    return lines


def momentum_defect(result: Recording, angular: bool) -> tuple[NDArray, NDArray]:
    """Momentum beyond the impulse of all forces from outside, (n, c), and its doubt.

    The impulse is that of everything that acts on the bodies: what they do to each other adds up
    to zero. It is integrated over the recorded states by trapezoids; the doubt is the difference
    to the integral over every other state, three times the error of the finer one where both are
    fine.
    """
    t = result.recorded("t")[:, 0]
    total, moment = _acting(result)
    rate = moment if angular else total
    momentum = _sums(result, "moment" if angular else "momentum")
    impulse = _integral(t, rate)
    coarse = np.column_stack([np.interp(t, t[::2], column)
                              for column in _integral(t[::2], rate[::2]).T])
    doubt = np.abs(impulse - coarse)[::2].max(axis=0)
    return momentum - momentum[0] - impulse, doubt


def _completion(result: Recording) -> Finding:
    t = result.recorded("t")[:, 0]
    if result.failure:
        return Finding("completion", f"ended at t = {t[-1]:.6g}", "bad", result.failure)
    return Finding("completion", f"t = {t[-1]:.6g} reached", "good", "the whole time was computed")


def _energy(result: Recording) -> Finding:
    balance = result.energy_balance()
    return Finding("energy", f"{balance:.2e}", _verdict(balance / energy_balance.LIMIT),
                   f"largest drift / energy exchanged; limit {energy_balance.LIMIT:g}. "
                   "Numerical damping and long steps dissipate energy: use a smaller step or a "
                   "larger rho")


def _momentum(result: Recording, what: str) -> Finding:
    angular = what != "momentum"
    defect, doubt = momentum_defect(result, angular)
    total, moment = _acting(result)
    t = result.recorded("t")[:, 0]
    held = np.abs(_sums(result, "moment" if angular else "momentum")).max()
    exchanged = max(_integral(t, np.abs(moment if angular else total)).max(), held, 1e-300)
    value = np.abs(defect).max() / exchanged
    sampled = doubt.max() / exchanged
    reason = ("(change - impulse of all external forces) / impulse exchanged; "
              f"limit {IMPULSE:g}")
    if value > GOOD * IMPULSE and sampled > SAMPLED * value:
        return Finding(what, f"{value:.2e}", "not judged", f"{reason}. The recorded states are too "
                       f"far apart to integrate the forces (error {sampled:.1e}): keep more states")
    return Finding(what, f"{value:.2e}", _verdict(value / IMPULSE),
                   f"{reason}. Smaller steps improve it")


def _constraints(result: Recording) -> list[Finding]:
    size = extent(result.model) or 1.0
    residuals = result.constraint_residuals.max(axis=0)
    off, rate = residuals[0] / size, residuals[1] / max(_fastest(result, size), 1e-300)
    return [Finding("constraints", f"{off:.1e}", _verdict(off / DRIFT),
                    f"largest residual / characteristic length; limit {DRIFT:g}. A smaller "
                    "tolerance of the scheme reduces it"),
            Finding("rates of constraints", f"{rate:.1e}", _verdict(rate / RATES),
                    f"largest residual / largest speed; limit {RATES:g}. Index 2 reduces it to "
                    "rounding errors")]


def _fastest(result: Recording, size: float) -> float:
    """Largest speed of a coordinate, of rotations at the characteristic length."""
    moving = np.abs(result.recorded("v")).max(axis=0)
    turning = rotational(result.model, result.numbering)
    multipliers = [first + k for constraint in result.model.constraints
                   for first in (result.numbering.multipliers[constraint],)
                   for k in range(constraint.multipliers)]
    moving[multipliers] = 0.0
    return float((np.where(turning, size, 1.0) * moving).max(initial=0.0))


def _verdict(share: float) -> str:
    return "good" if share <= GOOD else "acceptable" if share <= 1.0 else "bad"


def _acting(result: Recording) -> tuple[NDArray, NDArray]:
    """Sum of the forces on all bodies and of their moments about the origin, (n, D) and (n, 3|1).
    """
    model, n = result.model, len(result.rows)
    total = np.zeros((n, model.dimension))
    moment = np.zeros((n, model.rotation_size))
    mass, first = 0.0, np.zeros(model.dimension)
    for body in forces.bodies(result).values():
        own, arm = _mass(body)
        mass, first = mass + own, first + arm
        for place in body.attachments:
            values = -histories(result).on(body, *place)
            if place.kind == "rotation":
                moment += values
            else:
                total += values
                moment += moment_of(result.recorded("q")[:, stretch(
                    result.numbering, place.dof_block)], values)
    weight = mass * result.gravity
    # the first moment of mass moves on with the momentum
    moved = first + _integral(result.recorded("t")[:, 0],
                              _sums(result, "momentum")[:, :model.dimension])
    moment += moment_of(moved, result.gravity)
    if model.planar:
        total = np.column_stack([total + weight, np.zeros(n)])
        moment = np.column_stack([np.zeros((n, 2)), moment])
        return total, moment
    return total + weight, moment


def _mass(body: Superelement | Element) -> tuple[float, NDArray]:
    """Mass of a body and its first moment about the origin at the start."""
    if isinstance(body, Superelement):
        held: list[Node] = [body.nodes[i] for i in body.reduced.position_nodes]
        reduced = body.reduced
        shift = np.mean([node.point for node in held], axis=0) - reduced.coordinates[
            list(reduced.position_nodes)].mean(axis=0)
        return reduced.total_mass, reduced.total_mass * (reduced.centre_of_mass + shift)
    mass, node = body.number("mass"), body.attachments[0].node
    return mass, mass * node.point + np.asarray(body.constants.get("mc", 0.0))


def _sums(result: Recording, name: str) -> NDArray:
    """One of the sums of `layout.ENERGIES`, (n, c)."""
    return result.energies[:, ENERGIES.slices(record_counts(result.numbering))[name]]


def _integral(t: NDArray, rates: NDArray) -> NDArray:
    """Integral from the first state on by trapezoids, (n, c)."""
    integral = np.zeros_like(rates)
    np.cumsum(np.diff(t)[:, None] * (rates[1:] + rates[:-1]) / 2, axis=0, out=integral[1:])
    return integral
