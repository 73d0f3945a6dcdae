"""What is said of bodies in files: numbers against closed forms, findings, repairs."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sebody import InputError
from sebody.cli.entry import main
from sebody.explore.inspection import free_rigid_motion, inspect, measures, report
from sebody.fem import hexahedral_block, rectangle, straight_beam
from sebody.io import read_body_file, save_body
from sebody.reduction import RigidFace, craig_bampton

SIZE, DENSITY = np.array([3.0, 1.0, 0.5]), 2.0
MASS = DENSITY * SIZE.prod()
MOMENTS = MASS / 12 * (SIZE @ SIZE - SIZE**2)
TURN = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [-2.0, -1.0, 2.0]]).T / 3


@pytest.fixture(scope="module")
def body():
    """A block, turned, off the origin, on its end faces."""
    model = hexahedral_block((1, 2, 3), SIZE, (4, 2, 1), 4e4, 0.25, DENSITY)
    x = model.coordinates[:, 0]
    faces = [RigidFace((place, 2.5, 3.25), np.flatnonzero(np.isclose(x, place)))
             for place in (1, 4)]
    return craig_bampton(model, [(face, "full") for face in faces], 6).rotated(TURN)


@pytest.fixture
def path(body, tmp_path):
    return save_body(body, tmp_path / "body.npz", ("left", "right"), units="m, t, kN")


def spoilt(path, **matrices):
    """The file with other matrices."""
    with np.load(path) as file:
        arrays = dict(file)
    np.savez(path, **arrays | matrices)
    return path


def test_mass_and_inertia_are_those_of_a_block(path):
    numbers = inspect(read_body_file(path)).numbers
    assert numbers["mass"] == pytest.approx(MASS, rel=1e-12)
    np.testing.assert_allclose(numbers["centre"], TURN @ (2.5, 2.5, 3.25), rtol=1e-12)
    # trilinear elements integrate x^2 of a division d too high by d^2 / 6 of it each: the mass
    # matrix is that of the interpolated rotation, which is exact
    np.testing.assert_allclose(numbers["principal_moments"], np.sort(MOMENTS), rtol=1e-10)
    order = np.argsort(MOMENTS)
    along = np.abs(numbers["principal_axes"].T @ TURN[:, order])
    np.testing.assert_allclose(along, np.eye(3), atol=1e-9)
    assert numbers["mass_geometry_defect"] < 1e-12


def test_effective_masses_of_a_beam_with_held_ends(tmp_path):
    """Of its first mode across ``(4 s / b)^2``, s = 0.982502 and b = 4.73004 of Euler's beam."""
    beam = straight_beam((1, 2, 3), TURN[:, 0] * 2.0 + (1, 2, 3), rectangle(
        0.002, 0.005, 7e10, 0.3, 2700.0), 40, up=TURN[:, 1])
    beam_body = craig_bampton(beam, [(0, "full"), (40, "full")], 3)
    for turned in (beam_body, beam_body.rotated(TURN)):
        save_body(turned, tmp_path / "beam.npz", ("a", "b"))
        found = inspect(read_body_file(tmp_path / "beam.npz"))
        first = found.numbers["clamped"]["parts"][0, :3].sum()
        assert first == pytest.approx((4 * 0.982502 / 4.73004)**2, rel=1e-3)
        assert "interfaces held, Hz      part of mass " in report(found)
    bare = craig_bampton(beam, [(0, "full"), (40, "full")], 0)
    save_body(bare, tmp_path / "bare.npz", ("a", "b"))
    assert "interfaces held" not in report(inspect(read_body_file(tmp_path / "bare.npz")))


def test_what_is_of_second_order_is_counted(path, body, tmp_path):
    kept = body.invariants.resultants
    numbers = inspect(read_body_file(path)).numbers["stiffening"]
    assert 0 < kept <= 6
    assert numbers == {"load_modes": body.invariants.slaved, "resultants": kept, "motions": 6}
    assert (f"of second order          {body.invariants.slaved} load modes, {kept} of 6 stress "
            "resultants") in report(inspect(read_body_file(path)))
    alone = save_body(replace(body, invariants=None), tmp_path / "alone.npz", ("left", "right"))
    assert inspect(read_body_file(alone)).numbers["stiffening"] == {}
    assert "of second order" not in report(inspect(read_body_file(alone)))


