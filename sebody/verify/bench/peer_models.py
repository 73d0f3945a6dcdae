"""Exudyn models of the bench scenes. Import only where Exudyn is installed."""

import contextlib
import io
import time
from typing import NamedTuple

import exudyn as exu
import numpy as np
from exudyn import symbolic as esym
from exudyn.advancedUtilities import CreateSymbolicUserFunction
from exudyn.FEM import FEMinterface, HCBstaticModeSelection, ObjectFFRFreducedOrderInterface
from exudyn.itemInterface import (
    CoordinateConstraint,
    GenericJoint,
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    MarkerNodeRigid,
    MarkerSuperElementRigid,
    NodePointGround,
    NodeRigidBody2D,
    NodeRigidBodyRotVecLG,
    ObjectBeamGeometricallyExact,
    ObjectBeamGeometricallyExact2D,
    ObjectGround,
    SensorMarker,
)
from scipy.sparse import csr_matrix

from sebody.fem.hexahedron import hexahedral_block
from sebody.scenes.chain import GRAVITY, SECTION as LINK
from sebody.scenes.hinged_beam import SECTION, TORQUE
from sebody.scenes.spherical_beam import LENGTH, PUSH, TORQUE as SPHERICAL_TORQUE

T_END = 30.0
SHEAR = 5.0 / 6.0


class Run(NamedTuple):
    """Results of a run of the peer."""

    unknowns: int
    steps: int
    seconds: float
    iterations: float | None
    tip: np.ndarray         # (n, 4) time and position
    processor_seconds: float


def reduced_beam(h: float, modes: int = 4, t_end: float = T_END) -> Run:
    """The hinged beam as one reduced body: block of hexahedra, rigid ends, inner modes."""
    system, mbs = new_system()
    base, tip = _reduced_body(mbs, np.sqrt(2.0) * 100.0, SECTION, modes, (0.0, 0.0, 0.0))
    ground = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
    mbs.AddObject(GenericJoint(markerNumbers=[ground, base], constrainedAxes=[1, 1, 1, 1, 1, 0]))
    _load(mbs, base, "torque", (0, 0, 1), TORQUE)
    return _rotated(solve(system, mbs, tip, h, t_end), np.pi / 4)


def spherical_beam(h: float, elements: int) -> Run:
    """The beam on a spherical joint as geometrically exact beam elements."""
    system, mbs = new_system()
    base, tip = _exact_beams(mbs, LENGTH, elements, [1, 1, 1, 0, 0, 0])
    _load(mbs, base, "torque", (0, 0, 1), SPHERICAL_TORQUE)
    _load(mbs, tip, "force", (0, 0, 1), PUSH)
    return solve(system, mbs, tip, h, T_END, modified=False)


def reduced_spherical_beam(h: float) -> Run:
    """The same as one reduced body with eight inner modes."""
    system, mbs = new_system()
    base, tip = _reduced_body(mbs, LENGTH, SECTION, 8, (0.0, 0.0, 0.0))
    ground = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
    mbs.AddObject(GenericJoint(markerNumbers=[ground, base], constrainedAxes=[1, 1, 1, 0, 0, 0]))
    _load(mbs, base, "torque", (0, 0, 1), SPHERICAL_TORQUE)
    _load(mbs, tip, "force", (0, 0, 1), PUSH)
    return solve(system, mbs, tip, h, T_END)


