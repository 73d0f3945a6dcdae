"""Sections along a beam: one for all of it, or a function of the place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.general_section import GeneralSection
from sebody.fem.section import Section, StiffnessSection

AnySection: TypeAlias = (Section | StiffnessSection | GeneralSection
                         | Callable[[float], Section | StiffnessSection | GeneralSection])


def section_at(section: AnySection, place: float) -> StiffnessSection | GeneralSection:
    """The section at `place`, from 0 at the start of a beam to 1 at its end.

    Raises
    ------
    InputError
        Something that is no section.
    """
    value = _called(section, place) if callable(section) else section
    if not isinstance(value, (Section, StiffnessSection, GeneralSection)):
        raise InputError(
            f"section {inputs.shown(value)} is none: give a Section, a StiffnessSection, a "
            "GeneralSection or a function of the place along the beam, from 0 to 1, that returns "
            "one"
        )
    return value.stiffnesses


def _called(section: Callable, place: float) -> Any:
    try:
        return section(place)
    except (TypeError, ValueError, ArithmeticError, LookupError, AttributeError) as error:
        raise InputError(f"section at {place:g} of the beam: the function raised "
                         f"{type(error).__name__}: {error}; correct it") from error


@dataclass(frozen=True)
class SectionOfPart:
    """The section of the part of a beam from `first` to `last`, places of the whole beam."""

    section: Callable[[float], Section | StiffnessSection | GeneralSection]
    first: float
    last: float

    @property
    def kinks(self) -> NDArray:
        """Places along the part where sections are not smooth."""
        return (kinks_of(self.section) - self.first) / (self.last - self.first)

    def __call__(self, place: float) -> Section | StiffnessSection | GeneralSection:
        """The section at a place of the part."""
        return self.section(self.first + place * (self.last - self.first))


def part_of(section: AnySection, first: float, last: float) -> AnySection:
    """The section of the part of a beam from `first` to `last`, places from 0 to 1."""
    return SectionOfPart(section, first, last) if callable(section) else section


def kinks_of(section: AnySection) -> NDArray:
    """Places where a section is known not to be smooth along the beam: those of stations."""
    return np.asarray(getattr(section, "kinks", ()), dtype=float)
