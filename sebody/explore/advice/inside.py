"""Quantities inside beams, by their place along the whole beam: the same in any division."""

import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sebody.model.mechanism import Mechanism
from sebody.model.parts import Beam
from sebody.results.result import Result

# quantities that do not depend on the axes of a body; with components those of one side alone
INSIDE = re.compile(r"(?P<body>.+)\.node(?P<number>\d+)\.(?P<rest>position|velocity|acceleration|"
                    r"stress|von_mises|section_forces|section_strains)")
MOVING = "position", "velocity", "acceleration"        # which both sides have in common


class Places:
    """Places of quantities of FE nodes along the beams of a model.

    Parameters
    ----------
    model : Mechanism
        As given.
    names : list of str
    """

    def __init__(self, model: Mechanism, names: list[str]):
        self._found: dict[str, tuple[str, int, int, str]] = {}
        parts = {part.name: (beam, k) for beam in model.beams
                 for k, part in enumerate(beam.parts) if model.bodies.get(part.name) is part
                 and beam.options["divide"] == "length"}      # else places move with the bodies
        for name in names:
            inside = INSIDE.fullmatch(name)
            if inside and inside["body"] in parts:
                beam, k = parts[inside["body"]]
                each = beam.elements // len(beam.parts)
                if int(inside["number"]) <= each:
                    self._found[name] = (beam.name, k * each + int(inside["number"]),
                                         beam.elements, inside["rest"])

    @property
    def beams(self) -> dict[str, int]:
        """Beams whose inside is asked for, and their finite elements, which places are counted in.
        """
        return {beam: elements for beam, _, elements, _ in self._found.values()}

    def names(self, model: Mechanism, name: str) -> list[str]:
        """A quantity's name in a model with other divisions of beams.

        Two names at a node between two bodies, each of which has the stresses of its own side.
        """
        if name not in self._found:
            return [name]
        wanted, place, elements, rest = self._found[name]
        beam: Beam | None = next((one for one in model.beams if one.name == wanted), None)
        if beam is None or beam.elements % elements:
            return [name]
        each = beam.elements // len(beam.parts)
        node = place * (beam.elements // elements)
        return [f"{part.name}.node{node - k * each}.{rest}" for k, part in enumerate(beam.parts)
                if 0 <= node - k * each <= each]

    def history(self, result: Result, name: str, read: Callable[[Result, str], NDArray]) -> NDArray:
        """A quantity of a run, as the model as given would have it."""
        names = self.names(result.model, name)
        sides = [read(result, one) for one in names]
        if len(sides) == 1 or name.endswith(MOVING):
            return sides[0]
        if name.endswith(("section_forces", "section_strains")):
            return np.concatenate(sides, axis=1)
        left, right = ([read(result, f"{one.rpartition('.')[0]}.von_mises") for one in names])
        return np.where((left >= right).reshape(-1, *[1] * (sides[0].ndim - 1)), *sides)
