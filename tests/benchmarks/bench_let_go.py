"""Energy of a crane with three features at once: a rope, a payload that breaks off, a controller.

    python tests/benchmarks/bench_let_go.py [--json] [--steps 2.5e-3,1.25e-3]

A boom of two flexible bodies slews under a PID, a winch on its foot hoists a payload by a rope over
the sheave at its head, and the payload breaks off at a force; the rope gets slack and taut again.
The whole crane is turned in space. What is printed is the energy that balances by less than the
error of the steps, relative to what is exchanged.
"""

import argparse
import json
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.control import pid
from sebody.fem import tube
from sebody.model.profiles import rest_to_rest

STEPS = 2.5e-3, 1.25e-3, 6.25e-4, 3.125e-4, 1.5625e-4
T_END = 2.5
BREAKS = 4700.0         # force in the grip; the payload's weight is 3924
BOOM = 8.0 * np.array([np.cos(0.6), 0.0, np.sin(0.6)])


def build(turn: Rotation) -> Model:
    """The crane, turned."""
    model, R = Model(), turn.as_matrix()

    def node(name: str, x: float, y: float, z: float) -> str:
        model.node(name, R @ (x, y, z))
        return name

    def turned(*inertia: float) -> np.ndarray:
        return R @ np.diag(inertia) @ R.T
    for name in ("foot", "root"):
        node(name, 0.0, 0.0, 0.0)
    node("head", *BOOM)
    model.fix("foot")
    model.revolute("root", R[:, 2], to="foot", name="slew")
    model.rigid_body("turntable", "root", 500.0, turned(200.0, 200.0, 300.0))
    model.beam("boom", ("root", "head"), tube(0.12, 0.008, 2.1e11, 0.3, 7850.0), 4, bodies=2,
               modes=2, up=R[:, 1], damping=1e-3)
    model.attach("seat", R @ (0.5, 0.0, 0.9), "root")
    model.rigid_body("barrel", node("drum", 0.5, 0.0, 0.9), 80.0, turned(3.0, 5.0, 3.0))
    model.revolute("drum", R[:, 1], to="seat", name="axle")
    hook = BOOM + (0.2, 0.0, -4.0)
    model.rigid_body("block", node("hook", *hook), 60.0, turned(2.0, 2.0, 2.0))
    model.rigid_body("payload", node("load", *hook), 400.0, turned(30.0, 20.0, 30.0))
    model.spherical("load", to="hook", name="grip", breaks_at=BREAKS)
    model.gravity(-9.81 * R[:, 2])
    model.sheave("hoist", "drum", 0.25, axis=R[:, 1])
    model.sheave("tip", "head", 0.2, axis=R[:, 1])
    model.rope("rope", ("hoist", "tip", "hook"), stiffness=4e6, damping=4e4,
               pretension=460.0 * 9.81, wrap="-")
    model.drive_angle("axle", rest_to_rest(6.0, 2.0), name="winch")
    model.actuator("motor", joint="slew")
    model.sensor("heading", "slew.angle")
    model.controller("pilot", pid(kp=4e4, kd=2e4, reference=0.4, limit=2e4), ["heading"],
                     ["motor"], period=0.01)
    return model


def measure(h: float, t_end: float = T_END) -> dict:
    """Energy balance and the instant of the break with one step."""
    result = simulate(build(Rotation.from_rotvec([0.3, -0.7, 0.5])), h, t_end)
    broken, = result.events
    slack = np.count_nonzero(result["rope.elongation"] < 0.0) / len(result.t)
    return {"h": h, "balance": result.energy_balance(), "breaks": broken.time,
            "slack": float(slack)}


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--steps", default=",".join(map(str, STEPS)))
    options = parser.parse_args(arguments)
    rows = [measure(float(h)) for h in options.steps.split(",")]
    for before, row in pairwise(rows):
        row["order"] = float(np.log(before["balance"] / row["balance"])
                             / np.log(before["h"] / row["h"]))
    if options.json:
        print(json.dumps(rows))
        return
    for row in rows:
        print("  ".join(f"{name} {value:.4g}" for name, value in row.items()))


if __name__ == "__main__":
    main()
