"""Blades of BeamDyn's files: axes and signs against published digits, refusals by line and station.
"""

import re

import beamdyn_files as files
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from sebody import InputError, Model
from sebody.analysis import equilibrium
from sebody.cli.entry import main
from sebody.io import load_body, read_beamdyn

CYCLIC = [1, 2, 0]      # BeamDyn's x, y, z of x along the beam, y, z


def in_beamdyns_order(diagonal):
    """K of x along the beam as of z along the beam, where tension stands third."""
    six = np.diag(diagonal)
    order = [*CYCLIC, *(3 + k for k in CYCLIC)]
    return six[np.ix_(order, order)]


def tip(blade, force, elements):
    model = Model()
    root, end = (model.node(name, blade.axis.position(place))
                 for name, place in (("root", 0.0), ("tip", 1.0)))
    model.beam("blade", (root, end), blade.section, elements, axis=blade.axis)
    model.fix(root)
    model.force(end, force)
    return equilibrium(model, steps=4)["tip.position"][-1] - end.point


def test_the_sign_of_the_twist_is_that_of_published_digits(tmp_path):
    """BeamDyn's static twisted beam, +90 degrees at the tip: r-test bd_static_twisted_with_k1."""
    K = in_beamdyns_order([2.5e10, 8.2604167e9, 8.2604167e9, 1.41872656e8, 5.20833e8, 1.30208333e8])
    path = files.write(tmp_path, twist=(0.0, 45.0, 90.0), places=(0, 1), stiffness=[K, K],
                       masses=[np.eye(6) * 2000.0] * 2)
    blade = read_beamdyn(path)
    coarse, fine = (tip(blade, (0, -4e6, 0), count) for count in (8, 16))
    assert_allclose((4 * fine - coarse) / 3,
                    [1.71805334646388, -3.59321324026952, -1.14152599953942], rtol=0,
                    atol=1e-4)      # of fourth order


def test_three_key_points_are_a_parabola(tmp_path):
    """BeamDyn's curved beam in its axes, of which 4 digits need the parabola, not an arc."""
    x = np.array([0, 38.2683, 70.7107])
    points = np.column_stack([[0, -7.61205, -29.2893], 0 * x, x])
    K = in_beamdyns_order([1e7, 41.6667e5, 41.6667e5, 8.333e5, 8.333e5, 8.333e5])
    blade = read_beamdyn(files.write(tmp_path, points, (0, 0, 0), (0, 1), [K, K],
                                     [np.eye(6)] * 2))
    coarse, fine = (tip(blade, (0, 600.0, 0), count) for count in (8, 16))
    exact = np.array([-23.6459716009047, 13.7208006040058, 53.5776450626987])[CYCLIC]
    assert_allclose((4 * fine - coarse) / 3, exact, rtol=0, atol=1e-3)


def test_sections_axes_and_mass_of_a_blade(tmp_path):
    """A uniform blade without twist: entries find their places, the mass its offset."""
    blade = read_beamdyn(files.write(tmp_path, twist=(0, 0, 0), places=(0, 1),
                                     stiffness=[files.K] * 2, masses=[files.mass()] * 2))
    one = blade.section(0.3)
    assert_allclose(one.stiffness[0, 0], 9e9)           # Fz
    assert_allclose([one.stiffness[0, 4], one.stiffness[3, 4]], [4e8, -2e8])    # with Mx
    R = blade.axis.axes(0.5)
    assert_allclose(R, np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]).astype(float), atol=1e-15)
    model = blade.fe_model(4)
    rigid = np.zeros((len(model.coordinates), 6, 3))
    for k in range(3):
        rigid[:, :3, k] = np.cross(np.eye(3)[k], model.coordinates)
        rigid[:, 3 + k, k] = 1.0
    rigid = rigid.reshape(-1, 3)
    shift = np.tile(np.eye(6, 3), (len(model.coordinates), 1))
    m = files.MASS * 10.0
    assert_allclose(shift.T @ model.mass @ shift, m * np.eye(3), rtol=0, atol=1e-10 * m)
    x, y = files.CENTRE
    centre = np.array([[0, 5.0, -y], [-5.0, 0, x], [y, -x, 0]])     # m v of unit spins
    assert_allclose(shift.T @ model.mass @ rigid, m * centre, rtol=0, atol=1e-10 * m)
    assert_allclose(blade.mass, m, rtol=1e-12)
    assert not blade.cautions
    assert repr(blade) == "<Blade of 2 stations, 10 long, mass 3000>"


