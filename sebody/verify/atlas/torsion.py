"""A blade with soft torsion that turns about its root: option B twists it apart."""

import numpy as np

from sebody.fem import StiffnessSection
from sebody.model.model import Model
from sebody.runs.limits.watch import spin_limit
from sebody.runs.statics import equilibrium
from sebody.small_motion.linearization import modes
from sebody.verify.atlas.beams import FRAMES, UNSTABLE, onset
from sebody.verify.atlas.finding import Finding, Row

SOFTNESS = (0.3, 0.1, 0.03, 0.01, 0.003, 0.001)     # G J / E I
# m L^4 W^2 / G J: momenta of the nodes by the cubic shapes, m L^3 / 20 and m L^3 / 30, and 1 / 105
# and 1 / 140 of bending by the spin's part across, for twist at the tip and half of it at each end
SQUARES = {"node": 1 / (1 / 20 + 1 / 105), "mean": 1 / ((1 / 20 - 1 / 30 + 1 / 30) / 4)}
ELEMENTS = 8
MEASURED = 0.01         # softness of which the spin is searched
STEPS = 3               # from 0.8 to 1.2 of theory


def blade(torsion: float, frame: str, option: dict) -> Model:
    """Unit length, mass and bending stiffness, clamped at its root."""
    section = StiffnessSection(axial=1e7, bending_y=1.0, bending_z=1.0, torsion=torsion, mass=1.0,
                               inertia_x=2e-7, inertia_y=1e-7, inertia_z=1e-7)
    model = Model()
    ends = model.node("root", (0.0, 0.0, 0.0)), model.node("tip", (1.0, 0.0, 0.0))
    model.beam("blade", ends, section, ELEMENTS, 1, 0, frame=FRAMES[frame], **option)
    model.fix("root")
    return model


def soft_torsion() -> Finding:
    """Spin at which a blade of one body diverges in torsion; none does."""
    finding = Finding(
        "torsion of a rotating blade, option B",
        "a straight blade of option B becomes unstable in torsion",
        "Option B uses angular velocities in the axes of the nodes, which rotate as the blade "
        "twists. This couples bending momentum with torsion: a straight blade diverges in torsion "
        "at W = 8.94 sqrt(G J / m L^4) with the mean frame and at 4.10 with a node frame. A real "
        "blade does not diverge.",
        "sebody stiffens bodies by default; without stiffening it computes the limit of the body "
        "and warns at a quarter of this limit.",
        "G J / E I", "critical spin, W sqrt(m L^4 / E I)", logarithmic="xy")
    for frame, square in SQUARES.items():
        limits = []
        finding.predict(f"{frame} frame, theory", SOFTNESS, np.sqrt(square * np.array(SOFTNESS)))
        for torsion in SOFTNESS:
            theory = np.sqrt(square * torsion)
            model = blade(torsion, frame, {"inertia": "material"})
            limits.append(spin_limit(model.bodies["blade"], (0.0, 0.0, 1.0)))
            finding.rows.append(Row(f"{frame} frame, G J / E I {torsion:g}: limit of the body",
                                    theory, limits[-1], 1e-3))
            if torsion == MEASURED:
                onset_spin = onset(lambda spin, own=model: _diverges(own, spin), 0.8 * theory,
                                   1.2 * theory, STEPS)
                finding.rows.append(Row(f"{frame} frame, G J / E I {torsion:g}: measured", theory,
                                        onset_spin, 1e-3))
        finding.curves[f"{frame} frame, limit"] = SOFTNESS, limits
        finding.curves[f"{frame} frame, measured"] = [MEASURED], [onset_spin]
    stable = not any(_diverges(blade(1e-3, "mean", {}), spin) for spin in (1.0, 3.0, 6.0))
    finding.rows.append(Row("stiffening, G J / E I 0.001: stable at 1, 3, 6", 1.0, float(stable),
                            0.0))
    return finding


def _diverges(model: Model, speed: float) -> bool:
    spin = (0.0, 0.0, speed)
    return bool(modes(equilibrium(model, 1, spin=spin), spin).growth.max() > UNSTABLE)
