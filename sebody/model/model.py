"""What a user builds: nodes made of DOF blocks, superelements on them, joints and loads.

A node is a position block and a rotation block, two separate blocks of unknowns. Bodies that
share a position DOF block have a spherical joint between them without a multiplier, and a fixed
DOF block has no unknowns.
"""

from html import escape

from sebody.model import (
    actuators,
    beams,
    bodies,
    contacts,
    controllers,
    drives,
    foundations,
    frictions,
    gears,
    joints,
    loads,
    nodes,
    sensors,
    series,
    springs,
)
from sebody.model.atomic import atomic
from sebody.model.mechanism import Mechanism
from sebody.model.summary import described, model_tables, summary


class Model(Mechanism):
    """A mechanism: nodes, superelements, rigid bodies, joints and forces.

    Joints, loads, springs and drives take ``name=``, by which `element` and results find them.

    Parameters
    ----------
    planar : bool
        Motion in the x-y plane: positions (x, y) and one angle a node.
    units : str
        Units of all numbers, such as ``mm t N s``, for legends, axes and tables; those of its
        bodies by default.
    """

    def summary(self) -> str:
        """The model in words and tables, to be checked before a run.

        Unknowns and what they are of, masses, bodies, nodes and their state, joints, loads; bodies
        that are not connected to the ground.
        """
        return described(self)

    def __repr__(self) -> str:
        return f"<{summary(self)}>"

    def _repr_html_(self) -> str:
        """What notebooks show."""
        return f"<p>{escape(summary(self))}</p>" + "".join(
            f"<details><summary>{escape(title)}</summary>{rows}</details>"
            for title, rows in model_tables(self))

    node = atomic(nodes.node)
    attach = atomic(nodes.attach)
    initial_velocity = atomic(nodes.initial_velocity)
    rigid_velocity = atomic(nodes.rigid_velocity)

    superelement = atomic(bodies.superelement)
    foundation = atomic(foundations.foundation)
    rigid_body = atomic(bodies.rigid_body)
    point_mass = atomic(bodies.point_mass)
    beam = atomic(beams.beam)

    fix = atomic(joints.fix)
    revolute = atomic(joints.revolute)
    universal = atomic(joints.universal)
    cylindrical = atomic(joints.cylindrical)
    prismatic = atomic(joints.prismatic)
    slider = atomic(joints.slider)
    planar_joint = atomic(joints.planar_joint)
    spherical = atomic(joints.spherical)
    weld = atomic(joints.weld)
    distance = atomic(joints.distance)

    drive_angle = atomic(drives.drive_angle)
    drive_slide = atomic(drives.drive_slide)
    move = atomic(drives.move)

    force = atomic(loads.force)
    torque = atomic(loads.torque)
    mode_force = atomic(loads.mode_force)
    body_load = atomic(loads.body_load)
    body_series = atomic(series.body_series)
    beam_series = atomic(series.beam_series)
    user_force = atomic(loads.user_force)
    gravity = atomic(loads.gravity)

    actuator = atomic(actuators.actuator)
    sensor = atomic(sensors.sensor)
    controller = atomic(controllers.controller)

    spring = atomic(springs.spring)
    torsion_spring = atomic(springs.torsion_spring)
    bushing = atomic(springs.bushing)

    friction = atomic(frictions.friction)
    stop = atomic(contacts.stop)
    gear = atomic(gears.gear)
    contact = atomic(contacts.contact)
