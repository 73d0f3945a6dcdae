"""Rotors of Friswell, Penny, Garvey and Lees, Dynamics of Rotating Machines, Cambridge 2010.

Against what ROSS prints of its own runs of them (petrobras/ross, docs/examples/example_05_09_*.rst
and example_05_08_01.rst have the definitions), and against matrices in NumPy.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rotor_elements import Disc, Rotor
from rotor_models import AXIS, RHO, RPM, TURNED, E, G, about_shaft

from sebody import Model
from sebody.analysis import campbell, critical_speeds, synchronous_response
from sebody.fem import circle, tube
from sebody.model.shafts import shaft_axes

ACROSS = shaft_axes(AXIS)
DISCS = Disc.of(2, 0.28, 0.07), Disc.of(4, 0.35, 0.07)


def model_of(lengths, outer, discs, bearings, inner=0.0):
    """The same rotor along a turned axis, with a soft spring along it."""
    model = Model()
    places = np.concatenate([[0.0], np.cumsum(lengths)])
    for k, place in enumerate(places):
        model.node(f"n{k}", place * AXIS)
    steel = E, E / (2 * G) - 1, RHO
    section = (tube(outer / 2, (outer - inner) / 2, *steel) if inner else
               circle(outer / 2, *steel))
    for k in range(len(lengths)):
        model.beam(f"shaft {k}", (f"n{k}", f"n{k + 1}"), section, 1, 1, 0)
    for disc in discs:
        model.rigid_body(f"disc {disc.node}", f"n{disc.node}", disc.mass,
                         about_shaft(disc.polar, disc.across))
    for node, stiffness, damping in bearings:
        ground = model.node(f"ground {node}", places[node] * AXIS)
        model.fix(ground)
        model.bushing(ground, to=f"n{node}", stiffness=stiffness, damping=damping, axis=AXIS,
                      name=f"bearing {node}")
    model.bushing(f"ground {bearings[0][0]}", to=f"n{bearings[0][0]}", stiffness=(1e3, 0, 0),
                  rotation=TURNED, name="thrust")
    return model


def ends(stiffness, damping=0.0, last=6):
    """Equal bearings at both ends."""
    return [(k, np.asarray(stiffness), damping * np.eye(2)) for k in (0, last)]


SHAFT = [0.25] * 6, 0.05, DISCS
ROTORS = {
    "5.9.1": (*SHAFT, ends(1e6 * np.eye(2))),
    "5.9.2": (*SHAFT, ends(np.diag([1e6, 0.8e6]))),
    "5.9.4": (*SHAFT, ends([[1e6, 0.5e6], [0.0, 1e6]])),
    "5.9.5": (*SHAFT, ends(1e6 * np.eye(2), 3e3)),
    "5.9.9": ([1.0, 0.5], 0.05, [Disc.of(2, 0.35, 0.07)], ends(1e7 * np.eye(2), last=1)),
    "5.8.1": ([0.2] * 6, 0.08, [Disc.of(3, 0.4, 0.08, 0.08)], ends(1e9 * np.eye(2)), 0.03),
}
# printed by ROSS: sizes of eigenvalues at a speed [rad/s]
PRINTED = {
    ("5.9.1", 0.0): (86.65811435, 86.65811435, 274.31285391, 274.31285391, 716.78631221,
                     716.78631221),
    ("5.9.1", 4000.0): (85.389467, 87.7958637, 251.78460413, 294.71333087, 600.17936195,
                        827.07536193),
    ("5.9.2", 4000.0): (82.32547398, 86.86369902, 239.64228361, 287.24958074, 583.48782916,
                        806.8872843),
    ("5.9.4", 4000.0): (84.19790045, 89.03269396, 246.44121183, 301.08623205, 594.81950178,
                        834.0420378),
    ("5.9.5", 0.0): 2 * np.pi * np.array([13.90536812, 13.90536812, 48.17762373, 48.17762373,
                                          137.06057752, 137.06057752]),
    ("5.9.5", 4000.0): 2 * np.pi * np.array([13.69730748, 14.09185971, 43.60796387, 52.17870498,
                                             122.36522778, 149.80603898]),
    ("5.9.9", 0.0): 2 * np.pi * np.array([14.34690401, 14.34690401, 109.31683436, 109.31683436,
                                          134.05186826, 134.05186826]),
}


def paired(found, wanted):
    """Found values nearest to each of the wanted ones, no one twice."""
    left, own = list(found), []
    for one in wanted:
        own.append(left.pop(int(np.argmin(np.abs(np.array(left) - one)))))
    return np.array(own)


@pytest.mark.parametrize("name, rpm", PRINTED)
def test_frequencies_that_are_printed(name, rpm):
    found = campbell(model_of(*ROTORS[name]), [rpm * RPM, rpm * RPM + 1.0], count=18, steps=1)
    sizes = np.abs(found.growth[0] + 1j * found.omega[0])
    assert_allclose(paired(sizes, PRINTED[name, rpm]), PRINTED[name, rpm], rtol=1e-6)


@pytest.mark.parametrize("name", ROTORS)
def test_frequencies_and_damping_against_matrices(name):
    """Eigenvalues at three speeds: frequencies to 1e-4, damping ratios to 1e-3 were asked for."""
    speeds = RPM * np.array([0.0, 1500.0, 4000.0])
    found = campbell(model_of(*ROTORS[name]), speeds, count=18, steps=1)
    assert found.frame == "standing"
    reference = Rotor(*ROTORS[name])
    for row, speed in enumerate(speeds):
        values, wanted = found.growth[row] + 1j * found.omega[row], reference.values(speed)[:6]
        own = paired(values, wanted)
        # double eigenvalues of a defective pair, as of cross-coupling at rest, by roots of rounding
        exact = 1e-5 if name == "5.9.4" and speed == 0.0 else 1e-7
        assert_allclose(own, wanted, atol=exact * np.abs(wanted).min())


@pytest.mark.parametrize("name", ["5.9.1", "5.9.2", "5.9.5", "5.8.1"])
def test_critical_speeds_against_matrices(name):
    exact = Rotor(*ROTORS[name]).critical_speeds(4)
    found = critical_speeds(model_of(*ROTORS[name]), fastest=1.2 * exact[-1], count=10)
    assert_allclose(paired(found.speeds, exact), exact, rtol=1e-7)


@pytest.mark.parametrize("name", ["5.9.2", "5.9.5"])
def test_responses_to_unbalance_at_twenty_speeds(name):
    """Two unbalances, all nodes, near critical speeds, too."""
    model, reference = model_of(*ROTORS[name]), Rotor(*ROTORS[name])
    pushes = [(2, 1e-3, 0.0), (4, 5e-4, 1.9)]
    for node, size, phase in pushes:
        model.unbalance(f"n{node}", size, phase)
    speeds = np.linspace(10.0, 480.0, 20)
    found = synchronous_response(model, speeds)
    for k, speed in enumerate(speeds):
        wanted = reference.response(speed, pushes)
        own = np.array([found[f"n{node}.position"][k] @ ACROSS[:, :2] for node in range(7)])
        assert_allclose(own, wanted, rtol=0, atol=1e-6 * np.abs(wanted).max())
