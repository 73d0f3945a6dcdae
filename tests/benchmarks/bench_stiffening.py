"""What one body does with every inertia option, beside exact values: the table of the README here.

    python tests/benchmarks/bench_stiffening.py [--json] [ROW ...]

Every row is a test case with named numbers; the columns are exact values and the options B, D, C
without and C with geometric stiffening. A dash stands where a run or an equilibrium fails, "none"
where no critical load is found. Some minutes.
"""

import argparse
import json
import sys
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from sebody import LimitWarning, Model, SebodyError, Simulation, simulate
from sebody.analysis import equilibrium, linearize, modes, vibrations
from sebody.fem import hexahedral_block
from sebody.reduction import RigidFace, craig_bampton
from sebody.scenes import hinged_beam, slider_crank, spherical_beam_strong, spin_up
from sebody.verify import references

sys.path.insert(0, str(Path(__file__).parents[1]))
from spinning_body import with_torsion
from stiffened_models import (
    SLENDER,
    TURN,
    accelerations,
    block,
    cantilever,
    divided_elbow,
    elbow,
    idle_spin,
    linkage,
    nearest,
    places,
    plate,
    plate_frequencies,
)

OPTIONS = {"B": {"inertia": "material"}, "D": {"inertia": "rigid_part"},
           "C": {"inertia": "floating_field", "stiffening": False},
           "C + stiffening": {"inertia": "floating_field"}}
ETA = 6.0
GROWTH = 1e-3           # rate of small motion that is no rounding error, of the lowest frequency
Values = dict[str, float]


def frequencies(model: Model, spin: np.ndarray, exact: Values, unit: float = 1.0) -> Values:
    """Nearest to exact ones; the real part of the eigenvalue in place of all where motion grows."""
    found = modes(equilibrium(model, 2, spin=spin), spin)
    if found.growth.max() > GROWTH * min(exact.values()) / unit:
        return {name: np.nan for name in exact}
    return {name: nearest(found, value / unit) * unit for name, value in exact.items()}


def hinged(option: dict) -> Values:
    """The paper's beam at its spin: first bending in the plane."""
    model = hinged_beam.build(modes=8, elements=40, **option).model
    return frequencies(model, (0.0, 0.0, 0.906), {"bending": 11.142})


def hinged_run(option: dict) -> Values:
    """Tip with four modes, and spread of the energy once the torque is gone."""
    found = {}
    for h in (0.01, 0.005, 0.0025):
        scene = hinged_beam.build(**option)
        result = simulate(scene.model, h, scene.t_end, output_every=round(0.01 / h))
        exact = references.tip_error("hinged_beam", result.t, result["tip.position"])
        energy = (result["energy.kinetic"] + result["energy.strain"])[result.t > 7.6]
        found |= {f"tip, h {h:g}": exact, f"energy spread, h {h:g}": np.ptp(energy) / energy[0]}
    return found


def struck(force: float, until: float) -> Callable[[dict], Values]:
    """The fast beam, struck: tip, energy after the blow and largest strain energy."""
    def measured(option: dict) -> Values:
        scene = spherical_beam_strong.build(force, modes=8, **option)
        result = simulate(scene.model, 0.0025, 30.0, output_every=4)
        exact = references.reference("spherical_beam_strong")
        path = exact[f"tip_position_{force:g}"][exact["t"] <= until + 1e-9]
        tip = result["tip.position"][np.searchsorted(result.t, exact["t"][:len(path)] - 1e-9)]
        energy = result["energy.kinetic"] + result["energy.strain"]
        return {"tip": np.linalg.norm(tip - path) / np.linalg.norm(path),
                "energy at 15.2": np.interp(15.2, result.t, energy),
                "energy at 30": energy[-1],
                "peak strain": result["energy.strain"].max()}
    return measured


def spinning(option: dict) -> Values:
    """A cantilever at eta = 6 with four modes."""
    return frequencies(cantilever(option), (0.0, 0.0, ETA), SPINNING)


