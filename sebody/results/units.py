"""Units of quantities: in words, or by name where the model has units."""

from sebody.basics.units import Units
from sebody.quantities.table import OF_MODEL, OWNERS

OF_QUANTITY = {name: row.unit for owner in OWNERS for name, row in owner.quantities.items()
               if row.unit}


def unit(name: str, units: Units | None = None) -> str:
    """Unit of a quantity or of a component of one by its full name; empty if none is known.

    Parameters
    ----------
    name : str
    units : Units, optional
        Of the model; in words without them, such as ``length/time``.
    """
    words = _words(name)
    return words if units is None else units.of(words)


def _words(name: str) -> str:
    whole, _, last = name.rpartition(".")
    if name == "energy" or whole == "energy":
        return "force length"
    known = OF_MODEL[name].unit if name in OF_MODEL else OF_QUANTITY.get(last)
    if known is not None or not whole:
        return known or ""
    if whole.endswith(".rotation") and last in ("x", "y", "z", "norm"):
        return "rad"            # of the rotation vector
    return _words(whole)        # of a component that of the quantity


def unit_of_curves(name: str, units: Units | None = None) -> str:
    """Unit of what is drawn of a quantity: as `unit`, but rad of a rotation."""
    return "rad" if name.rpartition(".")[2] == "rotation" else unit(name, units)


def with_unit(label: str, name: str, units: Units | None) -> str:
    """The label of an axis or a legend, with the unit of a quantity if the model has units."""
    unit = "" if units is None else unit_of_curves(name, units).replace("^2", "\u00b2")
    return f"{label} [{unit}]" if unit else label
