"""Fewer internal modes of a superelement."""

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.mechanism import Mechanism
from sebody.model.variants.copying import Variant, copied, exchange, placed
from sebody.reduction.summary import frequencies
from sebody.reduction.truncation import truncated


def keep_modes(model: Mechanism, name: str, modes: int) -> Variant:
    """The model with the first internal modes of a superelement alone, see `truncated`.

    Parameters
    ----------
    name : str
        Of the superelement.
    modes : int
        How many to keep.

    Returns
    -------
    Variant

    Raises
    ------
    InputError
        An unknown superelement, more modes than there are, or a force on a mode left out.
    """
    before = placed(model, name).reduced
    modes = inputs.integer(modes, f"modes of superelement {name!r}", least=0, most=before.modes,
                           remedy=f"it has {before.modes}: keep 0 to {before.modes}")
    for load in model.loads:
        if load.mode is not None and load.mode[0] == name and load.mode[1] >= modes:
            raise InputError(f"{load.name!r} acts on mode {load.mode[1]} of superelement {name!r}: "
                             f"keep {load.mode[1] + 1} modes or more")
    made = copied(model)
    old = made.bodies[name]
    exchange(made, old, truncated(old.reduced, modes), old.frame, old.inertia, old.stiffening)
    kept = f"{modes} of its {before.modes} internal modes" if modes else "no internal modes"
    left = frequencies(before.stiffness, before.mass, before.modes)[modes:]
    ending = f"; first omitted mode: {left[0]:.4g}" if len(left) else ""
    return Variant(made, f"{name} keeps {kept}{ending}")