def test_a_good_body_can_be_used(path, body):
    found = inspect(read_body_file(path))
    assert found.usable and found.verdict == "the body can be used"
    assert found.numbers["rigid_residuals"]["largest"] < 1e-12
    np.testing.assert_allclose(found.numbers["frame"]["weights"], [0.5, 0.5], atol=1e-12)
    highest = found.numbers["frequencies"]["highest"]
    assert found.numbers["frequencies"]["step_highest"] == pytest.approx(1 / (6 * highest))


def test_defects_are_named_with_remedies(path, body):
    support = np.zeros_like(body.stiffness)
    support[1, 1] = body.stiffness[1, 1]
    cases = {
        "the stiffness resists rigid motion": {"stiffness": body.stiffness + support},
        "stiffness is not symmetric": {"stiffness": np.triu(body.stiffness)},
        "the mass matrix is indefinite": {"mass": body.mass - 0.3 * np.diag(np.diag(body.mass))},
        "the mass is -3": {"mass": -body.mass},
        "the stiffness has the negative eigenvalue": {"stiffness": -body.stiffness},
        "R^T M R is off by": {"mass": body.mass + support / 1e4},
    }
    for said, matrices in cases.items():
        found = inspect(read_body_file(spoilt(path, **{"stiffness": body.stiffness,
                                                       "mass": body.mass} | matrices)))
        texts = [one.text for one in found.findings if one.severity == "defect"]
        assert any(said in text for text in texts), (said, texts)
        assert not found.usable and "cannot be used" in found.verdict
        assert all(one.remedy for one in found.findings)


def rounded(matrix, digits):
    return np.array([[float(f"{x:.{digits - 1}e}") for x in row] for row in matrix])


def test_lost_digits_are_repaired_and_what_is_lost_is_said(path, body):
    few = rounded(body.stiffness, 4)
    few = (few + few.T) / 2
    file = read_body_file(spoilt(path, stiffness=few))
    assert not inspect(file).usable
    repaired, said = free_rigid_motion(file)
    assert inspect(repaired).usable
    assert "not repaired: errors of the same size" in said[-2]
    before, after, right = (inspect(one).numbers["frequencies"]["flexible"][0]
                            for one in (file, repaired, read_body_file(
                                spoilt(path, stiffness=body.stiffness))))
    assert abs(after - right) < 0.01 * right        # four digits
    assert "left out: the stress resultants of stiffening" in said[-1]
    assert repaired.body().invariants.slaved == body.invariants.slaved


def test_constants_of_another_body_are_a_defect(path, body):
    softer = inspect(read_body_file(spoilt(path, stiffness=0.9 * body.stiffness)))
    text, = [one.text for one in softer.findings if one.severity == "defect"]
    assert text.startswith("invariants.lam and E give more stiffness than the body has")


def test_a_support_is_not_repaired(path, body):
    support = body.stiffness + np.diag(np.diag(body.stiffness))
    with pytest.raises(InputError, match="this is not a loss of digits; remove supports from"):
        free_rigid_motion(read_body_file(spoilt(path, stiffness=support)))


def test_massless_coordinates_have_frequencies(path, body):
    """The inverse problem: frequencies of what has mass."""
    model = hexahedral_block((0, 0, 0), (2, 1, 1), (2, 1, 1), 1e4, 0.25, DENSITY)
    corners = craig_bampton(model, dict.fromkeys(range(4), "translation"), 0)
    mass = corners.mass.copy()
    mass[0], mass[:, 0] = 0.0, 0.0
    file = read_body_file(save_body(corners, path))
    file.parts["mass"] = mass
    inspection = inspect(file)
    assert any("the mass matrix is singular, mostly in position x of " in one.text
               for one in inspection.findings)
    found = inspection.numbers["frequencies"]
    assert found["count"] == len(mass) - 1 - 6
    assert np.isfinite(found["flexible"]).all() and (found["flexible"] > 0).all()


