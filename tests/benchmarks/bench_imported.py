"""An imported body with five interfaces and forty modes as coupler of a four-bar, beside Exudyn.

The FE matrices go through a file in Matrix Market to ``import_body``, and to Exudyn's own reduction
of the same matrices with the same five rigid sets of nodes and as many modes. Both linkages fall
from rest under oblique gravity, with the same step and spectral radius; Exudyn's last pin leaves
out the constraints that are redundant.
"""

import argparse
import contextlib
import io
import json
import tempfile
from pathlib import Path

import numpy as np

from sebody import Model, Simulation
from sebody.fem import hexahedral_block
from sebody.io import load_body, save_body
from sebody.reduction import RigidFace, reduce
from sebody.verify.bench import machine_rate

LENGTH, CRANK, ROCKER, GRAVITY, STEP = 1.0, 0.3, 0.6, (6.0, -8.0, 0.0), 5e-4
PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)
MODES, STEPS, PEER_STEPS, RUNS = 40, 2000, 200, 3


def fe_model():
    """A slender block of 20 x 2 x 2 hexahedra."""
    return hexahedral_block((0.0, -0.02, -0.01), (LENGTH, 0.04, 0.02), (20, 2, 2), 2.1e10, 0.3,
                            7850.0)


def sections(model) -> list[np.ndarray]:
    """The nodes of five sections, from one end to the other."""
    x = model.coordinates[:, 0]
    return [np.flatnonzero(np.isclose(x, place * LENGTH)) for place in PLACES]


def body_file(path: Path, modes: int = MODES) -> Path:
    """The body in a file."""
    model = fe_model()
    faces = [(RigidFace((place * LENGTH, 0.0, 0.0), nodes), "full")
             for place, nodes in zip(PLACES, sections(model), strict=True)]
    return save_body(reduce(model, faces, modes), path)


def linkage(path: Path) -> Model:
    """Crank and rocker hang on the ground, the coupler of the file between them."""
    body = load_body(path)
    model = Model()
    model.gravity(GRAVITY)
    nodes = [model.node(f"i{k}", point) for k, point in enumerate(body.coordinates)]
    model.superelement("coupler", body, nodes)
    for name, pin, length in (("crank", nodes[0], CRANK), ("rocker", nodes[-1], ROCKER)):
        foot = pin.point - (0.0, length, 0.0)
        link = model.node(name, foot)
        model.rigid_body(name, link, 1.0, [length**2 / 12] * 3,
                         centre=foot + (0.0, length / 2, 0.0))
        model.revolute(link)
        model.attach(f"{name} pin", pin.point, link)
        model.revolute(pin, to=f"{name} pin")
    return model


def own(path: Path, steps: int = STEPS, runs: int = RUNS) -> dict:
    """Microseconds a step, the quickest of several runs."""
    results = [Simulation(linkage(path), STEP).run_to(steps * STEP).result() for _ in range(runs)]
    best = min(result.seconds for result in results)
    return {"us": 1e6 * best / steps, "path": results[0]["i2.position"]}


def peer(steps: int = PEER_STEPS, modes: int = MODES) -> dict:
    """The same by Exudyn."""
    from exudyn.FEM import FEMinterface, HCBstaticModeSelection, ObjectFFRFreducedOrderInterface
    from exudyn.itemInterface import (
        GenericJoint,
        MarkerBodyRigid,
        MarkerSuperElementRigid,
        ObjectGround,
    )
    from exudyn.rigidBodyUtilities import RigidBodyInertia
    from scipy.sparse import csr_matrix

    from sebody.verify.bench.peer_models import new_system, solve

    system, mbs = new_system()
    model, fem = fe_model(), FEMinterface()
    sets = [nodes.tolist() for nodes in sections(model)]
    fem.nodes = {"Position": np.array(model.coordinates)}
    fem.massMatrix, fem.stiffnessMatrix = csr_matrix(model.mass), csr_matrix(model.stiffness)
    with contextlib.redirect_stdout(io.StringIO()):
        fem.ComputeHurtyCraigBamptonModes(boundaryNodesList=sets, nEigenModes=modes,
                                          useSparseSolver=False,
                                          computationMode=HCBstaticModeSelection.RBE2)
        reduced = ObjectFFRFreducedOrderInterface(fem)
    body = reduced.AddObjectFFRFreducedOrder(mbs, positionRef=[0, 0, 0], gravity=list(GRAVITY))
    pins = [mbs.AddMarker(MarkerSuperElementRigid(
        bodyNumber=body["oFFRFreducedOrder"], meshNodeNumbers=nodes,
        weightingFactors=[1.0 / len(nodes)] * len(nodes))) for nodes in sets]
    ground = mbs.AddObject(ObjectGround())
    ends = ((pins[0], 0.0, CRANK, [1, 1, 1, 1, 1, 0]), (pins[-1], LENGTH, ROCKER,
                                                         [1, 1, 0, 0, 0, 0]))
    for pin, x, length, held in ends:
        inertia = RigidBodyInertia(mass=1.0, inertiaTensor=np.eye(3) * length**2 / 12)
        link = mbs.CreateRigidBody(inertia=inertia, gravity=list(GRAVITY),
                                   referencePosition=[x, -length / 2, 0.0], returnDict=False)
        foot, top = (mbs.AddMarker(MarkerBodyRigid(bodyNumber=link, localPosition=[0, y, 0]))
                     for y in (-length / 2, length / 2))
        base = mbs.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=[x, -length, 0]))
        mbs.AddObject(GenericJoint(markerNumbers=[base, foot], constrainedAxes=[1, 1, 1, 1, 1, 0]))
        mbs.AddObject(GenericJoint(markerNumbers=[top, pin], constrainedAxes=held))
    run = solve(system, mbs, pins[2], STEP, steps * STEP)
    return {"us": 1e6 * run.seconds / run.steps, "path": run.tip}


def measure(steps: int = STEPS, peer_steps: int = PEER_STEPS, runs: int = RUNS,
            modes: int = MODES) -> dict:
    """Times, their ratio, and how far apart the middles are where both have run."""
    with tempfile.TemporaryDirectory() as folder:
        ours = own(body_file(Path(folder) / "coupler.npz", modes), steps, runs)
    found = {"interfaces": len(PLACES), "modes": modes, "step": STEP, "sebody_us": ours["us"],
             "machine_rate": machine_rate()}
    with contextlib.suppress(ImportError):
        theirs = min((peer(peer_steps, modes) for _ in range(runs)), key=lambda run: run["us"])
        times = np.round(theirs["path"][:, 0] / STEP).astype(int)
        apart = theirs["path"][:, 1:] - ours["path"][times]
        found |= {"exudyn_us": theirs["us"], "ratio": theirs["us"] / ours["us"],
                  "apart": float(np.abs(apart).max()),
                  "way": float(np.abs(np.ptp(theirs["path"][:, 1:], axis=0)).max())}
    return found


def main() -> None:
    """Print the numbers."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--json", action="store_true")
    found = measure()
    if parser.parse_args().json:
        print(json.dumps(found))
        return
    for name, value in found.items():
        print(f"{name:14} {value:.5g}")


if __name__ == "__main__":
    main()
