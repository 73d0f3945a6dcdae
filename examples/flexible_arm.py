"""A flexible arm that a motor turns, controlled at its hub or by a regulator of all its states.

The controller of the hub sees angle and rate of the hinge alone and leaves the tip vibrating. The
regulator is made from the state space about the place where the arm shall come to rest.

Look at ``tip.rotation`` and ``hinge.angle``: the regulator brings the tip to 0.3 rad in 0.6 s and
leaves no vibration. With ``controller=pd`` the hub is as fast and the tip goes on vibrating.
``motor.moment`` stays within 5 Nm.
"""

import numpy as np

from sebody import Model, Simulation
from sebody.analysis import state_space
from sebody.basics import inputs
from sebody.control import pid, state_feedback
from sebody.fem import rectangle
from sebody.scenes.regulators import regulator
from sebody.scenes.scene import Scene

LENGTH, TURN, PERIOD = 1.0, 0.3, 0.002
SECTION = rectangle(0.003, 0.03, 7e10, 0.3, 2700.0)


def arm(angle: float = 0.0, modes: int = 2) -> Model:
    """The arm with its motor, at an angle."""
    model = Model(planar=True, units="m kg s N")
    model.node("base", (0.0, 0.0))
    model.node("tip", (LENGTH * np.cos(angle), LENGTH * np.sin(angle)))
    model.beam("beam", ("base", "tip"), SECTION, 20, 1, modes)
    model.rigid_body("hub", "base", 1.0, 0.02)
    model.rigid_body("load", "tip", 0.1, 1e-4)
    model.revolute("base", name="hinge")
    model.actuator("motor", joint="hinge", limit=5.0)
    return model


def build(controller: str = "regulator", modes: int = 2) -> Scene:
    """The scene.

    Parameters
    ----------
    controller : str
        'pd': of the hub; 'regulator': of all states.
    modes : int
        Internal modes of the arm.
    """
    model = arm(modes=modes)
    if inputs.choice(controller, "controller", ("pd", "regulator")) == "pd":
        model.controller("loop", pid(8.0, kd=1.2, filter=400.0, reference=TURN), ["hinge.angle"],
                         ["motor"], PERIOD)
    else:
        there = Simulation(arm(TURN, modes), PERIOD)
        system = state_space(there, "motor", ["hinge.angle", "tip.rotation",
                                              "tip.angular_velocity"])
        Q = system.C.T @ np.diag([40.0, 400.0, 4.0]) @ system.C + 1e-6 * np.eye(len(system.A))
        K = regulator(system, Q, np.array([[1.0]]), PERIOD)
        # a model that is built at an angle counts its rotations from there
        wanted = [there.read(name) + TURN * name.endswith(".rotation")
                  for name in system.measurements]
        model.controller("loop", state_feedback(K, wanted), system.measurements, ["motor"],
                         PERIOD)
    return Scene("flexible-arm", f"flexible arm turned by a motor, {controller}", model, h=0.001,
                 t_end=3.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
