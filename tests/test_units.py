"""Units by name: consistent sets, units of quantities, and numbers that speak against them."""

import numpy as np
import pytest

from sebody import InputError, Model, simulate
from sebody.basics.units import common_units, parsed_units
from sebody.fem import Section, straight_beam
from sebody.fem.materials import Material, doubt, doubts
from sebody.io import save_body
from sebody.pictures.curves import panels
from sebody.reduction import craig_bampton
from sebody.results import plot


@pytest.mark.parametrize(("text", "whole", "pressure", "force", "mass"), [
    ("mm t N s", "mm t N s", "MPa", 1.0, 1e3), ("t mm s", "mm t N s", "MPa", 1.0, 1e3),
    ("mm, t, s", "mm t N s", "MPa", 1.0, 1e3), ("N;mm", "mm t N s", "MPa", 1.0, 1e3),
    ("mm MPa", "mm t N s", "MPa", 1.0, 1e3), ("SI", "m kg N s", "Pa", 1.0, 1.0),
    ("m, kg, s", "m kg N s", "Pa", 1.0, 1.0), ("MM KG S", "mm kg mN s", "kPa", 1e-3, 1.0),
    ("mm kg ms", "mm kg kN ms", "GPa", 1e3, 1.0), ("m kN s", "m t kN s", "kPa", 1e3, 1e3),
    ("cm g s", "cm g dyn s", "dyn/cm^2", 1e-5, 1e-3),
    ("in lbf s", "in slinch lbf s", "psi", 4.4482216152605, 175.12683524647636),
    ("in lb s", "in lb lb in/s^2 s", "lb in/s^2/in^2", 0.45359237 * 0.0254, 0.45359237),
])
def test_consistent_sets(text, whole, pressure, force, mass):
    units = parsed_units(text)
    assert str(units) == whole and units.of("force/length^2") == pressure
    assert units.factor("force") == pytest.approx(force, rel=1e-12)
    assert units.factor("mass") == pytest.approx(mass, rel=1e-12)
    # Newton's law, and a product of powers
    assert units.factor("mass length/time^2") == pytest.approx(force, rel=1e-12)
    assert parsed_units(text.lower() if "M" in text and "P" not in text else text) == units


def test_units_of_quantities():
    units = parsed_units("mm t N s")
    for words, unit in (("length/time^2", "mm/s^2"), ("force length", "N mm"),
                        ("rad/time", "rad/s"), ("1/time", "Hz"),
                        ("mass length^2/time", "t mm^2/s"), ("", "")):
        assert units.of(words) == unit
    assert parsed_units("m kg ms").of("1/time") == "1/ms"
    assert parsed_units("") is None and parsed_units("  ") is None


@pytest.mark.parametrize(("text", "said"), [
    ("mm kg N s", "do not belong together: with kg, mm and s a unit of force is 0.001 N, with N 1"),
    ("mm t MN s", "with MN 1e[+]06 N"), ("mm t GPa s", "do not belong together"),
    ("mm cm t s", "names two units of length, mm and cm"), ("t s", "names no unit of length"),
    ("mm s", "names no unit of mass or force"), ("mm tt s", "'tt' is not a known unit: did you"),
    ("furlong kg s", "'furlong' is not a known unit: name units of length"),
    (3, "units is 3: name units"), (None, "units is None")])
def test_refused(text, said):
    with pytest.raises(InputError, match=said):
        parsed_units(text)


STEEL = [("mm t N s", 2.1e5, 7.85e-9), ("m kg N s", 2.1e11, 7850.0), ("mm kg mN s", 2.1e8, 7.85e-6),
         ("mm g N ms", 2.1e5, 7.85e-3), ("in lbf s", 3.0e7, 7.3e-4)]


def material(modulus, density):
    return Material("STEEL", float(np.sqrt(modulus / density)), density)


@pytest.mark.parametrize(("units", "modulus", "density"), STEEL)
def test_steel_is_no_doubt(units, modulus, density):
    assert doubt(material(modulus, density), parsed_units(units)) is None
    assert doubt(material(modulus, density), None) is None
    assert doubt(material(1e-2 * modulus, 0.2 * density), parsed_units(units)) is None      # wood


