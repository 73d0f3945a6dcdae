"""Straight beams that `bench_stiffening` measures."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq
from spinning_body import with_torsion
from stiffened_models import (
    SLENDER,
    cantilever,
    nearest,
)

from sebody import Model, simulate
from sebody.analysis import equilibrium, linearize, modes, vibrations
from sebody.scenes import hinged_beam, slider_crank, spherical_beam_strong, spin_up
from sebody.verify import references

ETA = 6.0
GROWTH = 1e-3           # rate of small motion that is no rounding error, of the lowest frequency
Values = dict[str, float]
SPINNING = {"flap 1": 7.360373, "flap 2": 26.80908, "lag 1": 4.263225}
SHAFT = {"backward": 0.5, "forward": 1.5}


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
        return modes(equilibrium(model, 1, unstable="keep")).growth.max() - 1e-2

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
        flat = equilibrium(model, 1, unstable="keep")
        return np.linalg.eigvals(linearize(flat).stiffness).real.min()
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


def many_nodes(option: dict) -> Values:
    """Cantilevers with 3, 5 and 8 boundary nodes at eta = 6."""
    found = {}
    for nodes, internal in ((3, 4), (5, 8), (8, 8)):
        one = frequencies(cantilever(option, nodes, internal, 12), (0.0, 0.0, ETA), SPINNING)
        found |= {f"{nodes} nodes, {name}": one[name] for name in ("flap 1", "lag 1")}
    return found


def four_bodies(option: dict) -> Values:
    """Division: four bodies with two modes at eta = 6."""
    model = Model()
    ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
    model.beam("arm", ends, SLENDER, 24, 4, 2, **option)
    model.fix("root")
    return frequencies(model, (0.0, 0.0, ETA), SPINNING)
