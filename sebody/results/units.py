"""Units of quantities: in words, or by name where the model has units."""

from sebody.basics.units import Units

OF_QUANTITY = {
    "t": "time", "position": "length", "displacement": "length", "velocity": "length/time",
    "acceleration": "length/time^2", "rotation": "rotation matrix, in a plane rad",
    "angular_velocity": "rad/time", "angular_acceleration": "rad/time^2",
    "reaction": "force", "force": "force", "local_force": "force", "thrust": "force",
    "reaction_moment": "force length", "moment": "force length", "local_moment": "force length",
    "torque": "force length", "power": "force length/time", "work": "force length",
    "section_forces": "force, from the fourth on force length",
    "stress": "force/length^2", "von_mises": "force/length^2",
}
OF_MODEL = {
    "momentum": "mass length/time", "angular_momentum": "mass length^2/time",
    "constraints.position": "length", "constraints.velocity": "length/time",
}


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
    known = OF_MODEL.get(name) or OF_QUANTITY.get(last)
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