@pytest.mark.parametrize(("modulus", "density"), [
    (2.1e5, 7850.0),        # kg/m^3 with mm and MPa
    (2.1e5, 7.85),          # g/cm^3
    (2.1e11, 7.85e-9),      # Pa with mm
])
def test_numbers_of_mixed_units(modulus, density):
    text, remedy = doubt(material(modulus, density), parsed_units("mm t N s"))
    speed = np.sqrt(modulus / density) / 1e3
    assert f"sqrt(E/density) is {speed:.3g} m/s in the units mm t N s" in text
    assert "steel has E 2.1e+05 and density 7.85e-09 in mm t N s" in remedy
    text, remedy = doubt(material(modulus, density), None)
    assert "do not belong to a solid in any common set of units" in text
    assert "name the units" in remedy


def test_the_density_counts_too():
    """A possible speed of sound of wrong numbers: kg/mm^3 with MPa; E and density of others."""
    for modulus, density, said in ((2.1e5, 7.85e-6, "7.85e+06"), (2.1e11, 7.85e-3, "7.85e+09")):
        text, _ = doubt(material(modulus, density), parsed_units("mm t N s"))
        assert f"density is {said} kg/m^3" in text
    assert doubts([material(2.1e5, 7.85), material(2.1e5, 7.85)], "mm t N s")[0].count(";") == 1
    assert len(common_units()) == 8


SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387, youngs_modulus=2.1e5,
                  poisson_ratio=0.3, density=7.85e-9)


@pytest.fixture(scope="module")
def body():
    return craig_bampton(straight_beam((0, 0, 0), (100, 0, 0), SECTION, 6),
                         [(0, "full"), (6, "full")], 2)


def pendulum(body, units):
    model = Model(units=units)
    nodes = [model.node(name, point) for name, point in
             zip(("base", "tip"), body.coordinates, strict=True)]
    model.superelement("beam", body, nodes)
    model.revolute(nodes[0], (0, 0, 1), name="hinge")
    model.gravity((0, -9810, 0))
    return simulate(model, h=1e-3, t_end=0.02)


def test_units_of_a_model_are_on_axes_and_in_tables(body, tmp_path):
    result = pendulum(body, "N, mm")
    assert str(result.units) == "mm t N s" and not result.cautions
    drawn = panels({"run": result}, ["tip.velocity", "hinge.force.x", "energy", "tip.rotation",
                                     "tip.position.x:y", "beam.modes.0"])
    labels = [(panel.x_label, panel.y_label) for panel in drawn]
    assert labels[:3] == [("time [s]", "velocity [mm/s]"), ("time [s]", "force [N]"),
                          ("time [s]", "energy [N mm]")]
    assert labels[4] == ("tip.position.x [mm]", "tip.position.y [mm]")
    assert labels[5] == ("time [s]", "modes")
    spectrum, = panels({"run": result}, ["tip.position.x"], spectrum=True)
    assert spectrum.x_label == "frequency [Hz]"
    loaded = type(result).load(result.save(tmp_path / "run.npz"))
    assert loaded.units == result.units and loaded.model.bodies["beam"].reduced.materials
    figure = plot(loaded, "tip.position")
    assert figure.axes[0].get_ylabel() == "position [mm]"
    plain = pendulum(body, "")
    assert plain.units is None and panels({"a": plain}, ["energy"])[0].y_label == "energy"
    both = panels({"a": result, "b": plain}, ["energy.kinetic"])[0]
    assert both.y_label == "kinetic"            # units of one alone would be wrong


def test_materials_in_the_units_of_the_model(body):
    assert not pendulum(body, "").cautions
    said, = pendulum(body, "SI").cautions
    assert said.startswith("body 'beam': material of a section: the speed of sound sqrt(E/density) "
                           "is 5.17e+06 m/s in the units m kg N s")


def test_bodies_bring_their_units(body, tmp_path):
    path = save_body(body, tmp_path / "beam.npz", units="t mm s")
    for model, units in ((Model(), "mm t N s"), (Model(units="N mm s"), "mm t N s")):
        nodes = [model.node(f"n{k}", point) for k, point in enumerate(body.coordinates)]
        assert model.superelement("beam", path, nodes).reduced.units == units == model.units
    model = Model(units="SI")
    nodes = [model.node(f"n{k}", point) for k, point in enumerate(body.coordinates)]
    with pytest.raises(InputError, match="the body is in the units mm t N s and the model in m kg"):
        model.superelement("beam", path, nodes)
    with pytest.raises(InputError, match="units of the model 'mm kg N s' do not belong together"):
        Model(units="mm kg N s")
