"""Frames of slender members that are struck while they spin."""

import warnings

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import LimitWarning, SimulationError
from sebody.fem import Section, frame
from sebody.model.model import Model
from sebody.reduction.body import ReducedBody
from sebody.reduction.craig_bampton import craig_bampton
from sebody.results.result import Result
from sebody.runs.whole_runs import simulate
from sebody.verify.atlas.finding import PROGRAM, Finding, Row

SECTION = Section(area=1e-4, inertia_y=8e-10, inertia_z=8e-10, torsion=1.6e-9, youngs_modulus=7e10,
                  poisson_ratio=0.3, density=2700.0)
POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])   # a hub, four tips
BLOWS = np.array([[20, -35, 45], [-40, 30, 33], [35, 43, -23], [28, -51, 14.0]])
OVER, T_END, STEP = 0.01, 0.5, 5e-4


def struck_frame() -> Finding:
    """Four arms in space as one body, whose frame follows rotations of the tips, or their mass."""
    finding = Finding(
        "light nodes and the frame",
        "energy is conserved if the floating frame follows positions or mean axes",
        "Tips have little rotary inertia. If the floating frame follows their rotations, it moves "
        "the whole bent body in the exact kinetic energy: at 0.1 rad the inertia of these motions "
        "changes by a multiple, and energy grows if the steps do not resolve them. Positions of "
        "tips, in contrast, move with the mass of the arms, and mean axes move with all mass.",
        "sebody uses the best-fit rotation of the positions if a body has three positions that "
        "are not on a line, and mean axes for other bodies that are not straight; it warns if a "
        "body bends whose frame follows rotations, and halves steps in which energy would grow.",
        "time [s]", "energy / energy after the impact")
    model = frame(POINTS, [(0, k) for k in range(1, 5)], SECTION, 8)
    body = craig_bampton(model, [(k, "full") for k in range(1, 5)], 12)
    for label, options in (("positions, the default", {}), ("mean axes", {"frame": "mean_axes"}),
                           ("rotations", {"frame": "converged_mean"})):
        result, warned = _run(body, options)
        energy = _after(result)
        finding.curves[label] = np.linspace(OVER, result.t[-1], len(energy)), energy
        if label == "rotations":
            finding.rows.append(Row(f"frame on {label}: warned", 1.0, float(warned), 0.0, PROGRAM))
        else:
            finding.rows.append(Row(f"change of energy, {label}", 0.0,
                                    float(np.abs(energy - 1.0).max()), 1e-3))
    finding.predict("conserved", (OVER, T_END), (1.0, 1.0))
    return finding


def _run(body: ReducedBody, options: dict[str, str]) -> tuple[Result, bool]:
    """The run, and whether it warned of the frame."""
    model = Model()
    nodes = [model.node(f"tip {k}", POINTS[k]) for k in range(1, 5)]
    model.superelement("frame", body, nodes, **options)
    model.rigid_velocity((0, 0, 0), (1.0, -2.0, 15.0), POINTS.mean(axis=0))
    for node, blow in zip(nodes, BLOWS, strict=True):
        model.force(node, blow, [(0, 0), (0.002, 1), (OVER - 0.002, 1), (OVER, 0)])
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", LimitWarning)
        try:
            result = simulate(model, STEP, T_END)
        except SimulationError as error:
            result = error.result
    return result, any("follows the rotations" in str(one.message) for one in told)


def _after(result: Result) -> NDArray:
    """Energy after the blow over that at its end; what grew beyond a picture is left out."""
    energy = (result["energy.kinetic"] + result["energy.strain"])[result.t > OVER - STEP / 2]
    return np.minimum(energy / energy[0], 1.2)
