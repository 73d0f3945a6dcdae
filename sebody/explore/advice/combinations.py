"""Combinations of forms that no others beat in both cost and expected error."""

from collections.abc import Sequence

from sebody.explore.advice.cost import of_form
from sebody.explore.advice.estimates import Estimates, expected
from sebody.explore.advice.forms import Form, Part

MOST = 200      # combinations that are carried from part to part


def combinations(parts: Sequence[Part], forms: Sequence[Sequence[Form]], estimates: Estimates,
                 flat: bool, groups: Sequence[Sequence[int]]) -> list[tuple[Form, ...]]:
    """Forms of all parts, cheapest first; parts of a group have the same form."""
    combined: list[tuple[float, float, tuple[Form, ...]]] = [(0.0, 0.0, ())]
    for group in groups:
        own = forms[group[0]]
        squares = [sum(expected(estimates.of_form(k, form))**2 for k in group) for form in own]
        front = _front([(sum(of_form(parts[k], form, flat) for k in group), square, (form,))
                        for form, square in zip(own, squares, strict=True)])
        combined = _thinned(_front([(a + b, e + f, (*one, *other)) for a, e, one in combined
                                    for b, f, other in front]))
    return [_spread(one, groups, len(parts)) for _, _, one in combined]


def _spread(forms: Sequence[Form], groups: Sequence[Sequence[int]], count: int) -> tuple:
    """The form of each part, from that of its group."""
    of_part = {k: form for form, group in zip(forms, groups, strict=True) for k in group}
    return tuple(of_part[k] for k in range(count))


def _front(points: list[tuple[float, float, tuple[Form, ...]]]) -> list:
    """Those that no cheaper one equals or beats in error."""
    kept, best = [], float("inf")
    for point in sorted(points):
        if point[1] < best:
            kept.append(point)
            best = point[1]
    return kept


def _thinned(points: list) -> list:
    """At most so many of a front, evenly, with both its ends."""
    if len(points) <= MOST:
        return points
    return [points[round(k * (len(points) - 1) / (MOST - 1))] for k in range(MOST)]
