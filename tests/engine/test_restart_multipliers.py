"""Loads that jump where forces depend on multipliers, by a kernel of a test's own."""

import numpy as np
import pytest

from sebody import Model, Simulation, Tolerance, generalized_alpha, piecewise
from sebody.assembly import batches
from sebody.compiler.sources import TEXT, folder_hash
from sebody.kernels import loader
from sebody.model.parts import Element, positions

GRIP = '''
from math import sqrt

from sebody.kernels.abi import at
from sebody.contract.layout import AT_CONSTANTS, C_CONSTRAINT, HEADER, OK, TANGENT, Part
from sebody.compiler.decorators import kernel_function

PLANAR, N_POSITIONS, N_ROTATIONS, MULTIPLIERS, WIDTH = False, 1, 0, 0, 4
CONSTANTS = (Part("mu", (), ""), Part("N0", (), ""), Part("e", (3,), ""))
INERTIAL = POWER = DRIVEN = False
READS = 0
MEMORY = ()
WORK_ROWS, OPERATIONS = 0, {"residual": (0, 0, 0, 0), "column": (0, 0, 0, 0)}
SOURCES = "HASH"


@kernel_function
def kernel(task, count, stride, width, index, constants, q, R, v, a, references, frames, T, loads,
           coefficients, forces, matrices, work, energies):
    for element in range(count):
        unknowns, g = at(index, element*stride + HEADER), at(forces, element*WIDTH)
        c = at(constants, index[element*stride + AT_CONSTANTS])
        pressure = q[unknowns[3]]
        size = sqrt(pressure*pressure + c[1]*c[1])
        g[3] = 0.0
        for i in range(3):
            g[i] = c[0]*size*c[2 + i]
        if task == TANGENT:
            J = at(matrices, element*WIDTH*WIDTH)
            for i in range(16):
                J[i] = 0.0
            for i in range(3):
                J[4*i + 3] = coefficients[C_CONSTRAINT]*c[0]*pressure/size*c[2 + i]
    return OK
'''


@pytest.mark.parametrize("how", [{"h": 0.05}, {"h": 0.0314}, {"h": 0.5, "tolerance": Tolerance(
    1e-6)}, {"h": 0.05, "scheme": generalized_alpha(index=2, tolerance=1e-11)}],
    ids=["fixed", "off the grid", "variable", "index 2"])
def test_forces_that_depend_on_multipliers(how, tmp_path, monkeypatch):
    """A weight slides down a slope with ``mu sqrt(N^2 + N0^2)`` against it, N by a multiplier.

    A pressure on it sets in at 0.5: accelerations are constant on either side, so all is exact.
    """
    text = GRIP.replace("HASH", folder_hash(*TEXT))
    (tmp_path / "element_grip.py").write_text(text)
    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path))
    monkeypatch.setattr(loader, "load", loader.load.__wrapped__)       # not remembered
    own = batches.element_unknowns

    def with_pressure(numbering, element):
        found = own(numbering, element)
        return found + [numbering.multipliers[ground]] if element.kind == "grip" else found
    monkeypatch.setattr(batches, "element_unknowns", with_pressure)
    normal, down = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, 1.0, -2.0]) / 3.0
    model, mass, mu, N0 = Model(), 2.5, 0.3, 4.0
    node = model.node("weight", (0.7, -0.4, 0.9))
    model.rigid_body("weight", node, mass, (0.1, 0.2, 0.3))
    joint = model.planar_joint(node, normal)
    ground = joint.constraints[0]
    model.gravity(9.0 * down - 5.0 * normal)
    model.force(node, -7.0 * normal, piecewise((0.0, 0.0), (0.5, 1.0)))
    model.loads.append(Element("grip", "grip", positions(node), {"mu": mu, "N0": N0, "e": down}))
    result = Simulation(model, **how).run_to(32 * 0.0314 if how["h"] == 0.0314 else 1.0).result()
    slow = [9.0 - mu * np.hypot(N, N0) / mass for N in (5.0 * mass, 5.0 * mass + 7.0)]
    t, late = result.t, np.maximum(result.t - 0.5, 0.0)
    exact = 0.5 * slow[0] * t**2 + 0.5 * (slow[1] - slow[0]) * late**2
    assert np.abs((result["weight.position"] - node.point) @ down - exact).max() < 1e-9
    pressure = np.abs(result[f"{joint.name}.multipliers"][:, 0])
    assert np.abs(pressure - np.where(t < 0.5, 5.0 * mass, 5.0 * mass + 7.0)).max() < 1e-6
