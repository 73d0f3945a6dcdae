"""A flexible pole that a cart keeps upright, after a kick of its foot.

A regulator at 100 Hz feeds all coordinates and their rates back; it is made from the state space
about the upright position, which is unstable.

Look at ``cart.position.x`` and ``foot.rotation``: the cart first runs after the falling pole by
0.42 m, then takes it back upright. ``motor.force`` is constant between samples, 0.01 s apart.
"""

import numpy as np

from sebody import Model
from sebody.analysis import StateSpace, equilibrium, state_space
from sebody.control import state_feedback
from sebody.fem import StiffnessSection, planar_beam
from sebody.reduction import craig_bampton
from sebody.scenes.regulators import regulator
from sebody.scenes.scene import Scene

PERIOD, WEIGHT = 0.01, {"cart.position.x": 10.0, "foot.rotation": 20.0}
SECTION = StiffnessSection(axial=1e5, bending_y=2.0, bending_z=2.0, torsion=1.0, mass=0.2,
                           inertia_x=0.0, inertia_y=0.0, inertia_z=0.0)
SEEN = ("cart.position", "cart.velocity", "foot.rotation", "foot.angular_velocity",
        "top.position", "top.velocity")


def pole(kick: float = 0.0, modes: int = 4) -> Model:
    """Cart and pole with a motor, and gravity."""
    model = Model(planar=True)
    for name, place in (("cart", (0.0, 0.0)), ("foot", (0.0, 0.0)), ("top", (0.0, 1.0))):
        model.node(name, place)
    body = craig_bampton(planar_beam((0, 0), (0, 1), SECTION, elements=20),
                         [(0, "full"), (20, "full")], modes=modes).damped(0.005)
    model.superelement("pole", body, ["foot", "top"])
    model.rigid_body("box", "cart", 1.0, 1.0)
    model.prismatic("cart", axis=(1.0, 0.0), name="rail")
    model.revolute("foot", to="cart", name="hinge")
    model.gravity((0.0, -9.81))
    model.actuator("motor", joint="rail")
    anchor = model.node("anchor", (-5.0, 0.0))
    model.fix(anchor)
    model.spring("cart", anchor, stiffness=1e-7, name="tether")     # holds it at rest
    if kick:
        model.initial_velocity("foot", angular=kick)
        model.initial_velocity("top", (-kick, 0.0), kick)
    return model


def design(modes: int = 4) -> tuple[StateSpace, np.ndarray, np.ndarray]:
    """State space about the upright position, weights of the states, gain of the regulator."""
    system = state_space(equilibrium(pole(modes=modes), 1, unstable="keep"), "motor", SEEN)
    weights = np.diag([WEIGHT.get(name, 0.0) for name in system.outputs])
    Q = system.C.T @ weights @ system.C + 1e-6 * np.eye(len(system.A))
    return system, Q, regulator(system, Q, np.array([[0.1]]), PERIOD)


def build(kick: float = 1.0, modes: int = 4) -> Scene:
    """The scene.

    Parameters
    ----------
    kick : float
        Angular velocity of the pole at the start [rad/s].
    modes : int
        Internal modes of the pole.
    """
    model = pole(kick, modes)
    system, _, K = design(modes)
    rest = equilibrium(pole(modes=modes), 1, unstable="keep")
    upright = [float(np.asarray(rest[name])[-1]) for name in system.measurements]
    model.controller("loop", state_feedback(K, upright), system.measurements, ["motor"], PERIOD)
    return Scene("pole-on-cart", f"flexible pole kept upright by a cart, kicked by {kick:g} rad/s",
                 model, h=0.005, t_end=6.0, base="foot", tip="top")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
