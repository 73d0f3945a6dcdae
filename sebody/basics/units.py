"""Units by name: ``"mm t N s"``. Numbers of a model have none, so a set of units is consistent.

Words such as ``force/length^2`` say what a quantity is; a set of units makes ``MPa`` of them.
"""

import re
from difflib import get_close_matches
from typing import Any, NamedTuple

from sebody.basics import inputs
from sebody.basics.errors import InputError

LENGTHS = {"m": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "km": 1e3, "in": 0.0254,
           "ft": 0.3048}
_POUND, _INCH = 4.4482216152605, 0.0254
MASSES = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237, "slug": _POUND / 0.3048,
          "slinch": _POUND / _INCH}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}
FORCES = {"N": 1.0, "mN": 1e-3, "uN": 1e-6, "kN": 1e3, "MN": 1e6, "dyn": 1e-5, "lbf": _POUND,
          "kgf": 9.80665}
PRESSURES = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "psi": _POUND / _INCH**2}
_KINDS = {"length": LENGTHS, "mass": MASSES, "time": TIMES, "force": FORCES, "pressure": PRESSURES}
_SAME = 1e-9        # relative difference of factors that are the same
_REMEDY = ("name units of length, mass or force, and time that belong together, such as "
           "'mm t N s', 'm kg N s' or 'in lbf s'")


class Units(NamedTuple):
    """A consistent set of units by their names."""

    length: str
    mass: str
    force: str
    time: str

    def __str__(self) -> str:
        return " ".join(self)

    def factor(self, words: str) -> float:
        """One of the quantity's unit in metres, kilograms and seconds."""
        result = 1.0
        for name, power in _powers(words):
            result *= _factor(self, name) ** power
        return result

    def of(self, words: str) -> str:
        """The unit of a quantity in words, ``force/length^2``; words that are none stay."""
        if words == "1/time" and self.time == "s":
            return "Hz"
        if words == "force/length^2":
            value = self.factor(words)
            return _named(PRESSURES, value) or f"{self.force}/{self.length}^2"
        return re.sub("length|mass|force|time", lambda word: getattr(self, word[0]), words)


def of_rates(units: Units | None, words: str = "rad/time") -> str:
    """The unit of a rate, ``rad/time`` or ``1/time``; without units that of seconds."""
    return words.replace("time", units.time if units else "s")


def of_frequencies(units: Units | None) -> str:
    """The unit of a frequency, Hz without units."""
    return units.of("1/time") if units else "Hz"


def parsed_units(text: Any, what: str = "units") -> Units | None:
    """A set of units from its text; None for an empty one.

    Units are separated by blanks or commas, in any order. Mass or force may be left out, which
    then follows from the others, and so may seconds. ``SI`` is ``m kg N s``.

    Raises
    ------
    InputError
        No text, a unit that is unknown or named twice, too few, or units that do not belong
        together.
    """
    if not isinstance(text, str):
        raise inputs.refusal(what, text, _REMEDY)
    words = re.split(r"[\s,;*·-]+", text.strip()) if text.strip() else []
    if not words:
        return None
    if [word.upper() for word in words] == ["SI"]:
        words = ["m", "kg", "N", "s"]
    units: dict[str, str] = {}
    for word in words:
        kind, name = _known(word, what, text)
        if kind in units:
            raise InputError(f"{what} {text!r} names two units of {kind}, {units[kind]} and "
                             f"{name}: name one")
        units[kind] = name
    units.setdefault("time", "s")
    if "length" not in units or not {"mass", "force", "pressure"} & set(units):
        missing = "length" if "length" not in units else "mass or force"
        raise InputError(f"{what} {text!r} names no unit of {missing}: {_REMEDY}")
    return _consistent(units, what, text)


def common_units() -> list[Units]:
    """The sets of units that engineers use most."""
    return [parsed_units(text) for text in (
        "m kg N s", "mm t N s", "mm kg mN s", "mm kg kN ms", "mm g N ms", "cm g dyn s",
        "in lbf s", "ft slug lbf s")]


def _known(word: str, what: str, text: str) -> tuple[str, str]:
    """Kind and name of a unit; capitals do not matter where they tell nothing apart."""
    names = {name: kind for kind, table in _KINDS.items() for name in table}
    if word in names:
        return names[word], word
    alike = [name for name in names if name.lower() == word.lower().replace("µ", "u")]
    if len(alike) == 1:
        return names[alike[0]], alike[0]
    near = alike or get_close_matches(word, names, n=3)
    meant = f"did you mean {' or '.join(near)}? " if near else ""
    raise InputError(f"{what} {text!r}: {word!r} is not a known unit: {meant}{_REMEDY}")


def _consistent(found: dict[str, str], what: str, text: str) -> Units:
    """The set with its force and mass, which follow from each other."""
    length, time = LENGTHS[found["length"]], TIMES[found["time"]]
    forces = {kind: value for kind, value in (
        ("mass", MASSES.get(found.get("mass", ""), 0.0) * length / time**2),
        ("force", FORCES.get(found.get("force", ""), 0.0)),
        ("pressure", PRESSURES.get(found.get("pressure", ""), 0.0) * length**2)) if value}
    (first, force), *others = forces.items()
    for kind, other in others:
        if abs(other / force - 1) > _SAME:
            raise InputError(
                f"{what} {text!r} do not belong together: with {found[first]}, {found['length']} "
                f"and {found['time']} a unit of force is {force:.6g} N, with {found[kind]} "
                f"{other:.6g} N: {_REMEDY}")
    mass = force * time**2 / length
    return Units(
        found["length"],
        found.get("mass") or _named(MASSES, mass) or "force time^2/length".replace(
            "force", found.get("force", "N")).replace("time", found["time"]).replace(
            "length", found["length"]),
        found.get("force") or _named(FORCES, force) or
        f"{found.get('mass', 'kg')} {found['length']}/{found['time']}^2", found["time"])


def _named(table: dict[str, float], value: float) -> str:
    """The unit of a value; empty if none has it."""
    return next((name for name, one in table.items() if abs(one / value - 1) < _SAME), "")


def _factor(units: Units, name: str) -> float:
    length, time = LENGTHS[units.length], TIMES[units.time]
    if name in ("length", "time"):
        return length if name == "length" else time
    force = FORCES.get(units.force) or MASSES[units.mass] * length / time**2
    return force if name == "force" else force * time**2 / length


def _powers(words: str) -> list[tuple[str, int]]:
    """Quantities of words and their powers: those behind a stroke are divided by."""
    powers = []
    for part, sign in zip(words.split("/", 1), (1, -1), strict=False):
        for word in part.split():
            name, _, power = word.partition("^")
            powers.append((name, sign * int(power or 1)))
    return powers
