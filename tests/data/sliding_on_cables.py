"""Places of two points that slide along flexible beams, by cable elements of Exudyn.

    python tests/data/sliding_on_cables.py      (needs exudyn; two minutes)

Prints what `tests/model/test_path_numbers.py` compares with: the way and places at 0.8 s of a
pendulum on a slider that slides along an arm, and of a telescopic boom. Absolute nodal coordinates,
nothing of which the package has.
"""

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    Cable2D,
    CoordinateConstraint,
    DistanceConstraint,
    Force,
    GenericJoint,
    Gravity,
    MarkerBodyCable2DCoordinates,
    MarkerBodyMass,
    MarkerBodyPosition,
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    MassPoint2D,
    NodeGenericData,
    NodePointGround,
    ObjectGround,
    ObjectJointSliding2D,
    Point2D,
    Point2DS1,
    Rigid2D,
    RigidBody2D,
    SensorNode,
    SensorObject,
    SpringDamper,
)

LENGTH, WIDTH, E, DENSITY, END = 2.0, 0.04, 7e10, 2700.0, 0.8
COORDINATE, PLACE = exu.OutputVariableType.SlidingCoordinate, exu.OutputVariableType.Position


class Beams:
    """A system with beams of cables along x, the first of which is turned by a hub at its end."""

    def __init__(self, height, elements, angle, rate):
        self.container = exu.SystemContainer()
        self.system = self.container.AddSystem()
        self.height, self.elements, self.step = height, elements, LENGTH / elements
        self.ground = self._marker(MarkerNodeCoordinate, nodeNumber=self.system.AddNode(
            NodePointGround()), coordinate=0)
        self.nodes, self.cables = [], []
        self.beam(0.0)
        hub = self.system.AddNode(Rigid2D(referenceCoordinates=[0, 0, 0]))
        body = self.system.AddObject(RigidBody2D(mass=1, inertia=1, nodeNumber=hub))
        for coordinate in (0, 1):
            for node in (hub, self.nodes[0][0]):
                self._hold(node, coordinate)
        self._hold(hub, 2, offset=1e-12, offsetUserFunction=lambda system, t, i, o: angle(t),
                   offsetUserFunction_t=lambda system, t, i, o: rate(t))
        ends = [self._marker(MarkerBodyRigid, bodyNumber=one, localPosition=[0, 0, 0])
                for one in (body, self.cables[0][0])]
        self.system.AddObject(GenericJoint(markerNumbers=ends,
                                           constrainedAxes=[0, 0, 0, 0, 0, 1]))

    def _marker(self, kind, **options):
        return self.system.AddMarker(kind(**options))

    def _hold(self, node, coordinate, **options):
        marker = self._marker(MarkerNodeCoordinate, nodeNumber=node, coordinate=coordinate)
        self.system.AddObject(CoordinateConstraint(markerNumbers=[self.ground, marker], **options))

    def beam(self, x):
        """A beam that begins at a place."""
        area, bend = WIDTH * self.height, WIDTH * self.height**3 / 12
        nodes = [self.system.AddNode(Point2DS1(referenceCoordinates=[x + k * self.step, 0, 1, 0]))
                 for k in range(self.elements + 1)]
        self.nodes.append(nodes)
        self.cables.append([self.system.AddObject(Cable2D(
            length=self.step, massPerLength=DENSITY * area, bendingStiffness=E * bend,
            axialStiffness=E * area, nodeNumbers=[nodes[k], nodes[k + 1]],
            useReducedOrderIntegration=True)) for k in range(self.elements)])

    def point(self, body, at=(0, 0, 0)):
        """A marker at a place of a body."""
        return self._marker(MarkerBodyPosition, bodyNumber=body, localPosition=list(at))

    def slide(self, point, beam, start):
        """A marker slides along a beam; a sensor of its way."""
        markers = [self._marker(MarkerBodyCable2DCoordinates, bodyNumber=one)
                   for one in self.cables[beam]]
        first = min(int(start / self.step + 1e-9), self.elements - 1)
        data = self.system.AddNode(NodeGenericData(initialCoordinates=[first, start],
                                                   numberOfDataCoordinates=2))
        joint = self.system.AddObject(ObjectJointSliding2D(
            markerNumbers=[point, markers[first]], slidingMarkerNumbers=markers,
            slidingMarkerOffsets=[k * self.step for k in range(self.elements)], nodeNumber=data))
        return self.system.AddSensor(SensorObject(objectNumber=joint, storeInternal=True,
                                                  outputVariableType=COORDINATE))

    def place(self, node):
        """A sensor of the place of a node."""
        return self.system.AddSensor(SensorNode(nodeNumber=node, storeInternal=True,
                                                outputVariableType=PLACE))

    def last(self, h, sensors):
        """What sensors have at the end."""
        self.system.Assemble()
        settings = exu.SimulationSettings()
        settings.timeIntegration.numberOfSteps = round(END / h)
        settings.timeIntegration.endTime = END
        settings.timeIntegration.newton.useModifiedNewton = True
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
        settings.timeIntegration.verboseMode = 0
        settings.solution.sensors.writePeriod = 0.05
        settings.solution.file.write = False
        self.system.SolveDynamic(settings)
        return [self.system.GetSensorStoredData(one)[-1, 1:3] for one in sensors]


def arm(elements, h):
    """Ways and places of the tip and the bob of the arm with a pendulum."""
    g, slider, hung, rod, start = 9.81, 0.3, 0.5, 0.4, 0.3
    made = Beams(0.01, elements, lambda t: -(10 * t**3 - 15 * t**4 + 6 * t**5),
                 lambda t: -(30 * t**2 - 60 * t**3 + 30 * t**4))
    for one in made.cables[0]:
        made.system.AddLoad(Gravity(markerNumber=made._marker(MarkerBodyMass, bodyNumber=one),
                                    loadVector=[0, -g, 0]))
    points, nodes = [], []
    for mass, y in ((slider, 0.0), (hung, -rod)):
        nodes.append(made.system.AddNode(Point2D(referenceCoordinates=[start, y])))
        points.append(made.point(made.system.AddObject(
            MassPoint2D(mass=mass, nodeNumber=nodes[-1]))))
        made.system.AddLoad(Force(markerNumber=points[-1], loadVector=[0, -g * mass, 0]))
    made.system.AddObject(DistanceConstraint(markerNumbers=points, distance=rod))
    return made.last(h, [made.slide(points[0], 0, start), made.place(made.nodes[0][-1]),
                         made.place(nodes[1])])


def boom(elements, h):
    """Both ways and the place of the inner tip of the telescopic boom."""
    over = 1.0
    made = Beams(0.02, elements, lambda t: 2.0 * (t - np.sin(np.pi * t) / np.pi),
                 lambda t: 2.0 * (1.0 - np.cos(np.pi * t)))
    made.beam(LENGTH - over)
    root = made.point(made.cables[1][0])
    tip = made.point(made.cables[0][-1], (made.step, 0, 0))
    ground = made.point(made.system.AddObject(ObjectGround()))
    made.system.AddObject(SpringDamper(markerNumbers=[ground, root], stiffness=150.0, damping=0,
                                       referenceLength=LENGTH - over))
    return made.last(h, [made.slide(root, 0, LENGTH - over), made.slide(tip, 1, over),
                         made.place(made.nodes[1][-1])])


if __name__ == "__main__":
    for make, elements, h in ((arm, 16, 5e-4), (boom, 8, 1e-3)):
        print(make.__name__, elements, h, *make(elements, h))