def planar_beams(h: float, elements: int) -> Run:
    """The hinged beam as geometrically exact beam elements in the plane."""
    system, mbs = new_system()
    length = np.sqrt(2.0) * 100.0
    nodes = [mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[length * k / elements, 0.0, 0.0]))
             for k in range(elements + 1)]
    shear = SECTION.youngs_modulus / (2 + 2 * SECTION.poisson_ratio) * SECTION.area * SHEAR
    for first, second in zip(nodes[:-1], nodes[1:], strict=True):
        mbs.AddObject(ObjectBeamGeometricallyExact2D(
            nodeNumbers=[first, second], length=length / elements,
            massPerLength=SECTION.density * SECTION.area,
            crossSectionInertia=SECTION.density * SECTION.inertia_z,
            bendingStiffness=SECTION.youngs_modulus * SECTION.inertia_z,
            axialStiffness=SECTION.youngs_modulus * SECTION.area, shearStiffness=shear))
    ground = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()),
                                                coordinate=0))
    for k in range(2):
        held = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=k))
        mbs.AddObject(CoordinateConstraint(markerNumbers=[ground, held]))
    base, tip = (mbs.AddMarker(MarkerNodeRigid(nodeNumber=node)) for node in (nodes[0], nodes[-1]))
    _load(mbs, base, "torque", (0, 0, 1), TORQUE)
    return _rotated(solve(system, mbs, tip, h, T_END, modified=False), np.pi / 4)


def spatial_beams(h: float, elements: int, t_end: float = T_END) -> Run:
    """The hinged beam as geometrically exact beam elements in space."""
    system, mbs = new_system()
    base, tip = _exact_beams(mbs, np.sqrt(2.0) * 100.0, elements, [1, 1, 1, 1, 1, 0])
    _load(mbs, base, "torque", (0, 0, 1), TORQUE)
    return _rotated(solve(system, mbs, tip, h, t_end, modified=False), np.pi / 4)


def _exact_beams(mbs, length: float, elements: int, held: list[int]):
    """Beam elements along x, the first node held; markers of both ends."""
    rho, E, G = (SECTION.density, SECTION.youngs_modulus,
                 SECTION.youngs_modulus / (2 + 2 * SECTION.poisson_ratio))
    section = exu.BeamSection()
    section.massPerLength = rho * SECTION.area
    section.inertia = np.diag([rho * (SECTION.inertia_y + SECTION.inertia_z),
                               rho * SECTION.inertia_y, rho * SECTION.inertia_z])
    section.stiffnessMatrix = np.diag([
        E * SECTION.area, SHEAR * G * SECTION.area, SHEAR * G * SECTION.area,
        G * SECTION.torsion, E * SECTION.inertia_y, E * SECTION.inertia_z])
    nodes = [mbs.AddNode(NodeRigidBodyRotVecLG(
        referenceCoordinates=[length * k / elements, 0, 0, 0, 0, 0]))
        for k in range(elements + 1)]
    for first, second in zip(nodes[:-1], nodes[1:], strict=True):
        mbs.AddObject(ObjectBeamGeometricallyExact(
            nodeNumbers=[first, second], length=length / elements, sectionData=section))
    base, tip = (mbs.AddMarker(MarkerNodeRigid(nodeNumber=node)) for node in (nodes[0], nodes[-1]))
    ground = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
    mbs.AddObject(GenericJoint(markerNumbers=[ground, base], constrainedAxes=held))
    return base, tip


def chain(links: int, steps: int) -> Run:
    """The chain of reduced links on revolute joints."""
    system, mbs = new_system()
    last = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
    for k in range(links):
        base, tip = _reduced_body(mbs, 1.0, LINK, 4, (float(k), 0.0, 0.0), GRAVITY)
        mbs.AddObject(GenericJoint(markerNumbers=[last, base],
                                   constrainedAxes=[1, 1, 1, 1, 1, 0]))
        last = tip
    return solve(system, mbs, last, 0.01, 0.01 * steps)


def new_system():
    with contextlib.redirect_stdout(io.StringIO()):
        system = exu.SystemContainer()
        return system, system.AddSystem()


_REDUCED: dict[tuple, tuple] = {}


