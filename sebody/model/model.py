"""What a user builds: nodes made of triplets, superelements on them, joints and loads.

A node is a position triplet and a rotation triplet, two separate blocks of unknowns. Bodies that
share a position triplet have a spherical joint between them without a multiplier, and a fixed
triplet has no unknowns.
"""

from sebody.model import beams, bodies, drives, joints, loads, nodes, springs
from sebody.model.mechanism import Mechanism


class Model(Mechanism):
    """A mechanism: nodes, superelements, rigid bodies, joints and forces.

    Joints, loads, springs and drives take ``name=``, by which `element` and results find them.

    Parameters
    ----------
    planar : bool
        Motion in the x-y plane: positions (x, y) and one angle a node.
    """

    node = nodes.node
    attach = nodes.attach
    initial_velocity = nodes.initial_velocity
    rigid_velocity = nodes.rigid_velocity

    superelement = bodies.superelement
    rigid_body = bodies.rigid_body
    point_mass = bodies.point_mass
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

    drive_angle = drives.drive_angle
    drive_slide = drives.drive_slide
    move = drives.move

    force = loads.force
    torque = loads.torque
    mode_force = loads.mode_force
    user_force = loads.user_force
    gravity = loads.gravity

    spring = springs.spring
    torsion_spring = springs.torsion_spring
    bushing = springs.bushing
