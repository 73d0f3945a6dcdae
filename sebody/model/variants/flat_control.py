"""Sensors and controllers of a spatial model in a plane of symmetry.

A controller is the same, since a sensor in the plane gives the number that the one in space does:
a component along a global axis is, but for its sign, one along an axis of the plane; an angle
counts about the normal.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sebody.basics.errors import InputError
from sebody.model.continuous import law_element
from sebody.model.control_order import actuators, signals
from sebody.model.control_parts import Sensor
from sebody.model.mechanism import Mechanism
from sebody.model.parts import SLIDES, TURNS
from sebody.model.plane import AXIAL, POINTS, VECTORS, Plane
from sebody.reduction.plane import PlanarBody

AXES = "xyz"
ALONG = 1e-9            # of a unit vector: what is left of it along other axes by rounding


class Reading(NamedTuple):
    """A quantity of the planar model, what it is multiplied with, and what is added."""

    quantity: str
    gain: float = 1.0
    added: float = 0.0


def add_control(model: Mechanism, made: Mechanism, bodies: Mapping[str, PlanarBody]) -> None:
    """Give a planar model the sensors and controllers of the spatial one.

    Raises
    ------
    InputError
        A sensor whose quantity is not one in the plane.
    """
    made.sensors = {name: _flat_sensor(model, made, bodies, one)
                    for name, one in model.sensors.items()}
    known = {*model.sensors, *signals(model), *actuators(model)}
    for controller in model.controllers.values():
        for name in controller.inputs:
            if name not in known and name not in made.sensors:
                made.sensors[name] = _flat_sensor(model, made, bodies,
                                                  Sensor(name, name, 0.0, 0, 0.0, 0.0, 0))
    for name, controller in model.controllers.items():
        made.controllers[name] = controller
        if not controller.period:
            old = next(one for one in model.loads
                       if one.law is not None and one.law.controller == name)
            assert old.law is not None and old.time_function is not None
            made.loads.append(law_element(made, controller, old.law.derivatives,
                                          old.time_function.corners))


def _flat_sensor(model: Mechanism, made: Mechanism, bodies: Mapping[str, PlanarBody],
                 sensor: Sensor) -> Sensor:
    reading = _reading(model, made, bodies, sensor.quantity)
    if reading is None:
        raise InputError(f"sensor {sensor.name!r} measures {sensor.quantity!r}, which is no "
                         "quantity of the planar model, or not one of its numbers: measure an "
                         "angle, a motion in the plane along a global axis that lies in it, or "
                         "build the planar model by hand")
    return replace(sensor, quantity=reading.quantity, gain=reading.gain,
                   bias=sensor.bias + reading.added)


def _reading(model: Mechanism, made: Mechanism, bodies: Mapping[str, PlanarBody], quantity: str
             ) -> Reading | None:
    """A quantity of one number in the planar model; None if there is none."""
    owner, _, last = quantity.rpartition(".")
    joints = [one for one in model.joints if one.name == owner]
    if joints and last in ("angle", "rate") and joints[0].kind in TURNS:
        along = float(_plane(made).normal @ joints[0].axis)
        return Reading(quantity, np.sign(along)) if abs(along) > 1.0 - ALONG else None
    if joints and last in ("displacement", "speed") and joints[0].kind in SLIDES:
        return Reading(quantity) if abs(_plane(made).normal @ joints[0].axis) < ALONG else None
    before, _, name = owner.rpartition(".")
    if before in bodies and name in ("modes", "mode_rates") and last.isdecimal():
        parts = bodies[before].modes[int(last)]
        components = np.flatnonzero(np.abs(parts) > ALONG)
        if len(components) != 1:
            return None
        k = components[0]
        return Reading(f"{before}.{name}.{k}", parts[k])
    if last in AXES and name in (*POINTS, *VECTORS, *AXIAL):
        return _component(made, before, name, np.eye(3)[AXES.index(last)])
    return None


def _plane(made: Mechanism) -> Plane:
    """The plane that a planar model was made for."""
    assert made.plane is not None
    return made.plane


def _component(made: Mechanism, owner: str, name: str, way: np.ndarray) -> Reading | None:
    """A component of a vector along a global axis."""
    plane = _plane(made)
    parts = plane.axes.T @ way
    components = np.flatnonzero(np.abs(parts) > ALONG)
    axial = name in AXIAL
    if len(components) > 1 or (components[0] == 2) != axial:
        return None
    if axial:
        return Reading(f"{owner}.{name}", parts[2])
    added = float(plane.origin @ way) if name in POINTS else 0.0
    return Reading(f"{owner}.{name}.{AXES[components[0]]}", parts[components[0]], added)
