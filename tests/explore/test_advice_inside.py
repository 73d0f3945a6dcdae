"""Advice on quantities inside beams, which are divided all the same, and on many like parts."""

import numpy as np
import pytest
from advised_crane import SOFT, T_END, H

from sebody import Model, simulate
from sebody.analysis import advise
from sebody.explore.advice.forms import parts_of
from sebody.explore.advice.inside import Places
from sebody.fem import Section
from sebody.model.variants import divide

FORCES = "arm.node4.section_forces"


def strip(load: float = 20.0, elements: int = 16, bodies: int = 1, modes: int = 2) -> Model:
    """A soft beam, held at its lower end, that a force bends far."""
    model = Model(planar=True)
    model.node("tip", (50.0, 2.0)), model.node("root", (12.0, 9.0))
    model.beam("arm", ("root", "tip"), SOFT, elements, bodies, modes=modes, damping=0.1)
    model.fix("root")
    model.force("tip", (0.2, 1.0), [(0, 0), (0.2, load), (0.4, load)])
    return model


def read(result, name: str) -> np.ndarray:
    return result[name]


@pytest.mark.parametrize("place", [0, 3, 4, 8, 12])
def test_section_forces_at_a_place_of_the_beam_are_found_in_any_division(place):
    name = f"arm.node{place}.section_forces"
    places = Places(strip(), [name])
    found = []
    for bodies in (1, 2, 4, 8):
        result = simulate(divide(strip(0.2), "arm", bodies, 16).model, H, T_END)
        found.append(places.history(result, name, read))
    for other in found[1:]:
        assert other.shape == found[0].shape
        assert np.abs(other - found[0]).max() <= 5e-3 * np.abs(found[0]).max()


def test_between_two_bodies_the_side_that_is_stressed_more_counts():
    """At every time its own: von Mises's stress, and the tensor of the same side."""
    sides = {"arm 1.node8.von_mises": [1.0, 5.0, 2.0], "arm 2.node0.von_mises": [3.0, 4.0, 2.5]}
    sides |= {"arm 1.node8.stress": 10 * np.outer(sides["arm 1.node8.von_mises"], np.ones(6)),
              "arm 2.node0.stress": 10 * np.outer(sides["arm 2.node0.von_mises"], np.ones(6))}
    places = Places(strip(), ["arm.node8.von_mises", "arm.node8.stress"])
    divided = divide(strip(), "arm", 2, 16).model
    names = places.names(divided, "arm.node8.von_mises")
    assert [name.partition(".")[2] for name in names] == ["node8.von_mises", "node0.von_mises"]
    known = dict(zip(names, ("arm 1.node8.von_mises", "arm 2.node0.von_mises"), strict=True))
    known |= dict(zip(places.names(divided, "arm.node8.stress"),
                      ("arm 1.node8.stress", "arm 2.node0.stress"), strict=True))

    class Run:
        model = divided

    found = {name: places.history(Run, name, lambda run, one: np.array(sides[known[one]]))
             for name in ("arm.node8.von_mises", "arm.node8.stress")}
    larger = np.array([3.0, 5.0, 2.5])
    assert np.array_equal(found["arm.node8.von_mises"], larger)
    assert np.array_equal(found["arm.node8.stress"], 10 * np.outer(larger, np.ones(6)))


def test_a_beam_is_divided_though_its_stress_is_asked_for():
    advice = advise(strip(), H, T_END, FORCES, 2e-2)
    assert advice.table[0].change.startswith("arm: 8 bodies with ")
    assert not any("rigid" in trial.change for trial in advice.table)
    exact = strip(elements=64, bodies=64, modes=0)
    every = max(round(H / advice.step), 1)
    stride = max(round(advice.step / H), 1)
    places = Places(strip(), [FORCES])
    one = places.history(simulate(advice.model, advice.step, T_END, output_every=every), FORCES,
                         read)
    whole = places.history(simulate(exact, H / 8, T_END, output_every=8), FORCES, read)[::stride]
    change = np.sqrt(((whole - whole[0])**2).sum(axis=(1, 2))).max()
    error = np.sqrt(((one - whole)**2).sum(axis=(1, 2))).max() / change
    assert advice.confirmed
    # the ends of 64 elements are 3e-3 off, as half and a quarter of their number show
    assert error <= advice.error + 4e-3


def chain(count: int) -> Model:
    """A pendulum of equal links."""
    section = Section(area=4e-4, inertia_y=1.3e-8, inertia_z=1.3e-8, torsion=2.2e-8,
                      youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)
    model, place = Model(planar=True), np.array([0.3, 0.7])
    begin = model.node("begin 0", place)
    model.revolute(begin)
    for k in range(count):
        place = place + 0.4 * np.array([np.cos(0.2), -np.sin(0.2)])
        end = model.node(f"end {k}", place)
        model.beam(f"link {k}", (begin, end), section, 16, 1, modes=2, damping=0.02)
        if k < count - 1:
            begin = model.node(f"begin {k + 1}", place, at=end)
    model.gravity((0.0, -9.81))
    return model


def test_links_that_are_alike_are_tried_together():
    advice = advise(chain(6), 0.002, 0.2, "end 5.position", 1e-2)
    assert advice.confirmed
    assert len(advice.model.rigid_bodies) == 6
    tried = [trial.change for trial in advice.table if trial.kind == "alone"]
    assert all("link 0, link 1, link 2, link 3, link 4, link 5: " in change
               or "joints" in change or "variable" in change or "DOF blocks" in change
               for change in tried)
    assert not advice.untried


@pytest.mark.parametrize("bodies", [20, 24])
def test_a_beam_of_as_many_bodies_as_elements_is_merged(bodies):
    model = strip(2.0, bodies, bodies, 0)
    part = parts_of(model)[0]
    assert part.detailed == part.given
    advice = advise(model, H, T_END, "tip.position", 2e-2)
    assert advice.confirmed
    assert len(advice.model.bodies) == 1
