"""What contacts, stops, gears and friction tell of themselves: numbers that they keep in a run.

In the output of variable steps these numbers are those at the end of the step around a recorded
time; forces, works and motions are of the time itself.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import Numbering
from sebody.basics.errors import InputError
from sebody.kernels.loader import element_kernel
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element
from sebody.results.recording import Recording


def pressing(recording: Recording) -> dict[str, Element]:
    """Contacts, stops, gears and friction by name."""
    return {load.name: load for load in recording.model.loads
            if "normal" in element_kernel(load.kind).MEMORY}


def has(element: Element, quantity: str) -> bool:
    """Whether an element has one of the quantities of this module."""
    memory = element_kernel(element.kind).MEMORY
    return {"gap": "depth", "normal_force": "normal"}.get(quantity, "slid") in memory


def normal_force(recording: Recording, name: str) -> NDArray:
    """Force along the normal, or moment of a stop of an angle, (n,)."""
    return _kept(recording, name, "normal")


def gap(recording: Recording, name: str) -> NDArray:
    """Distance from the surface or the nearest limit, negative inside, (n,)."""
    return -_kept(recording, name, "depth", "gap")


def sticks(recording: Recording, name: str) -> NDArray:
    """1 where the friction sticks, 0 where it slides or nothing presses, (n,)."""
    pressed = _kept(recording, name, "normal") > 0.0
    return (pressed & (_kept(recording, name, "slid", "sticks") < 0.5)).astype(float)


def dissipation(recording: Recording, name: str) -> NDArray:
    """Energy that has become heat since the start, (n,).

    That is minus the work, less what bent bristles give back. It never falls but by rounding and,
    in the step in which a sliding joint turns back, by the energy of a bent bristle at most.
    """
    element = pressing(recording)[name]
    port = recording.numbering.port_names.index(name)
    lost = -recording.recorded("works")[:, port]
    bent = [k for k in element_kernel(element.kind).MEMORY if k.startswith("bent")]
    if not bent or not recording.numbering.bristles:
        return lost
    size = sum((_kept(recording, name, k)**2 for k in bent), np.zeros(len(lost)))
    return lost - 0.5 * recording.numbering.bristles[element] * (size - size[0])


def states(model: Mechanism, numbering: Numbering, frames: NDArray) -> dict[str, str]:
    """What every contact, stop and friction is in: sticks, slides, presses or open."""
    states_by_name = {}
    for load in model.loads:
        memory = element_kernel(load.kind).MEMORY
        if "normal" not in memory:
            continue
        own = dict(zip(memory, frames[numbering.memories[load]], strict=True))
        if not own["normal"] > 0:
            states_by_name[load.name] = "open"
        elif load.constants.get("static", 0.0) == 0.0:
            states_by_name[load.name] = "presses"
        else:
            states_by_name[load.name] = "slides" if own["slid"] > 0.5 else "sticks"
    return states_by_name


def _kept(recording: Recording, name: str, number: str, quantity: str = "") -> NDArray:
    element = pressing(recording)[name]
    memory = element_kernel(element.kind).MEMORY
    if number not in memory:
        raise InputError(f"{name!r} has no {quantity}: " + (
            "it has no friction" if quantity == "sticks" else
            "it is friction in a joint, whose parts always touch"))
    places = recording.numbering.memories[element]
    return np.asarray(recording.recorded("frames")[:, places[memory.index(number)]])


def normal_forces(model: Mechanism) -> list[str]:
    """What presses in the friction of joints: equations of the joint, or a preload alone."""
    rubbing = [load for load in model.loads if "friction" in load.kind]
    read = {load.name: load.pressed_by.name for load in rubbing if load.pressed_by is not None}
    preloaded = [load.name for load in rubbing if load.name not in read]
    found = [f"{', '.join(read)}: read from equations of {', '.join(dict.fromkeys(read.values()))}"
             ] if read else []
    return [*found, *([f"{', '.join(preloaded)}: the preload alone"] if preloaded else [])]