def test_the_command(path, tmp_path, capsys, body):
    picture = tmp_path / "body.png"
    assert main(["inspect", str(path), "--output", str(picture)]) == 0
    said = capsys.readouterr().out
    assert picture.stat().st_size > 5_000
    assert "mass                     3\n" in said and "left keeps full" in said
    assert "verdict: the body can be used" in said
    assert main(["inspect", str(path), "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    assert numbers["mass"] == pytest.approx(MASS)
    assert (numbers["usable"], numbers["layout"]["names"]) == (True, ["left", "right"])


def test_the_command_repairs(path, tmp_path, capsys, body):
    few = rounded(body.stiffness, 4)
    spoilt(path, stiffness=(few + few.T) / 2)
    assert main(["inspect", str(path)]) == 1
    assert "defect: the stiffness resists rigid motion" in capsys.readouterr().out
    good = tmp_path / "good.npz"
    assert main(["inspect", str(path), "--repair", "rigid-modes", "--save", str(good)]) == 0
    assert "rigid motion projected" in capsys.readouterr().out
    assert main(["inspect", str(good)]) == 0
    assert main(["inspect", str(path), "--save", str(good)]) == 2
    assert "--repair and --save belong together" in capsys.readouterr().err


def picture_of(body, folder, recovery=True):
    """The picture that the command draws, (height, width, 3), from 0 to 1."""
    from matplotlib.image import imread

    path = folder / "drawn.npz"
    save_body(body, path, units="mm t N s", recovery=recovery)
    assert main(["inspect", str(path), "--output", str(folder / "drawn.png")]) == 0
    return imread(folder / "drawn.png")[..., :3]


def at(place):
    """A bar of bricks on its end faces, somewhere."""
    model = hexahedral_block(place, (60, 8, 12), (10, 1, 2), 2.1e5, 0.3, 7.85e-9)
    x = model.coordinates[:, 0] - place[0]
    middle = np.add(place, [0, 4, 6])
    faces = [RigidFace(middle + [there, 0, 0], np.flatnonzero(np.isclose(x, there)))
             for there in (0, 60)]
    return craig_bampton(model, [(face, "full") for face in faces], 4)


def test_the_picture_shows_the_whole_body_wherever_it_is(tmp_path, capsys):
    """Limits are those of the mesh: the picture of a body far off is that of the same body."""
    near, far = (picture_of(at(place), tmp_path) for place in ((0, 0, 0), (1e4, -3e3, 2e4)))
    assert near.shape == far.shape
    assert np.mean(np.abs(near - far).max(axis=2) > 0.1) < 2e-3     # edges by a pixel
    coloured = near.min(axis=2) < 0.9
    top = coloured[:int(0.44 * len(near))]
    assert 0.08 < top.mean() < 0.6
    columns = np.flatnonzero(top.any(axis=0))
    assert columns[0] > 5 and columns[-1] < len(top[0]) - 5     # nothing is cut
    # small multiples: six free vibrations in two rows, each with its colours and its frequency
    below = near[int(0.45 * len(near)):]
    for part in np.array_split(below[:int(0.86 * len(below))], 2):
        for one in np.array_split(part, 3, axis=1):
            spread = one.max(axis=2) - one.min(axis=2)
            assert np.mean(spread > 0.2) > 0.02


def test_a_body_without_a_mesh_is_lines(tmp_path, capsys):
    drawn = picture_of(at((5, 5, 5)), tmp_path, recovery=False)
    assert 1e-3 < np.mean(drawn.min(axis=2) < 0.9) < 0.2


def test_modes_of_the_picture_are_the_frequencies(path, body):
    found = inspect(read_body_file(path))
    hertz, shapes = measures.free_modes(found.body, 5)
    np.testing.assert_allclose(hertz, found.numbers["frequencies"]["flexible"][:5], rtol=1e-6)
    forces = body.stiffness @ shapes
    np.testing.assert_allclose(body.mass @ shapes * (2 * np.pi * hertz)**2, forces,
                               atol=1e-6 * np.abs(forces).max())
