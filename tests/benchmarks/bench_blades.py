"""General beams beside published digits: statics, dynamics, frequencies, divisions, kernels.

    python tests/benchmarks/bench_blades.py [--json] [statics] [superelements] [blade] [dynamics]
                                            [kernels]

References: kynema's tests static_composite_beam_bending, static_twisted_composite_beam_bending and
static_curved_composite_beam_bending, whose numbers are BeamDyn's; Chrono's utest_MOD_curved_beam
(Sonneville 2021), which that test accepts within 5 %; the series of dynamic_composite_beam_bending;
frequencies of the NREL 5 MW blade from its table of ElastoDyn.
"""

import argparse
import json
import time
import warnings
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

from sebody import Model, simulate
from sebody.fem import Axis, GeneralSection, Stations, StiffnessSection, beam_along
from sebody.scenes import blade
from sebody.verify.outside.composite_beam import composite
from sebody.verify.outside.composite_beam_dynamics import BEAMDYN, rms, stepped
from sebody.verify.outside.curved_beam import curved
from sebody.verify.outside.curved_superelements import curved_of_chrono
from sebody.verify.outside.general_beams import error, moved
from sebody.verify.outside.twisted_beam import twisted

CASES = {"composite": composite, "twisted": twisted, "curved": curved}
TABLE = Path(__file__).parent.parent / "data" / "nrel5mw_blade.txt"
NREL = (0.6777, 1.0865, 1.9543, 4.009)


def statics() -> dict:
    """Errors of one-element bodies, once and twice extrapolated."""
    found = {}
    for name, case in CASES.items():
        case = case()
        u = [moved(case, count) for count in (16, 32, 64)]
        once = [(4 * fine - coarse) / 3 for coarse, fine in zip(u, u[1:], strict=False)]
        found[name] = {"16": error(u[0], case), "32": error(u[1], case), "64": error(u[2], case),
                       "once": error(once[1], case),
                       "twice": error((16 * once[1] - once[0]) / 15, case)}
    return found


def superelements() -> dict:
    """Errors of bodies of eight elements and four modes by division; Chrono's beam of five."""
    found = {}
    for name, case in CASES.items():
        case = case()
        for how in ("length", "rotation"):
            found[f"{name}, {how}"] = {}
            for count in (1, 2, 3, 4, 8):
                if name == "curved" and count < 3:      # bent by more than bodies can be
                    continue
                found[f"{name}, {how}"][str(count)] = error(moved(
                    case, 8 * count, count, 4, divide=how), case)
    case = curved_of_chrono()
    found["Chrono's curved beam, 5 bodies, 12 modes"] = {
        how: error(moved(case, 40, 5, 12, divide=how), case) for how in ("length", "rotation")}
    return found


def nrel() -> tuple[Axis, Stations]:
    """The blade of the table: fraction, twist in degrees, mass, EI flapwise and edgewise."""
    rows = np.loadtxt(TABLE)
    rows = rows[np.diff(rows[:, 0], prepend=-1.0) > 0]
    s, twist, mass, flap, edge = rows.T
    sections = [GeneralSection(np.diag([1e10, 1e12, 1e12, 1e9, e, f]),
                               1.04536 * m * np.eye(6) * [1, 1, 1, 1e-4, 1e-4, 1e-4])
                for m, f, e in zip(mass, flap, edge, strict=True)]
    axis = Axis([[0, 0, 0], [0, 0, 61.5]], np.column_stack([s, -np.radians(twist)]), up=(1, 0, 0))
    return axis, Stations(s, sections)


def nrel_blade() -> dict:
    """Frequencies of the clamped blade [Hz], and their differences from the reference."""
    model = beam_along(*nrel(), 60)
    squares = eigh(model.stiffness.toarray()[6:, 6:], model.mass.toarray()[6:, 6:],
                   eigvals_only=True, subset_by_index=(0, 3))
    hertz = np.sqrt(squares) / (2 * np.pi)
    return {"Hz": hertz.tolist(), "off": (hertz / NREL - 1).tolist()}


def dynamics() -> dict:
    """Rms differences from BeamDyn's coarse series, and of superelements from fine beams."""
    coarse = stepped(16)
    fine = stepped(32, None, 0, 5e-4, 0.9)
    return {"16 bodies of one element, h 0.005, rho 0, to BeamDyn": rms(coarse, BEAMDYN),
            "4 bodies, 2 modes, h 0.0005, to 32 of one element": rms(
                stepped(16, 4, 2, 5e-4, 0.9), fine)}


def kernels() -> dict:
    """Microseconds a step of one body of four modes, and of the scene of a blade.

    A general section takes the general kernel until its own is made, as the summary of the run
    says; with SEBODY_KERNELS it is looked for there.
    """
    found = {}
    axis, section, force = composite()[:3]
    K = np.diag(section.stiffness)
    plain = StiffnessSection(K[0], K[4], K[5], K[3], section.mass[0, 0], 1.4433e-2, 4.097e-3,
                             1.0336e-2, K[1], K[2])
    for name, own, along in (("straight, uniform", plain, None), ("composite", section, axis)):
        model = Model()
        ends = model.node("root", axis.position(0.0)), model.node("tip", axis.position(1.0))
        model.beam("beam", ends, own, 16, 1, 4, axis=along, frame="mean_axes")
        model.fix(ends[0])
        model.force(ends[1], np.array(force) / 10)
        kernel = model.bodies["beam"].kernel
        found[f"{name}: {kernel}"] = _step(model, 1e-3)
    for options in ({}, {"bodies": 2, "elements": 32}, {"bodies": 32, "modes": 0}):
        scene = blade.build(**options)
        found[f"blade, {len(scene.model.bodies)} bodies"] = _step(scene.model, scene.h, 3.0)
    return found


def _step(model: Model, h: float, t_end: float = 0.5) -> float:
    """Microseconds of the processor a step, the quickest of three."""
    simulate(model, h, 10 * h)
    times = []
    for _ in range(3):
        began = time.process_time()
        simulate(model, h, t_end)
        whole = time.process_time() - began
        began = time.process_time()
        simulate(model, h, 10 * h)
        times.append((whole - (time.process_time() - began)) / (t_end / h - 10) * 1e6)
    return min(times)


PARTS = {"statics": statics, "superelements": superelements, "blade": nrel_blade,
         "dynamics": dynamics, "kernels": kernels}


def main(arguments: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="all by default")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(arguments)
    warnings.simplefilter("ignore")
    found = {name: PARTS[name]() for name in options.parts or PARTS}
    if options.json:
        print(json.dumps(found, indent=1))
        return
    for name, rows in found.items():
        print(name)
        for row, values in rows.items():
            print("  ", row, {key: float(f"{value:.3g}") for key, value in values.items()}
                  if isinstance(values, dict) else values)


if __name__ == "__main__":
    main()
