"""States of contacts, stops and friction in words."""

from numpy.typing import NDArray

from sebody.kernels.loader import element_kernel
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import Element
from sebody.quantities.contacts import OPEN


def states(model: Mechanism, numbering: Numbering, frames: NDArray) -> dict[str, str]:
    """State of every contact, stop and friction: sticks, slides, presses or open."""
    states_by_name = {}
    for load in model.loads:
        memory = element_kernel(load.kind).MEMORY
        if "normal" not in memory:
            continue
        own = dict(zip(memory, frames[numbering.memories[load]], strict=True))
        if not own["normal"] > OPEN and not without_play(load):
            states_by_name[load.name] = "open"
        elif load.constants.get("static", 0.0) == 0.0:
            states_by_name[load.name] = "presses"
        else:
            states_by_name[load.name] = "slides" if own["slid"] > 0.5 else "sticks"
    return states_by_name


def without_play(load: Element) -> bool:
    """Tell whether it presses on both sides of the same place, as teeth without backlash do."""
    return load.kind.endswith("gear_play") and load.number("lower") == load.number("upper")


def normal_forces(model: Mechanism) -> list[str]:
    """Sources of pressure in the friction of joints: equations of the joint, or a preload alone."""
    rubbing = [load for load in model.loads if "friction" in load.kind]
    read = {load.name: load.pressed_by.name for load in rubbing if load.pressed_by is not None}
    preloaded = [load.name for load in rubbing if load.name not in read]
    found = [f"{', '.join(read)}: read from equations of {', '.join(dict.fromkeys(read.values()))}"
             ] if read else []
    return [*found, *([f"{', '.join(preloaded)}: the preload alone"] if preloaded else [])]
