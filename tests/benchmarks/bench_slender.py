"""Random slender bodies that are not straight, as one body each, beside nonlinear beams.

    python tests/benchmarks/bench_slender.py [--json] [--first N] [--bodies N]

Bows, waves, arcs, helices and kinks, 150 to 1000 radii of gyration long, two to four interfaces, 6
to 16 modes, spun and struck for 1.2 periods of the first vibration of a straight rod. Errors are
the largest distance of an interface from that of the beams, over the length; of the default body,
of the same without resultants of internal modes, and without stiffening. Runs that stop count as 1.
"""

import argparse
import json
import warnings
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody import Model, SimulationError, simulate
from sebody.fem import Section, frame
from sebody.reduction import craig_bampton, stiffening

SHAPES = ("bow", "wave", "arc", "helix", "kink")
MEMBERS, STEPS, PERIODS = 12, 400, 1.2
VARIANTS = {"default": {}, "no internal resultants": {}, "no stiffening": {"stiffening": False}}
BODIES = 80


def axis(random: np.random.Generator, shape: str) -> NDArray:
    """Points of a line of about unit length, (MEMBERS + 1, 3)."""
    t = np.linspace(0.0, 1.0, MEMBERS + 1)
    if shape in ("bow", "wave"):
        rise = 10**random.uniform(-4, -1.3)
        both = ((4 * t * (1 - t),) * 2 if shape == "bow" else
                (np.sin(2 * np.pi * t), np.sin(3 * np.pi * t)))
        return np.column_stack([t, 0.6 * rise * both[0], 0.8 * rise * both[1]])
    if shape == "kink":
        at, rise = random.integers(1, MEMBERS) / MEMBERS, 10**random.uniform(-3, -0.3)
        return np.column_stack([t, rise * np.where(t < at, t / at, (1 - t) / (1 - at)), 0 * t])
    angle = random.uniform(0.3, 4.0)
    rise = random.uniform(0.1, 0.6) if shape == "helix" else 0.0
    return np.column_stack([np.sin(angle * t) / angle, (1 - np.cos(angle * t)) / angle, rise * t])


class Slender:
    """One of them; `seed` makes the same one again."""

    def __init__(self, seed: int):
        random = np.random.default_rng(seed)
        self.shape, self.length = SHAPES[seed % len(SHAPES)], random.uniform(0.5, 2.0)
        turn = Rotation.from_rotvec(random.normal(size=3)).as_matrix()
        self.points = self.length * axis(random, self.shape) @ turn.T + random.normal(size=3)
        depth = self.length * 10**random.uniform(-2.5, -1.6)
        width = depth * random.uniform(1.0, 2.5)
        area, inertias = depth * width, (depth**3 * width / 12, depth * width**3 / 12)
        self.section = Section(area, *inertias, 0.8 * sum(inertias), 7e10, 0.3, 2700.0)
        between = random.choice(np.arange(1, MEMBERS), random.integers(0, 3), replace=False)
        self.kept = sorted({0, MEMBERS, *map(int, between)})
        if len(self.kept) > 2 and random.random() < 0.3:
            self.kept.pop()         # an end hangs free
        self.modes = int(random.integers(6, 17))
        line = 2700.0 * area
        first = 22.4 * np.sqrt(7e10 * inertias[0] / line) / self.length**2
        self.t_end = PERIODS * 2 * np.pi / first
        size = random.uniform(6e-4, 8e-3) * line * (self.length * first)**2
        directions = random.normal(size=(len(self.kept), 3))
        self.forces = size * directions / np.linalg.norm(directions, axis=1, keepdims=True)

    def body(self, **options) -> Model:
        """As one superelement."""
        model = Model()
        fe_model = frame(self.points, [(k, k + 1) for k in range(MEMBERS)], self.section, 2)
        reduced = craig_bampton(fe_model, {k: "full" for k in self.kept}, self.modes)
        nodes = [model.node(f"p{k}", self.points[k]) for k in self.kept]
        model.superelement("body", reduced, nodes, **options)
        return model

    def beams(self) -> Model:
        """As nonlinear beams."""
        model = Model()
        nodes = [model.node(f"p{k}", point) for k, point in enumerate(self.points)]
        for k in range(MEMBERS):
            model.beam(f"beam {k}", nodes[k:k + 2], self.section, 2)
        return model

    def path(self, model: Model) -> NDArray | None:
        """Of the interfaces; nothing if the run stops."""
        model.rigid_velocity((0.3, -0.2, 0.1), (1.0, -2.0, 5.0), self.points.mean(axis=0))
        end = self.t_end
        for k, force in zip(self.kept, self.forces, strict=True):
            model.force(f"p{k}", force,
                        [(0, 0), (0.05 * end, 1), (0.2 * end, 1), (0.25 * end, 0)])
        try:
            run = simulate(model, end / STEPS, end)
        except SimulationError:
            return None
        return np.array([run[f"p{k}.position"] for k in self.kept])


def unturned(G: NDArray, amplitudes: NDArray, shapes: NDArray) -> tuple[NDArray, NDArray]:
    """In place of `internal_stresses.divide`: no mode stretches."""
    return (np.zeros((shapes.shape[1], 0)),) * 2


def errors(seed: int) -> dict[str, float]:
    """Of a body by variant, over its length."""
    slender = Slender(seed)
    exact, found = slender.path(slender.beams()), {}
    for name, options in VARIANTS.items():
        divide = unturned if name == "no internal resultants" else stiffening.divide
        with patch.object(stiffening, "divide", divide):
            path = slender.path(slender.body(**options))
        found[name] = 1.0 if path is None or exact is None else float(
            np.abs(path - exact).max() / slender.length)
    return found


def main(given: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="for programs: errors of each body")
    parser.add_argument("--first", type=int, default=0, help="seed of the first body")
    parser.add_argument("--bodies", type=int, default=BODIES)
    chosen = parser.parse_args(given)
    warnings.simplefilter("ignore")         # of limits: that is what is measured
    seeds = range(chosen.first, chosen.first + chosen.bodies)
    found = {seed: errors(seed) for seed in seeds}
    if chosen.json:
        print(json.dumps(found))
        return
    print("| shape | " + " | ".join(VARIANTS) + " |\n|---|" + "---|" * len(VARIANTS))
    for shape in (*SHAPES, "all"):
        rows = [list(one.values()) for seed, one in found.items()
                if shape in ("all", SHAPES[seed % len(SHAPES)])]
        if rows:
            cells = [f"{np.exp(np.mean(np.log(column))):.1e}, {max(column):.1e}"
                     for column in zip(*rows, strict=True)]
            print(f"| {shape} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