def _reduced_body(mbs, length, section, modes, place, gravity=(0.0, 0.0, 0.0)):
    """A beam of hexahedra reduced with rigid ends; returns the markers of its ends."""
    side = np.sqrt(section.area)
    key = (length, side, modes)
    if key not in _REDUCED:
        block = hexahedral_block((0, -side / 2, -side / 2), (length, side, side), (20, 1, 1),
                                 section.youngs_modulus, section.poisson_ratio, section.density)
        fem = FEMinterface()
        fem.nodes = {"Position": np.array(block.coordinates, dtype=float)}
        fem.massMatrix, fem.stiffnessMatrix = csr_matrix(block.mass), csr_matrix(block.stiffness)
        along = block.coordinates[:, 0]
        ends = [np.flatnonzero(np.abs(along - x) < 1e-9).tolist() for x in (0, length)]
        with contextlib.redirect_stdout(io.StringIO()):
            fem.ComputeHurtyCraigBamptonModes(boundaryNodesList=ends, nEigenModes=modes,
                                              useSparseSolver=False,
                                              computationMode=HCBstaticModeSelection.RBE2)
            _REDUCED[key] = ObjectFFRFreducedOrderInterface(fem), ends
    reduced, ends = _REDUCED[key]
    body = reduced.AddObjectFFRFreducedOrder(mbs, positionRef=list(place), gravity=list(gravity))
    return [mbs.AddMarker(MarkerSuperElementRigid(
        bodyNumber=body["oFFRFreducedOrder"], meshNodeNumbers=nodes,
        weightingFactors=[1.0 / len(nodes)] * len(nodes))) for nodes in ends]


def _load(mbs, marker, kind, direction, table) -> None:
    """A load with a history, compiled by Exudyn: no Python in the loop."""
    def vector(system, t, value):
        amplitude = _interpolated(t, table)
        return [amplitude * d for d in direction]
    item = (exu.itemInterface.LoadTorqueVector if kind == "torque"
            else exu.itemInterface.LoadForceVector)
    number = mbs.AddLoad(item(markerNumber=marker, loadVector=list(direction)))
    function = CreateSymbolicUserFunction(mbs, vector, "loadVectorUserFunction", number)
    mbs.SetLoadParameter(number, "loadVectorUserFunction", function)


def _interpolated(t, table):
    """A table as nested conditions of Exudyn's expressions."""
    value = esym.Real(table[-1][1])
    for (t0, v0), (t1, v1) in reversed(list(zip(table[:-1], table[1:], strict=True))):
        value = esym.IfThenElse(t <= t1, v0 + (t - t0) * ((v1 - v0) / (t1 - t0)), value)
    return esym.IfThenElse(t <= table[0][0], esym.Real(table[0][1]), value)


def solve(system, mbs, tip, h: float, t_end: float, modified: bool = True) -> Run:
    """Time the solver alone; the tip is stored every 0.1 s.

    Modified Newton is faster for the reduced bodies, the full one for the beams; a looser
    tolerance than 1e-5 changes the errors.
    """
    sensor = mbs.AddSensor(SensorMarker(markerNumber=tip, storeInternal=True,
                                        outputVariableType=exu.OutputVariableType.Position))
    with contextlib.redirect_stdout(io.StringIO()):
        mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(t_end / h)
    settings.timeIntegration.endTime = t_end
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.newton.useModifiedNewton = modified
    settings.timeIntegration.newton.relativeTolerance = 1e-5
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = max(0.1, h)
    coordinates = len(mbs.systemData.GetODE2Coordinates()) + mbs.systemData.AEsize()
    settings.linearSolverType = (exu.LinearSolverType.EigenSparse if coordinates > 60
                                 else exu.LinearSolverType.EigenDense)
    began, worked = time.perf_counter(), time.process_time()
    mbs.SolveDynamic(settings)
    seconds, worked = time.perf_counter() - began, time.process_time() - worked
    count = mbs.sys["dynamicSolver"].it.newtonStepsCount
    steps = round(t_end / h)
    path = np.array(mbs.GetSensorStoredData(sensor))
    return Run(coordinates, steps, seconds, count / steps, path, worked)


def _rotated(run: Run, angle: float) -> Run:
    """The run rotated about z, because these beams start along x."""
    tip, (c, s) = run.tip.copy(), (np.cos(angle), np.sin(angle))
    tip[:, 1], tip[:, 2] = (c * run.tip[:, 1] - s * run.tip[:, 2],
                            s * run.tip[:, 1] + c * run.tip[:, 2])
    return run._replace(tip=tip)
