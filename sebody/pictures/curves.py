"""Curves of histories: what the words of a user, such as ``tip.position.x:y``, show of results."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.units import Units
from sebody.quantities.names import AXES, NORM
from sebody.results.naming import Values, is_known, values
from sebody.results.result import Result
from sebody.results.units import with_unit

SEGMENTS = 4                    # at least, of a history in Welch's method, each half overlapping
FEWEST = 16                     # samples of a spectrum
UNEVEN = 1e-6                   # of a step: by how much times of a spectrum may differ from a grid


class Curve(NamedTuple):
    """A line of a panel."""

    label: str
    x: NDArray
    y: NDArray


class Panel(NamedTuple):
    """Curves over common axes."""

    title: str
    x_label: str
    y_label: str
    curves: list[Curve]
    kind: str = "history"       # history, phase or spectrum


def panels(results: Mapping[str, Result], words: Sequence[str], spectrum: bool = False
           ) -> list[Panel]:
    """One panel for each word; of several results one for each component.

    Parameters
    ----------
    results : mapping
        Results by their label.
    words : sequence of str
        Quantities, components (``tip.position.x``, ``tip.velocity.norm``, ``beam.modes.0``),
        groups (``energy``), or two components with a colon between them, for phase plots.
    spectrum : bool
        Power spectral densities in place of histories.

    Raises
    ------
    InputError
        A quantity or component there is not, a result of one state, or one without a spectrum.
    """
    for label, result in results.items():
        if len(result.t) < 2:
            raise InputError(f"{label} holds the state at t = {result.t[0]:g} alone, which makes "
                             "no curve: run the model to a later time")
    drawn: list[Panel] = []
    for word in words:
        inputs.name(word, "name of a quantity")
        first = next(iter(results.values()))
        pair = _pair(first, word)
        if pair and spectrum:
            raise InputError(f"{word} is a phase plot, which has no spectrum: name one quantity")
        drawn += _phase(results, word, *pair) if pair else _histories(results, word)
    return [_spectrum(panel, _units(results)) for panel in drawn] if spectrum else drawn


def _pair(result: Result, word: str) -> tuple[str, str] | None:
    """The two sides of the colon of a phase plot; colons in names of parts are none."""
    for at, letter in enumerate(word):
        if letter == ":" and is_known(result, word[:at]):
            return word[:at], word[at + 1:]
    if word.count(":") == 1 and not is_known(result, word):
        return tuple(word.split(":"))
    return None


def _phase(results: Mapping[str, Result], word: str, across: str, up: str) -> list[Panel]:
    if up in (*AXES, NORM) or up.isdecimal():
        up = f"{across.rpartition('.')[0]}.{up}"        # tip.position.x:y
    curves = []
    for label in results:
        curves.append(Curve(label, *(_one(results, label, word, side) for side in (across, up))))
    units = _units(results)
    return [Panel(f"{up} over {across}", *(with_unit(side, side, units)
                                           for side in (across, up)), curves, "phase")]


def _one(results: Mapping[str, Result], label: str, word: str, side: str) -> NDArray:
    """The numbers of one side of a phase plot."""
    values = _values_of(results, label, side)
    if len(values.labels) > 1:
        raise InputError(f"{word}: {side} has the components {', '.join(values.labels)}: a phase "
                         f"plot takes one of them, such as {side}.{values.labels[0]}")
    return values.numbers[:, 0]


def _histories(results: Mapping[str, Result], word: str) -> list[Panel]:
    histories = {label: _values_of(results, label, word) for label in results}
    first = next(iter(histories.values()))
    if len(results) == 1:
        t = next(iter(results.values())).t
        curves = [Curve(label, t, column)
                  for label, column in zip(first.labels, first.numbers.T, strict=True)]
        return [_history(first.name, curves, results)]
    made = []
    for component in first.labels:
        name = f"{first.name}.{component}".rstrip(".")
        curves = []
        for label, one in histories.items():
            if component not in one.labels:
                raise InputError(f"{label} has no {name}: {one.name} has the components "
                                 f"{', '.join(one.labels)}")
            curves.append(Curve(label, results[label].t,
                                one.numbers[:, one.labels.index(component)]))
        made.append(_history(name, curves, results))
    return made


def _history(name: str, curves: list[Curve], results: Mapping[str, Result]) -> Panel:
    units = _units(results)
    return Panel(name, with_unit("time", "t", units), with_unit(_plain(name), name, units),
                 curves)


def _units(results: Mapping[str, Result]) -> Units | None:
    """The units of results, if all have the same."""
    systems = {result.units for result in results.values()}
    return systems.pop() if len(systems) == 1 else None


def _values_of(results: Mapping[str, Result], label: str, word: str) -> Values:
    """`values`; where results are compared, an error names the one without the quantity."""
    try:
        return values(results[label], word)
    except InputError as error:
        if len(results) == 1:
            raise
        raise InputError(f"{label}: {error}") from error


def _plain(name: str) -> str:
    """The quantity of a name, for the axis."""
    parts = name.split(".")
    quantity = parts[-1] if not (parts[-1] in (*AXES, NORM) or parts[-1].isdecimal()) else parts[-2]
    return quantity.replace("_", " ")


def _spectrum(panel: Panel, units: Units | None) -> Panel:
    """Power spectral densities of the curves, by the method of Welch (1967)."""
    curves = [Curve(curve.label, *_density(panel.title, curve)) for curve in panel.curves]
    return Panel(panel.title, f"frequency [{units.of('1/time') if units else '1/time'}]",
                 "power spectral density", curves, "spectrum")


def _density(title: str, curve: Curve) -> tuple[NDArray, NDArray]:
    from scipy.signal import welch  # takes half a second to import

    steps = np.diff(curve.x)
    if len(curve.x) < FEWEST:
        raise InputError(f"{title} has {len(curve.x)} samples: a spectrum takes at least {FEWEST}, "
                         "keep more states or run longer")
    if np.ptp(steps) > UNEVEN * steps.mean():
        raise InputError(f"{title} is not sampled evenly, between {steps.min():.3g} and "
                         f"{steps.max():.3g}: a spectrum takes equal steps")
    segment = max(FEWEST, 2 * len(curve.x) // (SEGMENTS + 1))
    frequencies, density = welch(curve.y, 1.0 / steps.mean(), nperseg=segment)
    return frequencies[1:], density[1:]         # the mean is taken off
