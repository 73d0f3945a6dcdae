"""Units of quantities in words: numbers have none, but the file of a result says what they are."""

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


def unit(name: str) -> str:
    """Unit of a quantity by its full name, in words; empty if it has none that is known."""
    whole, _, last = name.rpartition(".")
    if name == "energy" or whole == "energy":
        return "force length"
    known = OF_MODEL.get(name) or OF_QUANTITY.get(last)
    if known is not None or not whole:
        return known or ""
    if whole.endswith(".rotation") and last in ("x", "y", "z", "norm"):
        return "rad"            # of the rotation vector
    return unit(whole)          # of a component that of the quantity
