"""Rigid motion made free of force, and what that leaves wrong."""

from dataclasses import replace

import numpy as np

from sebody.basics.errors import InputError
from sebody.explore.inspection.measures import frequencies, matrices_of
from sebody.io.body_file import BodyFile
from sebody.reduction.checks import rigid_residual, unit_scale

# Residuals beyond this are of supports, wrong coordinates or wrong order, not of printed digits.
LARGEST = 1e-2


def free_rigid_motion(file: BodyFile) -> tuple[BodyFile, list[str]]:
    """The body with ``K := P^T K P``, ``P`` the projector that takes rigid motion away.

    P leaves internal modes alone and is orthogonal in unit-free form, so the change is smallest.

    Returns
    -------
    file : BodyFile
    said : list of str
        What was changed and what cannot be.

    Raises
    ------
    InputError
        Residuals that are no loss of digits.
    """
    body = matrices_of(file)
    before, row = rigid_residual(body.stiffness, body.rigid, body.names)
    if before > LARGEST:
        raise InputError(f"|K R| is {before:.3e} of |K| |R|, worst in {body.names[row]}: beyond "
                         f"{LARGEST:.0e} this is not a loss of digits; remove supports from the FE "
                         "model, check coordinates, axes and order of the rows")
    scale = unit_scale(body.stiffness, body.names)
    motions = np.linalg.qr(body.rigid * scale[:, None])[0]
    remove = np.eye(len(scale)) - motions @ motions.T
    unit_free = remove @ (body.stiffness / np.outer(scale, scale)) @ remove
    stiffness = (unit_free + unit_free.T) / 2 * np.outer(scale, scale)
    repaired = replace(file, parts=file.parts | {"stiffness": stiffness},
                       changed=tuple(name for name in file.changed if name != "stiffness"),
                       provenance={**file.provenance, "repair": f"rigid motion projected, |K R| "
                                   f"was {before:.3e} of |K| |R|"})
    repaired, constants = _without_contradictions(repaired)
    after = rigid_residual(stiffness, body.rigid, body.names)[0]
    old, new = (frequencies(matrices_of(one)) for one in (file, repaired))
    said = [f"rigid motion projected: |K R| {before:.3e} -> {after:.3e} of |K| |R|"]
    if len(new["flexible"]):
        said.append(f"first flexible frequency {old['flexible'][0]:.6g} -> "
                    f"{new['flexible'][0]:.6g} Hz")
    softest = _softest(stiffness, body.rigid.shape[1], scale)
    said.append("not repaired: errors of the same size, which the other motions keep; the softest "
                f"one has {softest:.3e} of |K|, so up to {min(1.0, before / softest):.1%} of its "
                "stiffness may be wrong. Only an export with 14 digits before reducing repairs "
                "this")
    return repaired, said + constants


def _without_contradictions(file: BodyFile) -> tuple[BodyFile, list[str]]:
    """The body without stiffening constants that have more stiffness than is left."""
    old = file.parts.get("invariants")
    try:
        file.body()
    except InputError:
        if old is None or not len(old.lam):
            return file, []
        n = len(file.parts["stiffness"])
        new = replace(old, lam=np.zeros(0), E=np.zeros((n, 0)), Ghat=np.zeros((0, n, n)))
        return replace(file, parts=file.parts | {"invariants": new}), [
            "left out: the stress resultants of stiffening, which contradict the stiffness"]
    return file, []


def _softest(stiffness: np.ndarray, rigid: int, scale: np.ndarray) -> float:
    """Lowest unit-free eigenvalue beyond the rigid motions, over the norm of the matrix."""
    unit_free = stiffness / np.outer(scale, scale)
    return float(np.linalg.eigvalsh(unit_free)[rigid] / np.linalg.norm(unit_free))
