"""A closed loop with a flexible coupler under a continuous law: both sweeps, and differences."""

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model, generalized_alpha
from sebody.analysis import Ensemble, final, gradient
from sebody.control import pid
from sebody.fem import circle

TURN = Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()
AXIS = TURN[:, 2]
H, END = 2e-3, 0.4
NUMBERS = {"coupler.stiffness": 1.0, "crank.mass": 1.0, "loop.parameters": [25, 8, 2, 60, 0.5]}
OUTPUTS = {"c": final("c.position")}
LEFT = 5e-13        # of a position near one, by Newton's iteration to 1e-13 over 200 steps


def place(x, y):
    return np.array((0.3, 0.1, -0.2)) + TURN @ np.array((x, y, 0.0))


def four_bar():
    """In space and turned: its revolute joints are redundant."""
    model = Model()
    A, B, C, D = place(0, 0), place(0.4, 0.3), place(1.2, 0.5), place(1, 0)
    a, d = model.node("a", A), model.node("d", D)
    model.revolute(a, axis=AXIS, name="pin")
    model.rigid_body("crank", a, 0.6, 0.01 * np.eye(3), centre=(A + B) / 2)
    end = model.attach("end", B, a)
    b, c = model.node("b", B, at=end), model.node("c", C)
    model.revolute(b, axis=AXIS, to=end)
    model.beam("coupler", (b, c), circle(0.012, 7e10, 0.3, 2700.0), 10, 1, 4)
    model.revolute(d, axis=AXIS)
    model.rigid_body("rocker", d, 0.7, 0.02 * np.eye(3), centre=(C + D) / 2)
    model.revolute(c, axis=AXIS, to=model.attach("other", C, d))
    model.gravity(TURN @ np.array((0.3, -9.0, 1.0)))
    model.actuator("motor", joint="pin")
    model.controller("loop", pid(kp=25.0, ki=8.0, kd=2.0, filter=60.0, reference=0.5),
                     ["pin.angle"], ["motor"])
    return model


def test_both_sweeps_give_the_same_to_rounding():
    """With the usual tolerance of a run; states of laws have small weights."""
    back, forth = (gradient(four_bar(), H, END, OUTPUTS, list(NUMBERS), mode=mode).matrix
                   for mode in ("adjoint", "forward"))
    assert (np.abs(back - forth).max(axis=0) < 1e-9 * np.abs(forth).max(axis=0)).all()


def test_they_are_the_limit_of_differences():
    """Of fourth order, of runs that converge to rounding."""
    scheme = generalized_alpha(tolerance=1e-13)
    found = gradient(four_bar(), H, END, OUTPUTS, list(NUMBERS), scheme=scheme).matrix
    many, column = Ensemble(four_bar(), H, scheme), 0
    for name, base in NUMBERS.items():
        base = np.array(base, dtype=float)
        for unit in np.eye(base.size):
            step = 1e-3 * max(abs(unit @ base.ravel()), 1.0)
            values = [base + (at * step * unit if base.ndim else at * step)
                      for at in (-2, -1, 1, 2)]
            y = many.run({name: np.array(values)}, END, OUTPUTS, threads=1)["c"]
            differences = (8.0 * (y[2] - y[1]) - (y[3] - y[0])) / (12.0 * step)
            size = np.abs(differences).max()
            # a stiff coupler hardly moves the point: what Newton's iteration leaves there shows
            left = 1.5 / step * LEFT
            assert np.abs(found[:, column] - differences).max() < 1e-6 * size + left
            column += 1
