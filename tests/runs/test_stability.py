"""Stability of equilibria: buckled columns, snapping trusses, portals, words about what is free."""

import warnings

import numpy as np
import pytest
from elastica import deflection
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from sebody import InputError, LimitWarning, Model, SimulationError
from sebody.analysis import equilibrium, vibrations
from sebody.fem import circle
from sebody.runs import settling
from sebody.scenes import pole_on_cart

ACROSS = 1e4            # stiffness that holds a truss in its plane
TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()


def column(slenderness, share, side, bodies=4, units=1.0):
    """A turned cantilever of length one under a share of Euler's load, and a side load of it."""
    section = circle(2.0 / slenderness, 7e10 * units, 0.3, 2700.0)
    euler = np.pi**2 * 7e10 * units * section.inertia_z / 4.0
    model = Model()
    foot, tip = model.node("foot", (3.0, -1.0, 2.0)), model.node("tip", TURN[:, 0] + (3., -1., 2.))
    model.fix(foot)
    model.beam("column", (foot, tip), section, 16, bodies, 0 if bodies == 16 else 4, up=TURN[:, 2])
    model.force(tip, -share * euler * TURN[:, 0])
    if side:
        model.force(tip, side * share * euler * TURN[:, 1])
    return model


def aside(result):
    """Deflection of the tip across the column."""
    moved = (result["tip.position"][-1] - (3.0, -1.0, 2.0)) @ TURN
    return np.hypot(moved[1], moved[2])


@pytest.mark.parametrize(("slenderness", "share", "side", "bodies", "units"), [
    (100, 0.95, 1e-2, 4, 1.0), (400, 0.95, 1e-2, 4, 1e-6), (4000, 0.95, 1e-2, 4, 1.0),
    (1000, 1.3, 1e-4, 8, 1.0), (4000, 2.0, 1e-3, 16, 1.0)])
def test_columns_deflect_as_the_elastica(slenderness, share, side, bodies, units):
    """Below Euler's load and above, at any slenderness, with a lowest mode that is stable."""
    result = equilibrium(column(slenderness, share, side, bodies, units))
    assert aside(result) == pytest.approx(deflection(share, side), rel=1e-2)
    assert result.stability.startswith("stable")
    assert vibrations(result, 1).omega[0] > 0.0


@pytest.mark.parametrize("side", [0.0, 1e-6])
def test_a_straight_column_above_its_load_buckles_or_is_kept(side):
    """Left for the buckled state at the share that Euler's load is; kept with a warning."""
    model = column(1000, 1.25, side)
    result = equilibrium(model)
    assert aside(result) == pytest.approx(deflection(1.25, 1e-8), rel=1e-2)
    found, *said = result.stability.split("; ")
    assert found == "stable"
    if not side:
        text = said[0]
        assert text.startswith("left an unstable state at ")
        assert 0.8 <= float(text.split()[5]) < 0.8 + 1.0 / 64
        assert f"stability            {result.stability}" in result.summary()
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        kept = equilibrium(model, unstable="keep")
    if not side:
        assert aside(kept) < 1e-9
        assert kept.stability.startswith("unstable; unstable from 0.8")
        assert kept.warnings and "a disturbance lets it move away" in kept.warnings[-1]
        assert any(w.category is LimitWarning for w in given)
        with pytest.raises(InputError, match="the state is not stable"):
            vibrations(kept, 1)


def truss(force, turn=TURN):
    """Von Mises's truss of two springs, and the height of its tip by a force down on it."""
    model, height = Model(), 0.2
    for name, x in (("left", -1.0), ("right", 1.0)):
        model.fix(model.node(name, turn @ (x, 0.0, 0.0), keeps="translation"), "position")
    tip = model.node("tip", turn @ (0.0, 0.0, height), keeps="translation")
    model.point_mass("tip", tip, 1.0)
    stiffness = 1e5 / np.hypot(1.0, height)
    for name in ("left", "right"):
        model.spring("tip", name, stiffness)
    for name, y in (("near", -5.0), ("far", 5.0)):
        model.fix(model.node(name, turn @ (0.0, y, 0.0), keeps="translation"), "position")
        model.spring("tip", name, ACROSS)
    model.force(tip, -force * turn[:, 2])
    return model


