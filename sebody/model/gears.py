"""Pairs of gears on two revolute joints."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, known_joint
from sebody.model.frictions import turning
from sebody.model.impacts import impact_constants
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Joint, rotations


def gear(model: Mechanism, first: Joint | str, second: Joint | str, ratio: float,
         backlash: float = 0.0, stiffness: float | None = None, restitution: float = 0.5,
         at_speed: float = 1.0, exponent: float = 1.0, name: str | None = None,
         **acting: Unpack[Acting]) -> Element:
    """A pair of gears on two revolute joints: ``angle of first = ratio x angle of second``.

    The teeth are elastic: beyond half the backlash on either side the angle
    ``first - ratio second`` is pushed back by ``k d^n (1 + c d')``. Both angles are zero at the
    start.

    Parameters
    ----------
    first, second : Joint or str
        Revolute joints.
    ratio : float
        Turns of the first for one turn of the second; negative where they turn against each other.
    backlash : float
        Whole play, as an angle of the first [rad].
    stiffness : float, optional
        k of the teeth, moment on the first per angle^n of it. By default the stiffest that steps of
        the run's length follow.
    restitution, at_speed, exponent : float
        See `stop`.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Joints that are not revolute, a ratio of zero, or negative play.
    """
    joints = [known_joint(model, one, "gear") for one in (first, second)]
    what = f"gear of {joints[0].name!r} and {joints[1].name!r}"
    for one in joints:
        if one.kind != "revolute":
            raise InputError(f"{what}: {one.name!r} is a {one.kind}: give revolute joints")
    if joints[0] is joints[1]:
        raise InputError(f"{what}: give two joints")
    ratio = checked_ratio(what, ratio)
    play = inputs.number(backlash, f"{what}: backlash", least=0)
    tuned = {} if stiffness is not None else {"teeth": 1.0}
    constants = impact_constants(what, restitution, at_speed, 1.0 if tuned else stiffness, exponent)
    own: dict[str, float | NDArray] = {"ratio": ratio, "lower": -play / 2, "upper": play / 2}
    for k, one in enumerate(joints, 1):
        if not model.planar:
            own |= {f"{key}{k}": value for key, value in turning(one.own_axes).items()}
    attachments = tuple(p for one in joints for p in rotations(one.node, one.to))
    name = chosen_name(model, name, what.replace("'", ""))
    made = Element(name, model.kind_of("gear_play"), attachments, constants | own, tuned=tuned)
    model.loads.append(made)
    return made


def checked_ratio(what: str, ratio: float) -> float:
    """The ratio of a pair of gears.

    Raises
    ------
    InputError
        Zero, or no number.
    """
    ratio = inputs.number(ratio, f"{what}: ratio")
    if ratio == 0:
        raise InputError(f"{what}: ratio is 0: give the turns of the first for one of the second")
    return ratio
