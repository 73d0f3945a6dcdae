"""Formulas of contacts, stops, gears and friction: of numbers that they keep in a run.

In the output of variable steps these numbers are those at the end of the step around a recorded
time; forces, works and motions are of the time itself.
"""

from sebody.basics.errors import InputError
from sebody.kernels.loader import element_kernel
from sebody.model.parts import Element
from sebody.quantities.expressions import Number, positive
from sebody.quantities.numbers import Numbers, Parts

# force below which nothing presses: derivatives of powers and roots must exist at zero, so forces
# of what is open are rounded up
OPEN = 1e-100


def pressing(of: Parts) -> dict[str, Element]:
    """Contacts, stops, gears and friction by name."""
    return {load.name: load for load in of.model.loads
            if "normal" in element_kernel(load.kind).MEMORY}


def has(element: Element, quantity: str) -> bool:
    """Tell whether an element has one of the quantities of this module."""
    memory = element_kernel(element.kind).MEMORY
    return {"gap": "depth", "normal_force": "normal"}.get(quantity, "slid") in memory


def normal_force(of: Numbers, name: str) -> Number:
    """Force along the normal, or moment of a stop of an angle."""
    normal = _kept(of, name, "normal")
    return normal * positive(normal - OPEN)


def gap(of: Numbers, name: str) -> Number:
    """Distance from the surface or the nearest limit, negative inside."""
    return -_kept(of, name, "depth", "gap")


def sticks(of: Numbers, name: str) -> Number:
    """One where the friction sticks, zero where it slides or nothing presses."""
    pressed = positive(_kept(of, name, "normal") - OPEN)
    return pressed * positive(0.5 - _kept(of, name, "slid", "sticks"))


def dissipation(of: Numbers, name: str) -> Number:
    """Energy that has become heat since the start.

    That is minus the work, less what bent bristles give back. It never falls but by rounding and,
    in the step in which a sliding joint turns back, by the energy of a bent bristle at most.
    """
    element = pressing(of)[name]
    lost = -of.recorded("works", of.numbering.port_names.index(name))
    stiffness = of.numbering.bristles.get(element, 0.0) if of.numbering.bristles else 0.0
    for bent in (k for k in element_kernel(element.kind).MEMORY if k.startswith("bent")):
        z = _kept(of, name, bent)
        at_start = of.started(of.numbering.memories[element][
            element_kernel(element.kind).MEMORY.index(bent)])
        lost = lost - 0.5 * stiffness * (z * z - at_start * at_start)
    return lost


def _kept(of: Numbers, name: str, number: str, quantity: str = "") -> Number:
    element = pressing(of)[name]
    memory = element_kernel(element.kind).MEMORY
    if number not in memory:
        raise InputError(f"{name!r} has no {quantity}: " + (
            "it has no friction" if quantity == "sticks" else
            "it is friction in a joint, whose parts always touch"))
    return of.recorded("frames", of.numbering.memories[element][memory.index(number)])
