"""A model as a user builds it: nodes made of DOF blocks, superelements on them, joints and loads.

A node is a position block and a rotation block, two separate blocks of unknowns. Bodies that
share a position DOF block have a spherical joint between them without a multiplier, and a fixed
DOF block has no unknowns.
"""

from html import escape
from typing import TYPE_CHECKING, NoReturn

from sebody.basics.spelling import alike
from sebody.model import (
    actuators,
    beams,
    bodies,
    bushings,
    contacts,
    controllers,
    couplings,
    drives,
    foundations,
    frictions,
    gears,
    gravity_fields,
    joints,
    loads,
    moving_loads,
    nodes,
    path_joints,
    paths,
    ropes,
    sensors,
    series,
    shafts,
    springs,
)
from sebody.model.atomic import atomic_builders
from sebody.model.mechanism import Mechanism
from sebody.model.summary import described, model_tables, summary

# names of other programs, and what does the same here
ELSEWHERE = {
    "hinge": "revolute", "pin": "revolute", "ball": "spherical", "ball_joint": "spherical",
    "fixed": "fix, or weld of two nodes", "ground": "fix", "clamp": "fix",
    "motor": "actuator, or drive_angle for a prescribed motion", "motion": "move or drive_angle",
    "damper": "spring with damping=", "mass": "point_mass or rigid_body",
    "body": "rigid_body or superelement", "add_body": "rigid_body or superelement",
    "flexible_body": "superelement or beam", "translational": "prismatic", "slide": "prismatic",
    "load": "force or torque", "moment": "torque", "pid": "controller",
    "marker": "node", "constraint": "weld, revolute and other joints",
    "run": "simulate(model, h, t_end), a function of the package",
    "simulate": "simulate(model, h, t_end), a function of the package"}


@atomic_builders
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

    if not TYPE_CHECKING:
        def __getattr__(self, name: str) -> NoReturn:
            """Say what does here what a method of this name does in other programs."""
            raise AttributeError(f"a Model has no {name!r}" + _instead(name))

    def summary(self) -> str:
        """The model in words and tables, to be checked before a run.

        Unknowns and what they are of, masses, bodies, nodes and their state, joints, loads; bodies
        that are not connected to the ground.
        """
        return described(self)

    def __repr__(self) -> str:
        return f"<{summary(self)}>"

    def _repr_html_(self) -> str:
        """HTML that notebooks show."""
        return f"<p>{escape(summary(self))}</p>" + "".join(
            f"<details><summary>{escape(title)}</summary>{rows}</details>"
            for title, rows in model_tables(self))

    node = nodes.node
    attach = nodes.attach
    initial_velocity = nodes.initial_velocity
    rigid_velocity = nodes.rigid_velocity

    superelement = bodies.superelement
    foundation = foundations.foundation
    rigid_body = bodies.rigid_body
    point_mass = bodies.point_mass
    unbalance = shafts.unbalance
    beam = beams.beam

    fix = joints.fix
    revolute = joints.revolute
    universal = joints.universal
    cylindrical = joints.cylindrical
    prismatic = joints.prismatic
    slider = joints.slider
    planar_joint = joints.planar_joint
    spherical = joints.spherical
    weld = joints.weld
    distance = joints.distance

    path = paths.path
    path_joint = path_joints.path_joint
    drive_way = path_joints.drive_way

    sheave = ropes.sheave
    rope = ropes.rope

    drive_angle = drives.drive_angle
    drive_slide = drives.drive_slide
    move = drives.move

    force = loads.force
    torque = loads.torque
    mode_force = loads.mode_force
    body_load = loads.body_load
    body_series = series.body_series
    beam_series = series.beam_series
    user_force = loads.user_force
    gravity = gravity_fields.gravity
    moving_force = moving_loads.moving_force

    actuator = actuators.actuator
    sensor = sensors.sensor
    controller = controllers.controller

    spring = springs.spring
    torsion_spring = springs.torsion_spring
    bushing = bushings.bushing

    friction = frictions.friction
    stop = contacts.stop
    gear = gears.gear
    couple = couplings.couple
    screw = couplings.screw
    rack = couplings.rack
    contact = contacts.contact


def _instead(name: str) -> str:
    """A hint at what to call in place of a name that a model does not have."""
    if name in ELSEWHERE:
        return f": that is {ELSEWHERE[name]}"
    near = [] if name.startswith("_") else alike(name, [own for own in dir(Model)
                                                        if not own.startswith("_")])
    return f": did you mean {' or '.join(near)}?" if near else ""
