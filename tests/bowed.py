"""Slender beams with a bow across both principal axes of the section, as one body and as beams."""

import numpy as np
from numpy.typing import NDArray
from struck_frames import TURN

from sebody import Model, simulate
from sebody.fem import Section, frame
from sebody.reduction import ReducedBody, craig_bampton

# radii of gyration of 2.8 and 1.7 mm, a length of 2 m
SECTION = Section(area=1e-4, inertia_y=8e-10, inertia_z=3e-10, torsion=9e-10,
                  youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)
MEMBERS = 8


def bowed(rise: float) -> NDArray:
    """Points of a bow, (MEMBERS + 1, 3)."""
    x = np.linspace(-1, 1, MEMBERS + 1)
    return np.column_stack([x, 0.8 * rise * (1 - x**2), 0.6 * rise * (1 - x**2)]) @ TURN.T


def whole(points: NDArray, modes: int) -> ReducedBody:
    """The members between the points as one body."""
    model = frame(points, [(k, k + 1) for k in range(len(points) - 1)], SECTION, 2)
    return craig_bampton(model, {0: "full", len(points) - 1: "full"}, modes)


def divided(points: NDArray, parts: int, modes: int) -> Model:
    """As so many bodies, which have so many modes together."""
    model, width = Model(), MEMBERS // parts
    nodes = [model.node(f"p{k}", points[k]) for k in range(0, MEMBERS + 1, width)]
    for part in range(parts):
        own = points[part * width:(part + 1) * width + 1]
        model.superelement(f"part {part}", whole(own, modes // parts), nodes[part:part + 2])
    return model


def beams(points: NDArray) -> Model:
    """As nonlinear beams."""
    model = Model()
    nodes = [model.node(f"p{k}", point) for k, point in enumerate(points)]
    for k in range(MEMBERS):
        model.beam(f"beam {k}", (nodes[k], nodes[k + 1]), SECTION, 2)
    return model


def path(model: Model, points: NDArray, h: float) -> tuple[NDArray, int]:
    """Of the ends, struck to bend 50 mm, at twenty times; and how many steps were rejected."""
    forces = np.random.default_rng(3).normal(size=(2, 3))
    model.rigid_velocity((0.3, -0.2, 0.1), (1.0, -2.0, 12.0), points.mean(axis=0))
    for name, force in zip(("p0", f"p{MEMBERS}"), forces, strict=True):
        model.force(name, 8 * force / np.linalg.norm(force),
                    [(0, 0), (0.002, 1), (0.008, 1), (0.01, 0)])
    run = simulate(model, h, 0.04)
    each = round(0.002 / h)
    return np.array([run["p0.position"], run[f"p{MEMBERS}.position"]])[:, ::each], run.cuts
