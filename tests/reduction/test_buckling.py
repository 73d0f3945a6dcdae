"""Buckling of one body by tip loads and its weight, against closed forms and the FE model."""

from dataclasses import replace

import numpy as np
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.special import jv
from spinning_body import CLAMPED, SLENDER, Spinning, cantilever, strip, with_torsion

from sebody.fem import planar_beam
from sebody.reduction import craig_bampton


def critical(body, low, high, held=CLAMPED, load=None, gravity=None):
    """Factor of a load at which the lowest stiffness of the clamped body vanishes."""
    def lowest(factor):
        scaled = [None if a is None else factor * np.asarray(a, float) for a in (load, gravity)]
        K = Spinning(body, np.zeros(len(body.invariants.J0)), held).equilibrium(*scaled)[2]
        return np.linalg.eigvalsh(K)[0]
    return brentq(lowest, low, high, xtol=1e-6)


def at_tip(body, row):
    load = np.zeros(len(body.mass))
    load[row] = 1.0 if row != 3 else -1.0
    return load


def test_a_column_under_a_tip_load_and_its_weight():
    """2.4674 and 7.8373 E I / L^2; elements of second order in the normal force of the weight."""
    for modes, loads in ((4, (2.4674, 7.8373)), (0, (2.486, 7.888))):
        body = cantilever(modes=modes, elements=48)
        # axial flexibility of 1e-5; without modes, the prototype's numbers
        assert_allclose(critical(body, 2.0, 3.0, load=at_tip(body, 3)), loads[0], rtol=2e-4)
        assert_allclose(critical(body, 7.0, 9.0, gravity=[-1.0, 0, 0]), loads[1], rtol=1e-3)


def test_a_column_in_a_plane():
    flat = craig_bampton(planar_beam([0, 0], [1, 0], SLENDER, 24), {0: "full", 24: "full"}, 4)
    load = np.zeros(10)
    load[2] = -1.0
    assert_allclose(critical(flat, 2.0, 3.0, [0, 1, 4], load), np.pi**2 / 4, rtol=1e-4)


def test_lateral_buckling():
    """Thin cantilever: 4.0126 by a tip load, 12.854 by its weight; E I_y = 1000 E I_z."""
    plate = replace(SLENDER, axial=1e6, bending_y=1e3, inertia_x=2e-6, inertia_y=1e-6,
                    inertia_z=1e-6)
    body = with_torsion(plate, 24, 4, 4)
    tip = 2 * brentq(lambda x: jv(-1 / 4, x), 1.8, 2.4)
    own = 6 * brentq(lambda x: jv(-1 / 6, x), 1.8, 2.4)
    assert_allclose(critical(body, 3.5, 5.0, load=at_tip(body, 5)), tip, rtol=3e-3)
    # the weight's own moment is in the load modes; the rest is in few modes and elements
    assert_allclose(critical(body, 11.0, 15.0, gravity=[0, 0, -1.0]), own, rtol=5e-3)


def test_a_solid_buckles_as_its_fe_model_does():
    """Against linear buckling of all DOFs, with the end kept rigid by its own nodes alone."""
    model, ends = strip(0.3)
    body = craig_bampton(model, [(end, "full") for end in ends], 4)
    nodes = [list(end.nodes) for end in ends]
    tied = np.zeros((model.stiffness.shape[0], 6))
    for node in nodes[1]:
        arm = model.coordinates[node] - [40, 0, 0]
        tied[3 * node:3 * node + 3] = np.hstack([np.eye(3), -np.cross(np.eye(3), arm)])
    ties = (3 * np.concatenate(nodes)[:, None] + np.arange(3)).ravel()
    inner = np.setdiff1d(np.arange(len(tied)), ties)
    basis = np.hstack([np.eye(len(tied))[:, inner], tied])
    K = basis.T @ (model.stiffness @ basis)
    force = np.zeros(len(K))
    force[-6] = -1.0
    u = basis @ np.linalg.solve(K, force)
    KG = basis.T @ (model.geometric_stiffness(u) @ basis)
    arms = model.coordinates[nodes[1]] - [40, 0, 0]
    moments = (model.stiffness @ u).reshape(-1, 3)[nodes[1]].T @ arms
    KG[-3:, -3:] += (moments + moments.T) / 2 - np.trace(moments) * np.eye(3)
    exact = 1 / eigh(-KG, K, eigvals_only=True)[-1]
    # the reduction's bending modes: 1e-4 with four, of which two are in this plane
    found = critical(body, 0.8 * exact, 1.2 * exact, load=at_tip(body, 3))
    assert_allclose(found, exact, rtol=3e-4)
