"""Sensors of a model."""

from __future__ import annotations

from sebody.basics import inputs as given
from sebody.basics.errors import InputError
from sebody.model.arguments import dof_block, known, refuse_taken
from sebody.model.control_parts import MOST_DELAY, Sensor
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Node


def sensor(model: Mechanism, name: str, quantity: str, rate: float | None = None, delay: int = 0,
           bias: float = 0.0, noise: float = 0.0, seed: int = 0, axes: Node | str | None = None
           ) -> Sensor:
    """Measure a quantity, one number, for controllers.

    Parameters
    ----------
    name : str
        Its name among controllers' inputs; results have what it gave as ``<name>.value``.
    quantity : str
        A quantity of a result, or a component: ``"tip.position.y"``, ``"hinge.angle"``,
        ``"beam.modes.0"``, ``"hinge.local_force.x"``. Motion of nodes, modes and angles of joints
        is read in compiled code; for anything else the run returns to Python at every sample,
        which takes about a millisecond.
    rate : float, optional
        Samples for each unit of time, between which the value holds; by default it is read
        whenever a controller that has it among its inputs is called.
    delay : int
        Samples by which the value is late; needs a rate.
    bias : float
        Added to the quantity, in its unit.
    noise : float
        Standard deviation of normal noise in that unit, independent from sample to sample.
    seed : int
        Of the noise: the same seed gives the same numbers.
    axes : Node or str, optional
        A node with whose axes a vector turns, of which the quantity is a component: those of space
        at the start. By default vectors are in global axes.

    Raises
    ------
    InputError
        A name that is taken, or numbers that make no sense. Whether there is such a quantity is
        found when a run begins.
    """
    where = f"sensor {given.name(name, 'name of a sensor')!r}"
    check_new(model, name, where)
    given.name(quantity, f"{where}: quantity")
    period = 0.0 if rate is None else 1.0 / given.number(rate, f"{where}: rate", above=0.0)
    delay = given.integer(delay, f"{where}: delay", least=0, most=MOST_DELAY)
    if delay and not period:
        raise InputError(f"{where} has a delay of {delay} samples and no rate: give rate=, or the "
                         "delay to the controller")
    made = Sensor(name, quantity, period, delay, given.number(bias, f"{where}: bias"),
                  given.number(noise, f"{where}: noise", least=0.0),
                  given.integer(seed, f"{where}: seed", least=0, most=2**62),
                  _axes(model, where, quantity, axes))
    model.sensors[name] = made
    return made


def _axes(model: Mechanism, where: str, quantity: str, axes: Node | str | None) -> str:
    """Name of the node in whose axes a component is measured."""
    if axes is None:
        return ""
    node = known(model, axes)
    dof_block(node, "rotation")
    if quantity.rpartition(".")[2] not in "xyz"[:model.dimension] or "." not in quantity:
        raise InputError(f"{where} has axes and measures {quantity!r}: name a component of a "
                         "vector, such as 'tip.acceleration.x'")
    return node.name


def check_new(model: Mechanism, name: str, where: str) -> None:
    """Refuse a name that something else of the model has."""
    refuse_taken(model, name, where)