def test_places_are_parts_of_the_length_and_members_meet(tmp_path):
    """Two members that meet at an angle: stations by arc length, the twist at key points."""
    points = [(0, 0, 0), (0.0, 0, 3.0), (0.0, 0, 6.0), (-3.0, 0, 10.0)]
    blade = read_beamdyn(files.write(tmp_path, points, (9.0, 9.0, 3.0, 0.0), members=[3, 2]))
    assert_allclose(blade.axis.length, 11.0, rtol=1e-12)
    assert_allclose(blade.axis.position(6 / 11), (0, 0, 6.0), atol=1e-9)
    assert_allclose(blade.axis.tangent(np.array([0.5, 0.6])), [(0, 0, 1), (-0.6, 0, 0.8)],
                    atol=1e-12)
    angle = np.arctan2(*blade.axis.axes(4.5 / 11)[[1, 0], 1])
    assert_allclose(angle, -np.radians(6.0), rtol=1e-9)


def test_damping_is_that_of_mu_in_beamdyns_order(tmp_path):
    mu = np.array([0.001, 0.0015, 0.0012, 0.0022, 0.0014, 0.0025])
    blade = read_beamdyn(files.write(tmp_path, mu=mu))
    one = blade.section(0.0)
    assert_allclose(one.damping[0, 0], 0.0012 * 9e9)            # tension is BeamDyn's third
    assert_allclose(one.damping[0, 4], np.sqrt(0.0012 * 0.0022) * 4e8)
    model = blade.fe_model(4)
    w, v = eigh(model.stiffness.toarray()[6:, 6:], model.mass.toarray()[6:, 6:])
    ratios = np.einsum("ia,ij,ja->a", v, model.damping.toarray()[6:, 6:], v)[:2] / np.sqrt(w[:2])/2
    assert (0.5 * 0.0014 * np.sqrt(w[:2]) * 0.7 < ratios).all()
    assert (ratios < 0.5 * 0.0025 * np.sqrt(w[:2])).all()


def test_a_command_writes_bodies_that_can_be_inspected(tmp_path, capsys):
    path = files.write(tmp_path, mu=0.001)
    out = tmp_path / "body.npz"
    assert main(["blade", str(path), "--bodies", "3", "--modes", "2", "--output", str(out)]) == 0
    said = capsys.readouterr().out
    assert "blade: BeamDyn primary.dat and blade.dat, 3 stations, 10 m, 1950 kg" in said, said
    assert said.count("body: ") == 3
    bodies = [load_body(tmp_path / f"body-{k}.npz") for k in (1, 2, 3)]
    assert_allclose(sum(body.total_mass for body in bodies), 1950.0, rtol=1e-6)
    assert all(body.modes == 2 and body.units == "m kg N s" for body in bodies)
    assert bodies[0].damping is not None and bodies[0].recovery.stress[0].flexibility is not None
    assert main(["inspect", str(tmp_path / "body-2.npz")]) == 0
    assert "verdict: the body can be used" in capsys.readouterr().out
    names = [str(tmp_path / f"{name}.npz") for name in "ab"]
    two = "--bodies", "2", "--divide", "length", "--output"
    assert main(["blade", str(path), *two, *names]) == 0
    assert_allclose(load_body(names[0]).coordinates[1], (0, 0, 5.0), atol=1e-12)
    assert main(["blade", str(path), "--bodies", "3", "--output", *names]) == 2
    assert "--output names 2 files and there are 3 bodies" in capsys.readouterr().err
    assert main(["blade", str(path), "--divide", "twist", "--output", names[0]]) == 2
    assert "give 'length', 'rotation' or places" in capsys.readouterr().err


