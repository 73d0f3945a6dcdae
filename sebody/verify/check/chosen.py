"""Kernels by the names that users know: of files, of elements as listed, of joints."""

from collections.abc import Iterable
from inspect import signature

from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.contract.names import ELEMENT
from sebody.model import joints
from sebody.model.model import Model

# the axes that a joint is made with, by names that hold in space and in a plane
JOINTS: dict[str, tuple[str, ...]] = {
    "revolute": ("z",), "universal": ("x", "y"), "cylindrical": ("x",), "prismatic": ("x",),
    "slider": ("x",), "planar_joint": ("x",), "spherical": (), "weld": (), "distance": ()}


def chosen_kernels(names: Iterable[str], known: Iterable[str]) -> list[str]:
    """Kernels by name: that of a file, of an element as `sebody list` prints it, or of a joint.

    Parameters
    ----------
    names : iterable of str
    known : iterable of str
        Names of the files there are.

    Raises
    ------
    InputError
        A name that nothing has.
    """
    known, chosen = list(known), []
    for name in names:
        own = [one for one in (name, ELEMENT + name, *_of_joint(name)) if one in known]
        if not own:
            elements = [one.removeprefix(ELEMENT) for one in known if one.startswith(ELEMENT)]
            raise unknown("kernel", name, [*JOINTS, *elements, *known])
        chosen += own
    return list(dict.fromkeys(chosen))


def _of_joint(name: str) -> list[str]:
    """Kernels of a joint's equations: in space and planar, to the ground and to a node."""
    if name not in JOINTS:
        return []
    build, kinds = getattr(joints, name), {}
    options = [{}, {"explicit": True}] if "explicit" in signature(build).parameters else [{}]
    for planar in (False, True):
        for given in options:
            for to in (None, "b"):
                model = Model(planar=planar)
                n = model.dimension
                model.node("a", (0.0,) * n)
                model.node("b", (float(name == "distance"),) + (0.0,) * (n - 1))
                try:
                    made = build(model, "a", *JOINTS[name], to=to, **given)
                except InputError:      # there is none in a plane, or none to the ground
                    continue
                kinds |= dict.fromkeys(one.kind for one in made.constraints)
    return [ELEMENT + kind for kind in kinds]
