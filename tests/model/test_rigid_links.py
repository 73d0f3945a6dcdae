"""Any links of a mechanism may be rigid: a loop that rigid links close is kept by equations."""

from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, generalized_alpha, simulate
from sebody.fem import Section, planar_beam, straight_beam
from sebody.model.variants import rigid
from sebody.reduction import craig_bampton

H, STEPS = 0.002, 50
TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
START = np.array([3.0, -2.0, 1.0])
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
EXACT = generalized_alpha(tolerance=1e-12)
# of the motion: steps are those of other coordinates, whose errors differ
STEP_ERROR = 2e-5
LINKS = {"crank": ((0, 0), (5, 30)), "coupler": ((5, 30), (70, 50)), "rocker": ((70, 50), (80, 0))}


def at(planar: bool, x: float, y: float) -> np.ndarray:
    return START[:2] + (x, y) if planar else START + TURN @ (x, y, 0)


def flexible(model: Model, name: str, nodes: list[str]) -> None:
    fe_model = (planar_beam if model.planar else straight_beam)(
        *(model.nodes[node].point for node in nodes), SECTION, 4)
    model.superelement(name, craig_bampton(fe_model, [(0, "full"), (4, "full")], 2), nodes)


def by_hand(model: Model, name: str, nodes: list[str]) -> None:
    """A rigid rod with rotary inertia, its last node at the end of a link."""
    first, last = (model.nodes[node].point for node in nodes[:1] * 2)
    last = at(model.planar, *LINKS[name][1])
    length = np.linalg.norm(last - first)
    mass, rotary = SECTION.density * SECTION.area * length, SECTION.density * 6.75 * length
    across = rotary + mass * length**2 / 12
    axis = (last - first) / length
    inertia = across if model.planar else across * np.eye(3) + (
        2 * rotary - across) * np.outer(axis, axis)
    model.rigid_body(name, nodes[0], mass, inertia, (first + last) / 2)
    model.attach(nodes[1], last, nodes[0])


def four_bar(stiff: tuple[str, ...], planar: bool) -> Model:
    """Three links and the ground; those in `stiff` are rigid, joined by equations throughout."""
    model, axis = Model(planar=planar), {} if planar else {"axis": TURN @ (0, 0, 1)}
    for name, (first, last) in LINKS.items():
        nodes = [f"{name} a", f"{name} b"]
        model.node(nodes[0], at(planar, *first))
        if name in stiff:
            by_hand(model, name, nodes)
        else:
            model.node(nodes[1], at(planar, *last))
            flexible(model, name, nodes)
    model.revolute("crank a", **axis)
    explicit = bool(stiff)
    model.revolute("crank b", to="coupler a", explicit=explicit, **axis)
    # in space one more axis would be redundant
    model.spherical("coupler b", "rocker a", explicit=explicit)
    model.revolute("rocker b", explicit=explicit, **axis)
    model.gravity((0.0, -90.0) if planar else TURN @ (0, -90.0, 0))
    return model


def assert_same(expected: Model, found: Model) -> None:
    expected, found = (simulate(one, H, STEPS * H, EXACT) for one in (expected, found))
    for name in (f"{link} {end}.{kind}" for link in LINKS for end, kind in
                 (("a", "rotation"), ("b", "position"))):
        moved = np.abs(expected[name] - expected[name][0]).max()
        size = 30.0 if name.endswith("position") else 1.0
        assert np.abs(found[name] - expected[name]).max() <= STEP_ERROR * max(moved, 0.1 * size), (
            name)


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("names", [*((name,) for name in LINKS), *permutations(LINKS)])
def test_links_of_a_four_bar(planar, names):
    model, held = four_bar((), planar), []
    for name in names:
        model, sentence = rigid(model, name)
        assert sentence.startswith(f"{name} is rigid: mass ")
        held += [name] * ("by equations" in sentence)
    assert held == list(names[2:])      # the last link closes the loop
    assert_same(four_bar(names, planar), model)


@pytest.mark.parametrize("names", [("rod",), ("crank", "rod"), ("rod", "crank")])
def test_links_of_a_slider_crank(names):
    """The slider is where rigid links put it, by the closed form."""
    model, r, l, speed = Model(planar=True), 30.0, 70.0, 4.0     # noqa: E741  (as in the formula)
    for name, x in (("foot", 0), ("pin", r), ("pin of rod", r), ("slider", r + l)):
        model.node(name, (x, 0.0))
    flexible(model, "crank", ["foot", "pin"])
    flexible(model, "rod", ["pin of rod", "slider"])
    model.revolute("foot")
    model.spherical("pin", "pin of rod", explicit=False)
    model.slider("slider", axis=(1.0, 0.0))
    model.move("foot", 1.0, (lambda t: 4.0 * t, lambda t: 4.0, lambda t: 0.0), what="rotation")
    model.initial_velocity("pin", linear=(0.0, r * speed))
    model.initial_velocity("pin of rod", angular=-r * speed / l)
    for name in names:
        model = rigid(model, name).model
    result = simulate(model, H, STEPS * H, EXACT)
    angle = speed * result.t
    pin = result["pin.position"]
    if "crank" in names:
        assert np.allclose(pin, r * np.column_stack([np.cos(angle), np.sin(angle)]), atol=1e-9)
    # from where the pin is, the rod reaches the line of the slider
    expected = pin[:, 0] + np.sqrt(l**2 - pin[:, 1]**2)
    slider = result["slider.position"]
    assert np.abs(slider[:, 0] - expected).max() < 1e-9 * l     # Newton's tolerance
    assert np.abs(slider[:, 1]).max() < 1e-9 * l