def resistance(y, height=0.2):
    """Force down at which the tip is at y."""
    long, now, across = np.hypot(1.0, height), np.hypot(1.0, y), 5.0
    side = 2.0 * ACROSS * (np.hypot(across, y) - np.hypot(across, height)) * y / np.hypot(across, y)
    return 2e5 / long * (long - now) * y / now - side


def test_a_truss_snaps_at_its_limit_load():
    """On the first branch to 0.99 of the limit; beyond it, on the one that hangs through."""
    places = np.linspace(0.0, 0.2, 2001)
    limit = resistance(places).max()
    for share in (0.99, 1.01):
        result = equilibrium(truss(share * limit))
        found = (result["tip.position"][-1] @ TURN)[2]
        start = places[resistance(places).argmax()] if share < 1.0 else -0.2
        exact = brentq(lambda y, f=share * limit: resistance(y) - f, *(
            (start, 0.2) if share < 1.0 else (-0.9, start)))
        assert found == pytest.approx(exact, abs=1e-4)
        assert ("between 0.98" in result.stability) == (share > 1.0)
    with pytest.raises(SimulationError, match=r"above 0\.98.* of the load: the structure buckles "
                       "or snaps, mostly at tip.position, and settles in no stable state nearby; "
                       "unstable='leave' lets it move on"):
        equilibrium(truss(1.01 * limit), unstable="keep")


def test_a_portal_leaves_its_plane():
    """It sways across its plane at a quarter of the load that it was found in its plane at."""
    section = circle(0.005, 7e10, 0.3, 2700.0)
    euler = np.pi**2 * 7e10 * section.inertia_z
    model = Model()
    nodes = [model.node(name, TURN @ x) for name, x in zip("abcd", np.array(
        [(0.0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)]), strict=True)]
    for k in range(3):
        model.beam(f"beam {k}", nodes[k:k + 2], section, 4, 2, 3, up=TURN[:, 1])
    model.fix("a")
    model.fix("d")
    for name in "bc":
        model.force(name, -0.4 * euler * TURN[:, 2])
    model.force("b", 0.004 * euler * TURN[:, 0])
    result = equilibrium(model, 8)
    side = np.array([result[f"{name}.position"][-1] @ TURN for name in "bc"])[:, 1]
    assert abs(side).min() > 0.3 and abs(np.ptp(side)) < 0.1
    share = float(result.stability.split("unstable state at ")[1].split()[0])
    assert result.stability.startswith("stable") and 0.25 / 0.4 < share < 0.27 / 0.4
    assert vibrations(result, 1).omega[0] > 0.0


def test_a_pole_on_a_cart_hangs_or_the_search_for_that_ends(monkeypatch):
    """It stands upright as it is built, and hangs after half a turn."""
    result = equilibrium(pole_on_cart.pole(), 1)
    assert result.stability.startswith("stable")
    hangs = result["top.position"][-1] - result["foot.position"][-1]
    assert hangs == pytest.approx([0.0, -1.0], abs=1e-3)        # its own weight stretches it
    monkeypatch.setattr(settling, "SEARCHES", 60)
    monkeypatch.setattr(settling, "FEW", 0)
    with pytest.warns(LimitWarning, match="is unstable .* on, where 6[0-9] iterations found none"):
        result = equilibrium(pole_on_cart.pole(), 1)
    assert result["top.position"][-1] == pytest.approx([0.0, 1.0], abs=1e-3)


def test_nothing_is_said_of_loads_that_follow():
    """Beck's column is stable beyond Euler's load, and has no potential."""
    model = column(400, 0.0, 0.0)
    model.force("tip", (-1.0, 0.0, 0.0), follower=True)
    assert equilibrium(model, 2).stability.startswith("not judged, as loads follow")
    assert equilibrium(column(400, 0.1, 0.0), 2, spin=(0.0, 0.0, 1e-3)).stability == (
        "not judged, as the frame rotates")
    with pytest.raises(InputError, match="unstable 'go' is unknown: use 'leave' or 'keep'"):
        equilibrium(model, unstable="go")


def test_stability_is_saved(tmp_path):
    """In files of results, too."""
    from sebody import Result
    result = equilibrium(column(400, 0.5, 1e-2), 2)
    path = result.save(tmp_path / "found.npz")
    assert Result.load(path).stability == result.stability == "stable"
    assert_allclose(Result.load(path).rows, result.rows)
