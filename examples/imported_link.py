"""Four-bar linkage in space whose coupler is a body from a file, as `sebody import` writes it.

The first two interfaces of the body are its pins; the linkage takes its size from their distance.
A crank turns it from rest. Without a file the coupler is a block of steel made here.

Look at ``crank pin hinge.force.norm``: the crank turns once from rest to rest, and the force rises
where it is fastest. Bodies of solid elements have stresses: colour the page by von Mises stress.
"""

import numpy as np
from scipy.linalg import eigh

from sebody import Model, rest_to_rest
from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem import hexahedral_block
from sebody.io import load_body
from sebody.reduction import ReducedBody, RigidFace, craig_bampton
from sebody.scenes.scene import Scene

CRANK, ROCKER = 0.3, 0.6        # of the distance of the pins
THICKNESS = 0.06                # of crank and rocker, square rods
STEPS = 20                      # in a period of the first free vibration


def build(body: str = "", turn: float = 60.0, frame: str = "converged_mean",
          inertia: str | None = None) -> Scene:
    """The scene, at rest, its crank and rocker normal to the coupler.

    Parameters
    ----------
    body : str
        Body file of the coupler; two interfaces or more, the first two with rotations.
    turn : float
        Time of the one turn of the crank, in periods of the coupler's first free vibration.
    frame : str
        Frame of the coupler: converged_mean, mean, node, ...
    inertia : str
        Inertia option of the coupler: a, b, c or d; by default the best it can have.
    """
    turn = inputs.number(turn, "turn", above=0)
    coupler = load_body(body) if body else block()
    if coupler.planar or len(coupler.keeps) < 2 or coupler.keeps[:2] != ("full", "full"):
        raise InputError("the coupler needs two interfaces in space with rotations as its first "
                         "ones: import it with these interfaces first")
    left, right = coupler.coordinates[:2]
    length = float(np.linalg.norm(right - left))
    along = (right - left) / length
    axis = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    axis /= np.linalg.norm(axis)
    down = np.cross(along, axis)

    model = Model()
    nodes = [model.node(f"interface {k}", point) for k, point in enumerate(coupler.coordinates)]
    model.superelement("coupler", coupler, nodes, frame=frame, inertia=inertia)
    for name, pin, size in (("crank", left, CRANK), ("rocker", right, ROCKER)):
        arm = size * length * down
        link = model.node(name, pin + arm)
        model.fix(link, "position")
        mass = coupler.total_mass * size
        across, own = mass * (size * length)**2 / 12, mass * (THICKNESS * length)**2 / 6
        model.rigid_body(name, link, mass, across * np.eye(3) + (own - across)
                         * np.outer(down, down), centre=pin + arm / 2)
        model.attach(f"{name} pin", pin, link)
    model.revolute("rocker", axis=axis, name="rocker hinge")
    model.revolute(nodes[0], axis=axis, to="crank pin", name="crank pin hinge")
    model.revolute(nodes[1], axis=axis, to="rocker pin", name="rocker pin hinge")
    period = first_period(coupler)
    model.move("crank", axis, rest_to_rest(2 * np.pi, turn * period),
               "rotation")
    return Scene("imported-link", f"four-bar with a coupler of {len(nodes)} interfaces and "
                 f"{coupler.modes} modes", model, h=period / STEPS, t_end=turn * period,
                 base="interface 0", tip="interface 1")


def block() -> ReducedBody:
    """A coupler of steel, its end faces tied to the pins."""
    model = hexahedral_block((0.0, -0.02, -0.01), (1.0, 0.04, 0.02), (12, 2, 1), 2.1e11, 0.3, 7850)
    faces = [RigidFace((x, 0.0, 0.0), np.flatnonzero(np.abs(model.coordinates[:, 0] - x) < 1e-9))
             for x in (0.0, 1.0)]
    return craig_bampton(model, [(face, "full") for face in faces], modes=4)


def first_period(body: ReducedBody) -> float:
    """Period of the first vibration of the free body [time]."""
    squares = eigh(body.stiffness, body.mass, eigvals_only=True)
    return 2 * np.pi / np.sqrt(squares[body.rigid_modes.shape[1]])


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
