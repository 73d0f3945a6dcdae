"""A04 of the IFToMM library, Bricard's mechanism: five rods, six hinges, one equation too many.

Joint angles alternate between a and b with ``sin b = -sin a / (1 + sin a)``, which closes the loop
exactly; the motion is that of a alone, from twice the kinetic energy ``M(a) a'^2`` and the heights.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from sebody import Model, generalized_alpha, simulate
from sebody.results.result import Result
from sebody.verify.outside.case import Case, Quantity
from sebody.verify.outside.iftomm import INTERVAL, drift, error, quantity

GRAVITY, END, STEP = 9.81, 10.0, 1e-4
POINTS = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], float)
AXES = np.array([(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)], float)


def build(turn: ArrayLike | None = None) -> Model:
    """At rest in edges of a cube, perhaps turned."""
    turn = np.eye(3) if turn is None else np.asarray(turn)
    points, axes, model = POINTS @ turn.T, AXES @ turn.T, Model()
    model.gravity(turn @ (0.0, -GRAVITY, 0.0))
    end = None
    for k in range(5):
        begin = {} if end is None else {"at": end}
        node = model.node(f"r{k}", points[k], **begin)
        model.revolute(node, axis=axes[k], **({} if end is None else {"to": end}))
        rod = points[k + 1] - points[k]
        model.rigid_body(f"rod {k}", node, 1.0, (np.eye(3) - np.outer(rod, rod)) / 12.0,
                         centre=points[k] + rod / 2.0)
        end = model.attach(f"p{k}", points[k + 1], node)
    model.revolute(end, axis=axes[5], explicit=True)
    return model


def joints(a: complex) -> tuple[NDArray, NDArray]:
    """The six joints by the angle, and their derivatives, both (6, 3)."""
    s, c = np.sin(a), np.cos(a)
    t, dt = -s / (1 + s), -c / (1 + s)**2
    k = np.sqrt(1 - t * t)              # cos b, which stays above 0.86
    dk = -t * dt / k
    zero, one = 0.0 * a, 1.0 + 0.0 * a
    places = [(zero, zero, zero), (c, zero, -s), (c * (1 + t), -k, -s * (1 + t)),
              (c, -k * (1 + s), 1 - s), (zero, -k, 1 + t), (zero, zero, one)]
    rates = [(zero, zero, zero), (-s, zero, -c),
             (-s * (1 + t) + c * dt, -dk, -c * (1 + t) - s * dt),
             (-s, -dk * (1 + s) - k * c, -c), (zero, -dk, dt), (zero, zero, zero)]
    return np.array(places), np.array(rates)


def _inertia_and_height(a: complex) -> NDArray:
    """Twice the kinetic energy at a rate of one, and the sum of heights, of rods of mass one."""
    places, rates = joints(a)
    u, v = rates[:-1], rates[1:]
    return np.array([(u * u + v * v + u * v).sum() / 3.0,
                     (places[:-1, 1] + places[1:, 1]).sum() / 2.0])


def path(t: NDArray) -> NDArray:
    """Place of the fourth joint after a start from rest, gravity along -y, (n, 3)."""
    def rate(_: float, y: NDArray) -> list:
        values = _inertia_and_height(y[0] + 1e-30j)
        (M, _), (dM, dV) = values.real, values.imag / 1e-30
        return [y[1], -(0.5 * dM * y[1]**2 + GRAVITY * dV) / M]
    run = solve_ivp(rate, (0.0, t[-1]), [0.0, 0.0], method="DOP853", t_eval=t, rtol=1e-12,
                    atol=1e-13)
    return np.array([joints(a)[0][3] for a in run.y[0]])


def run(division: int = 1) -> Result:
    """Ten seconds without numerical damping."""
    h = STEP / division
    return simulate(build(), h, END, generalized_alpha(0.9, 1e-10), round(INTERVAL / h))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    result = run(division)
    return {"error of the library": error(result["p2.position"], path(result.t)),
            "drift of the energy [J]": drift(result)}


CASE = Case(
    "Bricard's mechanism", "IFToMM library A04 (slender rods)", measure,
    (quantity(), Quantity("drift of the energy [J]", 0.0, 1.0)),
    "reference: one equation of motion along the exact closure, at 1e-12. EXUDYN's "
    "bricardMechanism.py has bars of 0.1 m square, so other numbers")
