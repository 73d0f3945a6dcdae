"""Stick and slip on a belt beside Exudyn: error of period and amplitude against time.

    python tests/benchmarks/bench_friction_peer.py [--json FILE]

A block of 1 on a spring of 100 rides on a belt at 0.1, breaks away at 4 and slides at 3: period
0.67123890 and amplitude 0.01414214 in closed form. Exudyn's example of this kind is its connector
`CoordinateSpringDamperExt` with sticking stiffness; its excess of static friction decays with the
speed of sliding (`exponentialDecayStatic`), here within a ten thousandth of the belt's.
Both run 5 s with the fixed step given; times are those of the solvers, best of three.
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody import Model, Simulation

PERIOD, AMPLITUDE, T_END, SPEED = 0.67123890, 0.01414214, 5.0, 0.1
STICKING, DECAY = 1e5, 1e-5        # the best of 1e4 to 1e6, and of 1e-5 to 1e-3


def ours(h: float) -> tuple[NDArray, float]:
    """Places of the block, and seconds."""
    model = Model(planar=True)
    model.rigid_body("body", model.node("block", (0.0, 0.0)), 1.0, 0.1)
    model.initial_velocity("block", (SPEED, 0.0))
    model.fix(model.node("wall", (-1.0, 0.0), keeps="translation"), "position")
    model.spring("wall", "block", 100.0, length=1.0)
    model.node("belt", (0.0, 0.0))
    model.move("belt", (1.0, 0.0), lambda t: SPEED * t)
    model.fix("belt", "rotation")
    model.prismatic("belt", (1.0, 0.0), to="block", name="slide")
    model.friction("slide", 3.0, static=4.0, preload=1.0, reaction=False)
    run = Simulation(model, h).run_to(T_END)
    return run.result()["block.position"][:, 0], run.seconds


def exudyns(h: float) -> tuple[NDArray, float]:
    """The same by Exudyn."""
    import exudyn
    from exudyn import itemInterface as items
    system = exudyn.SystemContainer()
    mbs = system.AddSystem()
    block, belt = (mbs.AddNode(items.Node1D(referenceCoordinates=[0.0], initialCoordinates=[0.0],
                                            initialVelocities=[SPEED])) for _ in range(2))
    mbs.AddObject(items.Mass1D(nodeNumber=block, physicsMass=1.0))
    mbs.AddObject(items.Mass1D(nodeNumber=belt, physicsMass=1e9))      # nothing brakes it
    ground, block_at, belt_at = (
        mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=one, coordinate=0))
        for one in (mbs.AddNode(items.NodePointGround()), block, belt))
    data = mbs.AddNode(items.NodeGenericData(initialCoordinates=[1.0, 0.0, 0.0],
                                             numberOfDataCoordinates=3))
    mbs.AddObject(items.CoordinateSpringDamper(markerNumbers=[ground, block_at],
                                               stiffness=100.0))
    mbs.AddObject(items.ObjectConnectorCoordinateSpringDamperExt(
        markerNumbers=[belt_at, block_at], nodeNumber=data, stickingStiffness=STICKING,
        stickingDamping=1.4 * np.sqrt(STICKING), dynamicFrictionForce=3.0,
        staticFrictionOffsetForce=1.0,
        exponentialDecayStatic=DECAY))
    sensor = mbs.AddSensor(items.SensorNode(
        nodeNumber=block, storeInternal=True,
        outputVariableType=exudyn.OutputVariableType.Coordinates))
    mbs.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(T_END / h)
    settings.timeIntegration.endTime = T_END
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = h
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    began = time.perf_counter()
    mbs.SolveDynamic(settings)
    seconds = time.perf_counter() - began
    return mbs.GetSensorStoredData(sensor)[:, 1], seconds


def measured(x: NDArray, h: float) -> dict[str, float]:
    """Period and amplitude of the last cycles, less the exact ones."""
    up = np.flatnonzero((x[:-1] < 0.03) & (x[1:] >= 0.03))
    times = h * (up + (0.03 - x[up]) / (x[up + 1] - x[up]))
    late = x[len(x) // 2:]
    return {"period error": float(np.diff(times)[-1] - PERIOD),
            "amplitude error": float(np.ptp(late) / 2 - AMPLITUDE)}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    given, found = parser.parse_args(), []
    for h in (1e-2, 1e-3, 1e-4):
        for name, solve in (("sebody", ours), ("Exudyn", exudyns)):
            runs = [solve(h) for _ in range(3)]
            found.append({"program": name, "h": h, "seconds": min(s for _, s in runs),
                          **measured(runs[0][0], h)})
            print("  ".join(f"{key} {value:.3g}" if isinstance(value, float) else value
                            for key, value in found[-1].items()))
    if given.json:
        given.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
