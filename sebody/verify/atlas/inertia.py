"""Strong impulses and large elastic rotations: where the approximations of the paper end."""

import numpy as np

from sebody.contract.layout import RESIDUAL
from sebody.engine.evaluate import assemble
from sebody.fem import straight_beam
from sebody.kernels.rotations import exp_map
from sebody.model.model import Model
from sebody.reduction.craig_bampton import craig_bampton
from sebody.runs.simulation import Simulation
from sebody.runs.whole_runs import simulate
from sebody.scenes import spherical_beam_strong
from sebody.scenes.hinged_beam import SECTION
from sebody.verify.atlas.finding import REFERENCE, Finding, Row
from sebody.verify.references import reference

IMPULSES = (100.0, 350.0, 700.0, 1400.0, 2800.0)
AFTER = 15.2            # time at which the energy is read, after the impulse
# energies after the impulse of 2800, by tests/data/superelement_options.py of the repository
BY_OPTION = {"a": 32750.4, "b": 39585.8}


def impulses() -> Finding:
    """Energy that a beam on a spherical joint takes from an impulse at its tip."""
    finding = Finding(
        "strong impulses, options A, B and C",
        "energy after an impact, compared with nonlinear beams",
        "Options A and B neglect the velocity due to the rotation of deformed bodies. Therefore "
        "the energy after an impulse is too low; the relative error grows with the impulse and is "
        "several times larger with A than with B, because of spurious spin about the beam's axis. "
        "Option C neglects nothing.",
        "sebody uses C with stiffening by default; it warns if a body without stiffening spins "
        "faster than its limit.",
        "peak force", "relative error of the energy", logarithmic="xy")
    exact = {F: _energy(F, modes=0, elements=8, bodies=8) for F in IMPULSES}
    for F in (700.0, 2800.0):
        finding.rows.append(Row(f"nonlinear beams, force {F:g}", _reference(F), exact[F], 5e-3,
                                REFERENCE))
    errors = {}
    for option in "ab":
        errors[option] = [abs(_energy(F, inertia=option) / exact[F] - 1) for F in IMPULSES]
        finding.curves[f"option {option.upper()}"] = IMPULSES, errors[option]
    for name, stiffening in (("option C", False), ("option C with stiffening", True)):
        deviations = [abs(_energy(F, stiffening=stiffening) / exact[F] - 1) for F in IMPULSES]
        finding.curves[name] = IMPULSES, deviations
        # four modes; eight leave 7e-4
        finding.rows.append(Row(f"{name}, force 2800: energy", exact[2800.0],
                                exact[2800.0] * (1 + deviations[-1]), 5e-3))
    for F, a, b in zip(IMPULSES, errors["a"], errors["b"], strict=True):
        finding.rows.append(Row(f"force {F:g}: the error of A exceeds that of B", 1.0,
                                float(a > b), 0.0))
    for option, energy in BY_OPTION.items():
        finding.rows.append(Row(f"option {option.upper()}, force 2800: error",
                                1 - energy / _reference(2800.0), errors[option][-1], 0.15,
                                REFERENCE))
        finding.predict(f"option {option.upper()}, another program", (2800.0,),
                        (1 - energy / _reference(2800.0),))
    return finding


def _reference(force: float) -> float:
    """Energy after the impulse of the geometrically exact beam."""
    data = reference("spherical_beam_strong")
    energy = data[f"kinetic_{force:g}"] + data[f"strain_{force:g}"]
    return float(np.interp(AFTER, data["t"], energy))


def _energy(force: float, **parameters) -> float:
    scene = spherical_beam_strong.build(force, **parameters)
    result = simulate(scene.model, 0.005, AFTER, output_every=4)
    return float((result["energy.kinetic"] + result["energy.strain"])[-1])


def small_increments() -> Finding:
    """Forces of (20), in which increments of the frame are small, against those of (19)."""
    finding = Finding(
        "linearized increments of the frame",
        "error of the forces: second order in the elastic rotation",
        "Equation (20) of the paper neglects terms of (19) of second order in the elastic "
        "rotation: the relative error of the forces is 3e-3 at 0.3 rad, and the forces are not "
        "the gradient of an energy.",
        "sebody offers (20) as frame 'mean_small' for comparison; the default frame is exact.",
        "elastic rotation [rad]", "relative error of the forces", logarithmic="xy")
    angles = np.geomspace(0.01, 0.8, 9)
    differences = [_force_difference(angle) for angle in angles]
    finding.curves["measured"] = angles, differences
    finding.predict("second order", angles, differences[0] * (angles / angles[0])**2)
    slope = np.polyfit(np.log(angles[:6]), np.log(differences[:6]), 1)[0]
    finding.rows.append(Row("order in the elastic rotation", 2.0, slope, 0.1))
    return finding


def _force_difference(angle: float) -> float:
    """Both ends rotated about three axes against each other, with the frame at rest."""
    forces = []
    for frame in ("mean", "mean_small"):
        model = Model()
        ends = model.node("a", (0, 0, 0)), model.node("b", (10.0, 0, 0))
        body = craig_bampton(straight_beam((0, 0, 0), (10.0, 0, 0), SECTION, 4),
                             [(0, "full"), (4, "full")], 0)
        model.superelement("beam", body, ends, frame=frame)
        run = Simulation(model, 0.01)
        axis = np.array([0.3, 0.5, 0.8]) / np.sqrt(0.98)
        for k, node in enumerate(ends):
            turn = (-0.5 + k) * angle * axis
            at = run.numbering.rotations[node.rotation]
            run.state.R[9 * at:9 * at + 9] = exp_map(*turn)
        run.state.a[:] = 0.0
        assemble(RESIDUAL, RESIDUAL, run.system, run.state, run.state.residual)
        forces.append(run.state.residual.copy())
    return float(np.linalg.norm(forces[1] - forces[0]) / np.linalg.norm(forces[0]))
