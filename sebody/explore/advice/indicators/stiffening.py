"""Change of stiffness by stresses and spin that a form of a body neglects."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from sebody.explore.advice.forms import Form, Part
from sebody.explore.advice.indicators.coordinates import compliance, flat, nodal
from sebody.explore.advice.indicators.propagated import Force, propagated
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.indicators.vibration import detuned, strain_force
from sebody.generated.options import INERTIA_OPTIONS
from sebody.model.parts import Node
from sebody.reduction.body import ReducedBody

RIGID = 1e-9        # of squared frequencies, below which a motion of the boundary is rigid


def stiffening(recorded: Recorded, part: Part, form: Form) -> float:
    """Error from forces of second order that a form neglects.

    With the recorded boundary deformation y of a body the strains of its resultants are
    ``e = E . y + y . Ghat y / (2 lam)``. Their forces ``sum e Ghat y`` stiffen: the body gives way
    to them as its stiffness allows, and the work that they do on y, relative to its strain energy,
    changes the period of the vibration. What bends shortens: by displacements u with the strains
    ``E . u = y . Ghat y / (2 lam)``.
    """
    if form.stiffening:
        return 0.0
    whole = recorded.nodes(part)
    shifts, turns = (0.0 * one for one in recorded.deformation(whole)[:2])
    work = energy = 0.0
    force = Force()
    for nodes, body in recorded.bodies(part, form.bodies):
        if body.invariants is None or not body.invariants.resultants:
            continue
        n = len(body.stiffness) - body.modes
        deformation = recorded.deformation(nodes)
        y = flat(body, deformation.shifts, deformation.turns)
        forces, shorter = _second_order(body, y, np.nan_to_num(deformation.turns))
        one, other = nodal(body, forces @ compliance(body) + shorter)
        places = [whole.index(node) for node in nodes]
        shifts[:, places] += one
        turns[:, places] += other
        energy += np.einsum("ni,ij,nj->n", y, body.stiffness[:n, :n], y).mean()
        work += float((y * forces).sum(axis=1).mean())
        force = force.with_(Force.of(body, forces))
    return (propagated(recorded, part, shifts, turns, force)
            + detuned(recorded, part, min(abs(work) / max(energy, 1e-300) / 2, 1.0)))


def _second_order(body: ReducedBody, y: NDArray, turns: NDArray) -> tuple[NDArray, NDArray]:
    """Forces at the boundary, and its displacements by shortening, (n, boundary).

    What bends without tension has ``E . y`` and the shortening of opposite signs; their difference
    is known to the square of the rotations alone, by which the shortening is off.
    """
    i, n = body.invariants, y.shape[1]
    E, G = i.E[:n], i.Ghat[:, :n, :n]
    shorter = np.einsum("ni,eij,nj->ne", y, G, y, optimize=True) / (2.0 * i.lam)
    strains = y @ E + shorter
    unknown = (turns**2).sum(axis=2).max(axis=1)[:, None] * np.abs(shorter)
    known = np.sign(strains) * np.maximum(np.abs(strains) - unknown, 0.0)
    # of displacements with these strains of the resultants, the smallest
    return (np.einsum("ne,eij,nj->ni", known, G, y, optimize=True),
            shorter @ np.linalg.pinv(E))


def spin(recorded: Recorded, part: Part, form: Form) -> float:
    """Error of options that soften with a spin, by a share of ``spin^2 / frequency^2``.

    The frequencies are those of the vibrations of the boundary that the recorded motion has.
    """
    share = INERTIA_OPTIONS[form.inertia].softening
    if share == 0.0:
        return 0.0
    change = share * max(_softened(recorded, nodes, body)
                         for nodes, body in recorded.bodies(part, form.bodies))
    whole = recorded.deformation(recorded.nodes(part))
    return (min(change, 1.0) * propagated(recorded, part, whole.shifts, whole.turns,
                                       strain_force(recorded, part))
            + detuned(recorded, part, min(change / 2, 1.0)))


def _softened(recorded: Recorded, nodes: list[Node], body: ReducedBody) -> float:
    """Mean of ``spin^2 / frequency^2`` of the vibrations of the boundary, as large as they are."""
    deformation = recorded.deformation(nodes)
    u = flat(body, np.nan_to_num(deformation.shifts), np.nan_to_num(deformation.turns))
    n = u.shape[1]
    squares, shapes = eigh(body.stiffness[:n, :n], body.mass[:n, :n])
    flexible = squares > RIGID * squares[-1]
    sizes = (u @ body.mass[:n, :n] @ shapes[:, flexible])**2
    spins = np.linalg.norm(recorded.spins(nodes), axis=1)**2
    if not sizes.any():
        return 0.0
    return float((spins @ sizes[1:] / squares[flexible]).sum() / sizes[1:].sum())