def spun_up(case: str) -> Callable[[dict], Values]:
    """Deepest deflection of the tip."""
    def measured(option: dict) -> Values:
        scene = spin_up.build(case, bodies=1, modes=2, **option)
        result = simulate(scene.model, scene.h, 10.0)
        turning = spin_up.turning(spin_up.CASES[case][1])[0]
        angle = np.array([turning(t) for t in result.t])
        x, y = result["tip.position"].T
        return {"min v": (np.cos(angle) * y - np.sin(angle) * x).min()}
    return measured


def rod(option: dict) -> Values:
    """Middle of the slider-crank's rod, over its length."""
    scene = slider_crank.build(modes=5, **option)
    result = simulate(scene.model, scene.h, scene.t_end)
    body = scene.model.bodies["rod"].reduced
    line = result["slider.position"] - result["pin.position"]
    chord = np.unwrap(np.arctan2(line[:, 1], line[:, 0]))
    turned = [result[f"{node}.rotation"] - chord for node in ("pin", "slider")]
    y = np.column_stack([np.zeros((len(chord), 4)), *turned, result["rod.modes"]])
    shape = body.recovery.shapes[3 * (slider_crank.ELEMENTS // 2) + 1]
    found = y @ shape[:y.shape[1]] / slider_crank.LENGTH
    return {"max": found.max(), "min": found.min()}


def column(load: str, low: float, high: float) -> Callable[[dict], Values]:
    """Load at which small motion of a planar column begins to grow."""
    def grows(option: dict, value: float) -> float:
        model = Model(planar=True)
        ends = model.node("root", (0, 0)), model.node("tip", (1, 0))
        model.beam("arm", ends, SLENDER, 24, 1, 4, **option)
        model.fix("root")
        if load == "weight":
            model.gravity((-value, 0.0))
        else:
            model.force("tip", (-value, 0.0), follower=load == "follower")
        return modes(equilibrium(model, 1)).growth.max() - 1e-2

    def measured(option: dict) -> Values:
        if grows(option, high) < 0:
            return {"load": np.inf}
        return {"load": brentq(lambda p: np.sign(grows(option, p)), low, high, xtol=1e-4)}
    return measured


def sideways(option: dict) -> Values:
    """Fixed-direction tip load of a thin cantilever; four modes in bending, four in torsion."""
    thin = replace(SLENDER, axial=1e6, bending_y=1e3, inertia_x=2e-6, inertia_y=1e-6,
                   inertia_z=1e-6)
    body = with_torsion(thin, 24, 4, 4)

    def lowest(load: float) -> float:
        model = Model()
        ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
        model.superelement("arm", body, ends, **option)
        model.fix("root")
        model.force("tip", (0.0, 0.0, -load))
        return np.linalg.eigvals(linearize(equilibrium(model, 1)).stiffness).real.min()
    return {"load": brentq(lowest, 3.5, 5.5, xtol=1e-4) if lowest(5.5) < 0 else np.inf}


def shaft(option: dict) -> Values:
    """Spun at half its first frequency, in axes that turn with it."""
    def model() -> Model:
        found = Model()
        ends = found.node("a", (0, 0, 0)), found.node("b", (1, 0, 0))
        found.beam("shaft", ends, SLENDER, 24, 1, 4, **option)
        found.fix("a", "position")
        found.fix("b", "position")
        return found
    first = vibrations(equilibrium(model(), 1)).omega
    first = first[first > 1.0][0]
    spin = (0.5 * first, 0.0, 0.0)
    omega = modes(equilibrium(model(), 1, spin=spin), spin)
    return {name: nearest(omega, value * first) / first for name, value in SHAFT.items()}


def stretch(option: dict) -> Values:
    """Of an arm that turns, over rho A W^2 L^2 / E A."""
    a = 0.095
    section = replace(SLENDER, axial=1.0 / a**2)
    tip = equilibrium(cantilever(option, section=section), 2, spin=(0.0, 0.0, 1.0))
    return {"stretch": (tip["n1.position"][-1, 0] - 1.0) / a**2}


def solid(thickness: float, cells: tuple[int, int, int], internal: int, option: dict) -> Model:
    """Hexahedra, 40 long and 2 high, tied to a node at each end."""
    bricks = hexahedral_block([0, -thickness / 2, -1], [40, thickness, 2], cells, 1e6, 0.3, 1.0)
    x = bricks.coordinates[:, 0]
    ends = [RigidFace((place, 0.0, 0.0), np.flatnonzero(x == place)) for place in (0, 40)]
    model = Model()
    nodes = model.node("root", (0, 0, 0)), model.node("tip", (40, 0, 0))
    model.superelement("arm", craig_bampton(bricks, [(end, "full") for end in ends], internal),
                       nodes, **option)
    model.fix("root")
    return model


def spinning_solid(option: dict) -> Values:
    """40 x 2 x 2 hexahedra at eta = 6, six modes."""
    unit = np.sqrt(4.0 * 40.0**4 / (1e6 * 2.0**4 / 12))
    return frequencies(solid(2.0, (40, 2, 2), 6, option), (0.0, 0.0, ETA / unit), SOLID, unit)


def strip(option: dict) -> Values:
    """Euler's load of a thin strip, six modes."""
    def lowest(load: float) -> float:
        model = solid(0.3, (40, 1, 2), 6, option)
        model.force("tip", (-load, 0.0, 0.0))
        return np.linalg.eigvals(linearize(equilibrium(model, 1)).stiffness).real.min()
    return {"load": brentq(lowest, 5.0, 10.0, xtol=1e-4) if lowest(10.0) < 0 else np.inf}


def soft_blade(option: dict) -> Values:
    """Largest real part of an eigenvalue over the highest frequency, spins 1 to 6."""
    found = {}
    for torsion in (0.1, 0.01, 1e-3):
        section = replace(SLENDER, torsion=torsion, inertia_x=2e-6, inertia_y=1e-6,
                          inertia_z=1e-6)
        rates = []
        for eta in range(1, 7):
            spin = (0.0, 0.0, float(eta))
            one = modes(equilibrium(cantilever(option, section=section), 2, spin=spin), spin)
            rates.append(one.growth.max() / one.omega.max())
        found[f"GJ / EI {torsion:g}"] = max(rates)
    return found


def propeller(option: dict) -> Values:
    """Change of the square of a torsion frequency over that of the spin."""
    found = {}
    for name, (y, z) in {"square section": (1e-6, 1e-6), "thin section": (1e-7, 1.9e-6)}.items():
        section = replace(SLENDER, torsion=1e-2, bending_y=1e3, bending_z=1e3, inertia_x=y + z,
                          inertia_y=y, inertia_z=z)
        squares = []
        for spin in (0.0, 8.0):
            one = modes(equilibrium(cantilever(option, internal=0, span=16, section=section), 1,
                                    spin=(0, 0, spin)), (0, 0, spin))
            twist = np.argmax(np.abs(one.shape("n1.rotation")[0]))
            squares.append(one.values[twist].imag**2 - one.values[twist].real**2)
        found[name] = (squares[1] - squares[0]) / 64.0
    return found


PUSH = np.array([30.0, 4.0, -5.0])


def started(option: dict) -> Values:
    """A block by its corners, set spinning unstrained: largest acceleration by centripetal ones."""
    spin, found = 10.0 * TURN[:, 2], {}
    x = [node.point for node in block(option).nodes.values()]
    exact = np.abs(np.cross(spin, np.cross(spin, x))).max()
    for name, speed in zip(START, (0.0, 1.0), strict=True):
        run = Simulation(block(option, speed * PUSH, spin), 1e-4)
        found[name] = np.abs(accelerations(run)).max() / exact
    return found


def corners(option: dict) -> Values:
    """From centrifugal equilibrium: error of the accelerations, and their change by a speed."""
    spin = 10.0 * TURN[:, 2]
    run = equilibrium(block(option), 1, spin=spin)
    x = np.array([run.state.q[at] for at in places(run)])
    found, exact = accelerations(run), np.cross(spin, np.cross(spin, x))
    for at in places(run):
        run.state.v[at] += PUSH
    moved = accelerations(run)
    size = np.abs(exact).max()
    return {"error": np.abs(found - exact).max() / size,
            "change by a speed": np.abs(moved - found).max() / size}


def coupler(option: dict) -> Values:
    """Idle spin and largest strain energy of a coupler between ball joints, six modes."""
    result = linkage(option, 1, 6)
    return {"idle spin": idle_spin(result), "peak strain": result["energy.strain"].max()}


def divided_coupler() -> Values:
    """The same of sixteen bodies."""
    result = linkage({"inertia": "material"}, 16, 0)
    return {"idle spin": idle_spin(result), "peak strain": result["energy.strain"].max()}


def many_nodes(option: dict) -> Values:
    """Cantilevers with 3, 5 and 8 boundary nodes at eta = 6."""
    found = {}
    for nodes, internal in ((3, 4), (5, 8), (8, 8)):
        one = frequencies(cantilever(option, nodes, internal, 12), (0.0, 0.0, ETA), SPINNING)
        found |= {f"{nodes} nodes, {name}": one[name] for name in ("flap 1", "lag 1")}
    return found


def bent(option: dict) -> Values:
    """Largest relative error of four frequencies of an elbow at three spins."""
    first = vibrations(equilibrium(elbow(option), 1)).omega[0]
    found = {}
    for share in (0.21, 0.42, 0.63):
        spin = share * first * TURN[:, 2]
        coarse, fine = (modes(equilibrium(divided_elbow(n), 2, spin=spin), spin).omega[:4]
                        for n in (5, 10))
        exact = (4 * fine - coarse) / 3
        one = modes(equilibrium(elbow(option), 2, spin=spin), spin).omega[:4]
        found[f"at {share:g} omega 1"] = np.abs(one / exact - 1).max()
    return found


def corner_plate(option: dict) -> Values:
    """Largest relative error of four frequencies of a plate with four interfaces.

    NaN where small motion grows.
    """
    first, found = plate_frequencies(0.0)[0], {}
    for share in (0.5, 1.0, 2.0):
        spin, exact = (0.0, 0.0, share * first), plate_frequencies(share * first)[:4]
        one = modes(equilibrium(plate(option, 8), 2, spin=spin), spin)
        grows = one.growth.max() > GROWTH * first
        found[f"at {share:g} omega 1"] = (
            np.nan if grows else np.abs(one.omega[:4] / exact - 1).max())
    return found


def four_bodies(option: dict) -> Values:
    """Division: four bodies with two modes at eta = 6."""
    model = Model()
    ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
    model.beam("arm", ends, SLENDER, 24, 4, 2, **option)
    model.fix("root")
    return frequencies(model, (0.0, 0.0, ETA), SPINNING)


SPINNING = {"flap 1": 7.360373, "flap 2": 26.80908, "lag 1": 4.263225}
SOLID = {"flap 1": 7.360373, "lag 1": 4.263225}
START = {"at rest": 0.0, "flying": 0.0}
SHAFT = {"backward": 0.5, "forward": 1.5}
NO_SPREAD = {f"{what}, h {h:g}": 0.0 for h in (0.01, 0.005, 0.0025)
             for what in ("tip", "energy spread")}


def cases() -> dict[str, tuple[Values, Callable[[dict], Values]]]:
    """Exact values and measurement of every row."""
    strong = references.reference("spherical_beam_strong")
    beams = {f"{n} nodes, {name}": SPINNING[name] for n in (3, 5, 8)
             for name in ("flap 1", "lag 1")}

    def blow(force: float) -> Values:
        energy = strong[f"kinetic_{force:g}"] + strong[f"strain_{force:g}"]
        after = np.interp(15.2, strong["t"], energy)
        return {"tip": 0.0, "energy at 15.2": after, "energy at 30": after,
                "peak strain": float(strong[f"peak_strain_{force:g}"])}
    return {
        "hinged beam at its spin, 8 modes": ({"bending": 11.142}, hinged),
        "hinged beam, 30 s, 4 modes": (NO_SPREAD, hinged_run),
        "struck beam, 700, 8 modes": (blow(700.0), struck(700.0, 30.0)),
        "struck beam, 2800, 8 modes, tip to 20 s": (blow(2800.0), struck(2800.0, 20.0)),
        "cantilever at eta 6, 4 modes": (SPINNING, spinning),
        "spin-up, Kane, 2 modes": ({"min v": -0.53366}, spun_up("kane")),
        "spin-up, Simo, 2 modes": ({"min v": -0.57392}, spun_up("simo")),
        "slider-crank rod, 5 modes": ({"max": 0.015422, "min": -0.015543}, rod),
        "Euler, 4 modes": ({"load": np.pi**2 / 4}, column("dead", 2.0, 4.0)),
        "Beck, 4 modes": ({"load": 20.0510}, column("follower", 15.0, 24.0)),
        "own weight, 4 modes": ({"load": 7.8373}, column("weight", 6.0, 9.0)),
        "lateral buckling, 8 modes": ({"load": 4.0126}, sideways),
        "shaft at half its frequency, 4 modes": (SHAFT, shaft),
        "stretch of a turning arm": ({"stretch": 0.33454}, stretch),
        "solid at eta 6, 6 modes": (SOLID, spinning_solid),
        "thin solid, Euler, 6 modes": ({"load": 6.9696}, strip),
        "blade with soft torsion, growth": (
            {f"GJ / EI {t:g}": 0.0 for t in (0.1, 0.01, 1e-3)}, soft_blade),
        "propeller moment": ({"square section": 0.0, "thin section": 0.9}, propeller),
        "block by its corners, acceleration of an unstrained start": (START, started),
        "block by its corners, in equilibrium": ({"error": 0.0, "change by a speed": 0.0}, corners),
        "coupler between ball joints, 6 modes": ({}, coupler),
        "more boundary nodes at eta 6": (beams, many_nodes),
        "elbow, 3 nodes, 6 modes: errors": (
            {f"at {s:g} omega 1": 0.0 for s in (0.21, 0.42, 0.63)}, bent),
        "plate on four interfaces, 8 modes: errors": (
            {f"at {s:g} omega 1": 0.0 for s in (0.5, 1.0, 2.0)}, corner_plate),
        "four bodies with 2 modes at eta 6": (SPINNING, four_bodies),
    }


def measure(exact: Values, measured: Callable[[dict], Values]) -> dict[str, Values]:
    """By option; NaN for all numbers where there is no equilibrium or the run stops."""
    found = {}
    for name, option in OPTIONS.items():
        try:
            found[name] = {key: float(value) for key, value in measured(option).items()}
        except SebodyError:
            found[name] = {key: np.nan for key in exact}
    return found


def table(name: str, exact: Values, found: dict[str, Values]) -> str:
    """Lines of the README's table."""
    def cell(value: float | None) -> str:
        if value is None or np.isnan(value):
            return "-"
        return "none" if np.isinf(value) else f"{value:.5g}"
    return "\n".join(
        f"| {name}: {key} | {cell(exact.get(key))} | "
        + " | ".join(cell(values.get(key)) for values in found.values()) + " |"
        for key in exact)


def main(arguments: list[str] | None = None) -> None:
    """Measure the named rows, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", help="parts of the names of rows")
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_args(arguments)
    everything = {}
    if not chosen.json:
        print("| | exact | " + " | ".join(OPTIONS) + " |\n|---|---|" + "---|" * len(OPTIONS))
    for name, (exact, measured) in cases().items():
        if chosen.rows and not any(part in name for part in chosen.rows):
            continue
        exact = exact or divided_coupler()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", LimitWarning)
            found = measure(exact, measured)
        everything[name] = {"exact": exact} | found
        if not chosen.json:
            print(table(name, exact, found), flush=True)
    if chosen.json:
        print(json.dumps(everything))


if __name__ == "__main__":
    main()
