"""Lacks of a body, and why: stresses, stiffening by stresses, exact inertia, damping.

Every reason is a text ``why; what to do``.
"""

from collections.abc import Mapping

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.model import FEModel

WHAT = ("stresses", "stiffening", "exact inertia", "damping", "structural damping")
_REDUCED = ("the body was made without it, such as of reduced matrices alone; import or reduce the "
            "FE model with its mesh and materials")
_OF_MODEL = {
    "stresses": "the FE model has no stress operators; give FEModel(stress=solid_stress(...))",
    "stiffening": "the FE model has no geometric stiffness; give FEModel(geometric_stiffness=...), "
                  "or divide the body if it spins fast or carries high loads",
    "exact inertia": "the mass is not that of points at the nodes, as where nodal rotations carry "
                     "a consistent mass; give FEModel(mass_field=...)"}
_MACNEAL = "residual modes carry no mass in MacNeal's method; use Rubin's, method 'rubin'"


def missing_of(fe_model: FEModel, method: str) -> dict[str, str]:
    """Lacks of a body that is reduced from an FE model by a method, with reasons."""
    has = {"stresses": bool(fe_model.stress),
           "stiffening": fe_model.geometric_stiffness is not None,
           "exact inertia": fe_model.mass_field is not None}
    reasons = {what: _OF_MODEL[what] for what in has if not has[what]} | dict(fe_model.missing)
    if method == "macneal":
        reasons |= dict.fromkeys(("stiffening", "exact inertia"), _MACNEAL)
    elif not has["exact inertia"]:
        reasons["stiffening"] = reasons["exact inertia"]        # which it takes
    return reasons


def checked_missing(reasons: Mapping[str, str], what: str = "missing") -> dict[str, str]:
    """Reasons by what is missing.

    Raises
    ------
    InputError
        Something else.
    """
    remedy = f"give a dict of texts with keys of {', '.join(WHAT)}"
    if not isinstance(reasons, Mapping):
        raise inputs.refusal(what, reasons, remedy)
    for key, reason in reasons.items():
        if key not in WHAT or not isinstance(reason, str):
            raise InputError(f"{what} has {inputs.shown(key)}: {inputs.shown(reason)}; {remedy}")
    return dict(reasons)


def lacks(stressed: bool, exact: bool, missing: Mapping[str, str]) -> dict[str, str]:
    """Lacks of a body, with reasons.

    Parameters
    ----------
    stressed, exact : bool
        Whether it has stresses and the constants of its exact inertia.
    missing : mapping of str to str
        The reasons that its source has given.
    """
    reasons = {} if stressed else {"stresses": _REDUCED}
    if not exact:
        reasons |= dict.fromkeys(("stiffening", "exact inertia"), _REDUCED)
    return reasons | dict(missing)


def sentences(found: Mapping[str, str], stressed: bool) -> list[str]:
    """Lacks in sentences, those with one reason together."""
    reasons: dict[str, list[str]] = {}
    for what, reason in found.items():
        reasons.setdefault(reason, []).append(what)
    texts = []
    for reason, names in reasons.items():
        whole = [name for name in names if not (stressed and name == "stresses")]
        parts = [f"no {' or '.join(filter(None, [', '.join(whole[:-1]), whole[-1]]))}"
                 ] if whole else []
        parts += ["no stresses in some elements"] if len(whole) < len(names) else []
        texts.append(f"{', and '.join(parts)}: {reason}")
    return texts
