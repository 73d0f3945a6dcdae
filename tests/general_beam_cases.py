"""Beams with published digits: axis, section, force at the tip, its displacement."""

import numpy as np

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import Axis, GeneralSection

LINE = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]


def composite():
    """Straight, bending and torsion coupled: kynema's static_composite_beam_bending."""
    K = np.diag([1368.17, 88.56, 38.78, 16.96, 59.12, 141.47]) * 1e3
    for i, j, value in ((3, 4, 17.61e3), (3, 5, -0.351e3), (4, 5, -0.37e3)):
        K[i, j] = K[j, i] = value
    M = np.diag([8.538e-2] * 3 + [1.4433e-2, 0.4097e-2, 1.0336e-2])
    return (Axis(LINE), GeneralSection(K, M), (0, 0, 150.0),
            (-0.0902726627566299, -0.0647488486259036, 1.22973648292371))


def twisted():
    """A quarter of a turn of a flat section: kynema's static_twisted_composite_beam_bending."""
    K = np.diag([2.5e10, 8.2604167e9, 8.2604167e9, 1.41872656e8, 5.20833e8, 1.30208333e8])
    return (Axis(LINE, twist=[[0, 0], [1, np.pi / 2]]), GeneralSection(K, np.eye(6)),
            (0, 0, -4e6), (-1.14152599953942, -1.71805334646388, -3.59321324026952))


def curved():
    """A parabola through three points: kynema's static_curved_composite_beam_bending."""
    x, y = np.array([38.2683, 70.7107]), np.array([-7.61205, -29.2893])
    slope, bend = np.linalg.solve(np.column_stack([x, x**2]), y)
    K = np.diag([1e7, 41.6667e5, 41.6667e5, 8.333e5, 8.333e5, 8.333e5])
    return (Axis(lambda s: [x[1] * s, (slope + bend * x[1] * s) * x[1] * s, 0.0]),
            GeneralSection(K, np.eye(6)), (0, 0, 600.0),
            (-23.6459716009047, 13.7208006040058, 53.5776450626987))


def curved_of_chrono():
    """An arc of 45 degrees, whose curvature couples tension and bending."""
    K = np.diag([1e7, 41.6667e5, 41.6667e5, 7.03e5, 8.333333e5, 8.333333e5])
    K[0, 5] = K[5, 0] = -8.333333e3
    return (Axis(lambda s: [100 * np.sin(np.pi / 4 * s), 100 * (np.cos(np.pi / 4 * s) - 1), 0.0]),
            GeneralSection(K, np.eye(6)), (0, 0, 600.0), (-23.821, 13.732, 53.610))


CASES = {"composite": composite, "twisted": twisted, "curved": curved}


def cantilever(case, elements, bodies=None, modes=0, turn=None, **options):
    """Model, and its last node."""
    axis, section, force = case[:3]
    R = np.eye(3) if turn is None else turn
    model = Model()
    root = model.node("root", R @ axis.position(0.0) + (0.0 if turn is None else [1.0, 2.0, 3.0]))
    tip = model.node("tip", root.point + R @ (axis.position(1.0) - axis.position(0.0)))
    if turn is not None:
        options["rotation"] = R
    model.beam("beam", (root, tip), section, elements, bodies, modes, axis=axis, **options)
    model.fix(root)
    model.force(tip, R @ force)
    return model, tip


def moved(case, *arguments, **options):
    """Displacement of the tip at rest."""
    model, tip = cantilever(case, *arguments, **options)
    return equilibrium(model, steps=5)["tip.position"][-1] - tip.point


def error(u, case):
    """Difference from the published displacement, relative to it."""
    return np.linalg.norm(u - np.array(case[3])) / np.linalg.norm(case[3])
