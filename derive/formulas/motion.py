"""Motion of a body's floating frame, and of its local coordinates in it, twice derived in time.

The frame is a function of the state, so its rates are its variation in the direction of time, and
its second rates the differential of these. This holds for every frame, by what it declares alone.
"""

from functools import cache
from typing import NamedTuple

from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.form.steps import Solve, Stage, Step
from sebody.derive.formulas.damping import rates
from sebody.derive.formulas.frames.frame import Frame, FrameOption, origin_stage
from sebody.derive.formulas.kinematics import in_time, local_displacement, local_velocity
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import Rules, along

SECOND = {"eu": "eud", "ep": "epd", "em": "emd", "Om0": "Om0d"}     # rates of rates, by name


class Motion(NamedTuple):
    """Steps at node level, the same for every layout."""

    q: Quantities
    steps: tuple[Step, ...]


@cache
def motion(planar: bool, option: FrameOption) -> Motion:
    """Derive the steps in a frame: local coordinates, their rates and second rates."""
    q = Quantities(Space(planar))
    frame = option.derive(q)
    of_y = tuple(step for step in rates(q) if step.sets)
    first, second = turning(q, frame, Linearizer(q.space, time_rules(q), lambda quantity: rate_of(
        q, quantity)), of_y)
    return Motion(q, (
        origin_stage(q, q.x0, q.x), *frame.locate, local_displacement(q),
        Stage("internal modes", "mode", sets=((q.ym, q.qm.symbols),)), local_velocity(q),
        origin_stage(q, q.v0, q.vs), origin_stage(q, q.a0, q.acc), *first, *of_y, *second))


def turning(q: Quantities, frame: Frame, clock: Linearizer, of_y: tuple[Stage, ...]
            ) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """Steps of the rates of a frame; then of its second rates and those of local coordinates.

    Parameters
    ----------
    clock : Linearizer
        In the direction of time.
    of_y : tuple of Stage
        Rates of the local coordinates.
    """
    before = tuple(_in_time(q, stage) for stage in frame.differentials)
    steps = tuple(_in_time(q, step) for step in frame.variation)
    varied = {q.space.d(quantity).name: quantity for quantity in _varied(q, frame)}
    for stage in before:        # what the search computes beyond the frame moves as it says
        for rate, _ in (*stage.sets, *stage.adds):
            clock.rules |= along(varied[rate.name].symbols, rate.symbols)
    return (*before, *steps), tuple(clock.step(step) for step in (*steps, *of_y))


def _varied(q: Quantities, frame: Frame) -> list[Quantity]:
    """Quantities with a differential among those of a frame."""
    names = {target.name for stage in frame.differentials
             for target, _ in (*stage.sets, *stage.adds)}
    return [known for known in list(q.space.known.values()) if "d" + known.name in names]


def _in_time(q: Quantities, step: Stage | Solve) -> Stage | Solve:
    """A step of a variation in the direction of time."""
    rates_of = in_time(q)

    def target(quantity: Quantity) -> Quantity:
        return q.Om0 if quantity.name == q.dth0.name else quantity
    if isinstance(step, Solve):
        return step._replace(unknown=target(step.unknown), sums=tuple(
                                 part._replace(summand=part.summand.xreplace(rates_of))
                                 for part in step.sums),
                             constant=step.constant.xreplace(rates_of), invert=True)
    sets, adds = (tuple((target(quantity), value.xreplace(rates_of)) for quantity, value in group)
                  for group in (step.sets, step.adds))
    return step._replace(sets=sets, adds=adds)


def time_rules(q: Quantities) -> Rules:
    """Rates of what local coordinates and the rates of a frame are made of."""
    Om0 = q.Om0.symbols
    return (along(q.vs.symbols, q.acc.symbols + cross(q.vs.symbols, Om0))
            | along(q.v0.symbols, q.a0.symbols + cross(q.v0.symbols, Om0))
            | along(q.u.symbols, q.eu.symbols) | along(q.psi.symbols, q.ep.symbols)
            | along(q.Om.symbols, q.A.symbols) | along(q.vm.symbols, q.am.symbols))


def rate_of(q: Quantities, quantity: Quantity) -> Quantity:
    """The quantity that holds the rate of another one."""
    if quantity.name in SECOND:
        return getattr(q, SECOND[quantity.name])
    return q.space.d(quantity)