def changed(path, old, new, count=1):
    """A file with something else in it."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, count))


def station(k, K=None, M=None):
    """Files of three stations, one of which is another."""
    def write(folder):
        stiffness = [files.K * s for s in (1, 0.6, 0.2)]
        masses = [files.mass() * s for s in (1, 0.6, 0.3)]
        if K is not None:
            stiffness[k] = K
        if M is not None:
            masses[k] = M
        return files.write(folder, stiffness=stiffness, masses=masses)
    return write


def edited(file, old, new):
    """The usual files, of which one has been edited."""
    def write(folder):
        path = files.write(folder)
        changed(folder / file, old, new)
        return path
    return write


ASYMMETRIC = files.K + 5e8 * np.eye(6, k=1)
INDEFINITE = files.K.copy()
INDEFINITE[3, 5] = INDEFINITE[5, 3] = 5e9
IN_MM = np.diag([1, 1, 1, 1e3, 1e3, 1e3])


@pytest.mark.parametrize(("write", "said"), [
    (station(1, K=ASYMMETRIC), r"blade.dat, station 2 \(line 26, eta 0.5\): stiffness\[\d, \d\] is "
     r".* \(\w\w and \w\w\): the matrix must be symmetric"),
    (station(2, K=INDEFINITE), r"station 3 \(line 41, eta 1\): stiffness is not positive definite: "
     "some strain of Mx and My has the energy"),
    (station(1, M=files.mass() + np.eye(6)[[0, 1, 2, 3, 4, 5]] * [9, 0, 0, 0, 0, 0]),
     r"station 2 \(line 26, eta 0.5\): mass\[\w+, \w+\] is .* where a mass of"),
    (station(0, K=IN_MM @ files.K @ IN_MM), r"station 1 .*: mixed units: sqrt\(EI/EA\) is 943"),
    (station(2, K=files.K * 1e-4), r"station 3 .*: mixed units: EA is 9e\+05 after 5.4e\+09"),
    (lambda folder: files.write(folder, points=np.outer([0, 5e-3, 1e-2], [0, 0, 1])),
     "more than the length 0.01 of the key points"),
    (edited("primary.dat", "kp_total", "kp_number"), "primary.dat has no kp_total: give the prim"),
    (edited("primary.dat", " 3   kp_total", " x   kp_total"), "line 9: kp_total is x: give a w"),
    (edited("primary.dat", " 3   kp_total", " 4   kp_total"), "line 10: the members have .3. key"),
    (edited("primary.dat", " 3   kp_total", " 2   kp_total"), "line 9: .* three key points"),
    (edited("primary.dat", "  5.0000000000E+00\n", "\n"), "line 14: a key point has 3 numbers"),
    (edited("primary.dat", '"blade.dat"', '"wing.dat"'), "line 19: BldFile \"wing.dat\" is not"),
    (edited("blade.dat", "DISTRIBUTED", "OTHER"), "has no DISTRIBUTED PROPERTIES"),
    (edited("blade.dat", "3   station_total", "4   station_total"), "ends within station 4 of 4"),
    (edited("blade.dat", " 0   damp_type", " 2   damp_type"), "line 5: damp_type is 2: damping"),
    (edited("blade.dat", "  0.50000000", "  1.50000000"), "the one of station 3 is 1: give two"),
    (edited("blade.dat", "  0.00000000", "  0.10000000"), "places from 0.1 to 1"),
    (edited("blade.dat", " 6.0000000000E+08 ", " "), r"line 12: station 1 has 5 numbers here"),
    (lambda folder: files.write(folder, points=[(0, 0, 0), (0, 0, 5), (0, 0, 4.0)]),
     "kp_zr of key point 3 is 4 after 5: z ascends"),
    (lambda folder: files.write(folder, mu=-0.001), r"line 9: mu is \[-0.001, .*not negative"),
    (lambda folder: folder / "none.dat", "BeamDyn file .*none.dat does not exist"),
    (lambda folder: folder, "is a folder: give the path of a file"),
])
def test_files_that_are_refused(tmp_path, write, said):
    with pytest.raises(InputError) as caught:
        read_beamdyn(write(tmp_path))
    assert re.search(said, str(caught.value)), str(caught.value)


@pytest.mark.parametrize(("twist", "said"), [
    ((-12.0, -5.0, 1.0), "12 degrees at the root|counts about minus z.*check its sign"),
    ((0.21, 0.1, -0.02), "at most 0.21 degrees; BeamDyn has degrees, check that these are not rad"),
])
def test_a_twist_that_is_doubtful(tmp_path, twist, said, capsys):
    path = files.write(tmp_path, twist=twist)
    assert re.search(said, read_beamdyn(path).cautions[0])
    assert main(["blade", str(path), "--modes", "1", "--output", str(tmp_path / "a.npz")]) == 0
    assert "caution: primary.dat: the twist is" in capsys.readouterr().out


def test_sections_without_a_solids_speed_of_sound(tmp_path):
    path = files.write(tmp_path, stiffness=[files.K * 1e6] * 3)
    assert "speed of sound" in read_beamdyn(path).cautions[0]
