"""Another frame, inertia or stiffening of a superelement."""

from sebody.model.inertias import known_inertia
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Superelement
from sebody.model.variants.copying import Variant, copied, exchange, placed


def with_options(model: Mechanism, name: str, frame: str | None = None, inertia: str | None = None,
                 stiffening: bool | None = None) -> Variant:
    """The model with other options of a superelement, see `Model.superelement`.

    Parameters
    ----------
    name : str
        Of the superelement.
    frame, inertia : str, optional
        As before by default.
    stiffening : bool, optional
        As before by default; of another inertia as the body and the inertia have it.

    Returns
    -------
    Variant

    Raises
    ------
    InputError
        An unknown superelement, or options that do not go with one another or with the body.
    """
    before, inertia = placed(model, name), known_inertia(inertia)
    made = copied(model)
    old = made.bodies[name]
    if stiffening is None and inertia in (None, old.inertia):
        stiffening = old.stiffening
    after = exchange(made, old, old.reduced, old.frame if frame is None else frame,
                     old.inertia if inertia is None else inertia, stiffening)
    return Variant(made, f"{name} {_change(before, after)}")


def _change(before: Superelement, after: Superelement) -> str:
    changes = [f"has {what} {getattr(after, what)!r} instead of {getattr(before, what)!r}"
               for what in ("frame", "inertia") if getattr(after, what) != getattr(before, what)]
    if after.stiffening != before.stiffening:
        changes.append("stiffens with its stresses" if after.stiffening else
                       "does not stiffen with its stresses")
    return " and ".join(changes) or "stays as it is"
