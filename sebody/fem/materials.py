"""Materials, by the two numbers that reveal the units of a model: speed of sound and density."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from sebody.basics import inputs
from sebody.basics.units import Units, common_units, parsed_units

SLOWEST, FASTEST = 100.0, 2e4   # speed of sound in a solid, sqrt(E / density) [m/s]
LIGHTEST, HEAVIEST = 10.0, 3e4  # its density [kg/m^3]
_STEEL = 2.1e11, 7850.0         # E and density [Pa, kg/m^3]


class Material(NamedTuple):
    """A material of a model, in its units.

    Parameters
    ----------
    name : str
    speed : float
        Of sound, ``sqrt(E / density)`` [length/time].
    density : float, optional
        [mass/length^3]; None where a section is given by its stiffnesses.
    """

    name: str
    speed: float
    density: float | None = None


def uniform_material(youngs_modulus: float, mass: float, volume: float) -> Material:
    """The material of a body of so much mass and volume."""
    return Material("", float(np.sqrt(youngs_modulus * volume / mass)), mass / volume)


def checked_materials(materials: Sequence[Material], what: str = "materials"
                      ) -> tuple[Material, ...]:
    """Materials whose numbers are positive and finite.

    Raises
    ------
    InputError
        Others, or something else.
    """
    remedy = "give Material(name, speed, density)"
    checked = []
    for one in inputs.items(materials, what, remedy):
        if not isinstance(one, tuple | list) or len(one) not in (2, 3):
            raise inputs.refusal(f"{what}: one", one, remedy)
        name, speed, density = (*one, None)[:3]
        if not isinstance(name, str):
            raise inputs.refusal(f"{what}: a name", name, remedy)
        checked.append(Material(
            name, inputs.number(speed, f"speed of sound of material {name!r}", above=0),
            None if density is None else inputs.number(
                density, f"density of material {name!r}", above=0)))
    return tuple(checked)


def doubt(material: Material, units: Units | None) -> tuple[str, str] | None:
    """Doubt about the numbers of a material, and the remedy; None if nothing does.

    Parameters
    ----------
    units : Units, optional
        Of the model; without them the numbers must fit one of the common sets.
    """
    named = f"material {material.name}: " if material.name else ""
    if units is None:
        if any(_fits(material, one) for one in common_units()):
            return None
        density = "" if material.density is None else f" and density {material.density:.6g}"
        return (f"{named}speed of sound {material.speed:.6g}{density} do not belong to a solid "
                "in any common set of units",
                f"check E and density, {_steel(None)}, and name the units")
    speed = material.speed * units.factor("length/time")
    if not SLOWEST <= speed <= FASTEST:
        return (f"{named}the speed of sound sqrt(E/density) is {speed:.3g} m/s in the units "
                f"{units}, no solid has less than {SLOWEST:g} or more than {FASTEST:g}",
                f"check E, density and units, {_steel(units)}")
    if material.density is not None and not _fits(material, units):
        density = material.density * units.factor("mass/length^3")
        return (f"{named}the density is {density:.3g} kg/m^3 in the units {units}",
                f"check E, density and units, {_steel(units)}")
    return None


def doubts(materials: Iterable[Material], units: str) -> list[str]:
    """Doubts about materials, in sentences ``what; what to do``, each once."""
    found = [doubt(Material(*one), parsed_units(units)) for one in materials]
    return [f"{text}; {remedy}" for text, remedy in dict.fromkeys(filter(None, found))]


def _fits(material: Material, units: Units) -> bool:
    density = material.density
    return SLOWEST <= material.speed * units.factor("length/time") <= FASTEST and (
        density is None
        or LIGHTEST <= density * units.factor("mass/length^3") <= HEAVIEST)


def _steel(units: Units | None) -> str:
    """The numbers of steel in some units, to compare with."""
    units = units or common_units()[1]
    modulus = _STEEL[0] / units.factor("force/length^2")
    density = _STEEL[1] / units.factor("mass/length^3")
    return f"steel has E {modulus:.3g} and density {density:.3g} in {units}"
