"""Exudyn models of rigid mechanisms and of the slider-crank. Import only where it is installed."""

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    CoordinateConstraint,
    LoadMassProportional,
    MarkerBodyMass,
    MarkerBodyPosition,
    MarkerNodeCoordinate,
    MarkerNodePosition,
    NodePointGround,
    NodeRigidBody2D,
    ObjectBeamGeometricallyExact2D,
    ObjectGround,
    ObjectRigidBody2D,
    RevoluteJoint2D,
)
from exudyn.rigidBodyUtilities import RigidBodyInertia

from sebody.scenes import heavy_top as top, slider_crank as crank
from sebody.scenes.four_bar import GRAVITY, INERTIA
from sebody.verify.bench.peer_models import SHEAR, Run, new_system, solve


def four_bar(h: float, loops: int) -> Run:
    """Rockers and couplers as rigid bodies in a plane, on revolute joints."""
    system, mbs = new_system()
    ground = mbs.AddObject(ObjectGround())

    def rod(place, angle, velocity, rate):
        node = mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[*place, angle],
                                           initialVelocities=[*velocity, rate]))
        body = mbs.AddObject(ObjectRigidBody2D(mass=1.0, inertia=INERTIA, nodeNumber=node))
        marker = mbs.AddMarker(MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(LoadMassProportional(markerNumber=marker, loadVector=[*GRAVITY, 0.0]))
        return body

    def join(first, at_first, second, at_second):
        mbs.AddObject(RevoluteJoint2D(markerNumbers=[_place(mbs, first, at_first),
                                                     _place(mbs, second, at_second)]))
    rockers = [rod((k, 0.5), np.pi / 2, (0.5, 0.0), -1.0) for k in range(loops + 1)]
    for k, rocker in enumerate(rockers):
        join(ground, (k, 0.0), rocker, (-0.5, 0.0))
    for k in range(loops):
        coupler = rod((k + 0.5, 1.0), 0.0, (1.0, 0.0), 0.0)
        join(rockers[k], (0.5, 0.0), coupler, (-0.5, 0.0))
        join(coupler, (0.5, 0.0), rockers[k + 1], (0.5, 0.0))
    return solve(system, mbs, _place(mbs, rockers[0], (0.5, 0.0)), h, 10.0, modified=False)


def _place(mbs, body, point):
    return mbs.AddMarker(MarkerBodyPosition(bodyNumber=body, localPosition=[*point, 0.0]))


def heavy_top(h: float) -> Run:
    """The top with Euler parameters on a joint with three equations."""
    system, mbs = new_system()
    inertia = RigidBodyInertia(mass=15.0, inertiaTensor=np.diag(top.INERTIA))
    body = mbs.CreateRigidBody(
        inertia=inertia, referencePosition=[0, 1, 0], gravity=[0, 0, -9.81],
        initialVelocity=np.cross(top.SPIN, (0.0, 1.0, 0.0)).tolist(),
        initialAngularVelocity=list(top.SPIN), nodeType=exu.NodeType.RotationEulerParameters)
    mbs.CreateGenericJoint(itemNumbers=[body, mbs.CreateGround()], position=[0, 0, 0],
                           constrainedAxes=[1, 1, 1, 0, 0, 0], useGlobalFrame=True)
    return solve(system, mbs, _place(mbs, body, (0.0, 0.0)), h, 2.0, modified=False)


def slider_crank(h: float) -> Run:
    """The rod as four geometrically exact beams; the crank turns by a constraint on its rate."""
    system, mbs = new_system()
    s, elements = crank.SECTION, 4
    ground = mbs.AddObject(ObjectGround())
    fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()),
                                               coordinate=0))
    wheel = mbs.AddNode(NodeRigidBody2D(initialVelocities=[0.0, 0.0, crank.SPEED]))
    body = mbs.AddObject(ObjectRigidBody2D(mass=1.0, inertia=1.0, nodeNumber=wheel))
    mbs.AddObject(RevoluteJoint2D(markerNumbers=[_place(mbs, ground, (0.0, 0.0)),
                                                 _place(mbs, body, (0.0, 0.0))]))
    mbs.AddObject(CoordinateConstraint(
        markerNumbers=[fixed, mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=wheel, coordinate=2))],
        offset=crank.SPEED, velocityLevel=True))
    turn, speed = -crank.SPEED * crank.RADIUS / crank.LENGTH, crank.RADIUS * crank.SPEED
    along = np.linspace(0.0, crank.LENGTH, elements + 1)
    nodes = [mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[crank.RADIUS + x, 0.0, 0.0],
                                         initialVelocities=[0.0, speed + turn * x, turn]))
             for x in along]
    shear = SHEAR * s.youngs_modulus / (2 + 2 * s.poisson_ratio) * s.area
    for pair in zip(nodes[:-1], nodes[1:], strict=True):
        mbs.AddObject(ObjectBeamGeometricallyExact2D(
            nodeNumbers=list(pair), length=crank.LENGTH / elements,
            physicsMassPerLength=s.density * s.area, physicsCrossSectionInertia=s.density
            * s.inertia_z, physicsBendingStiffness=s.youngs_modulus * s.inertia_z,
            physicsAxialStiffness=s.youngs_modulus * s.area, physicsShearStiffness=shear))
    mbs.AddObject(ObjectRigidBody2D(mass=crank.SLIDER, inertia=0.0, nodeNumber=nodes[-1]))
    mbs.AddObject(RevoluteJoint2D(markerNumbers=[
        _place(mbs, body, (crank.RADIUS, 0.0)),
        mbs.AddMarker(MarkerNodePosition(nodeNumber=nodes[0]))]))
    mbs.AddObject(CoordinateConstraint(markerNumbers=[fixed, mbs.AddMarker(
        MarkerNodeCoordinate(nodeNumber=nodes[-1], coordinate=1))]))
    tip = mbs.AddMarker(MarkerNodePosition(nodeNumber=nodes[-1]))
    return solve(system, mbs, tip, h, crank.build().t_end, modified=False)
