"""Elastic laws and densities of a deck, and the axes that sections give them.

Stresses and strains here are in the order (xx, yy, zz, yz, zx, xy), see `sebody.fem.stress`.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.fem.materials import Material
from sebody.fem.stress import elasticity
from sebody.io.deck.cards import Card

# place in our order of the components (11, 22, 33, 12, 13, 23) of decks
_OURS = np.array([0, 1, 2, 5, 4, 3])


@dataclass(eq=False)
class DeckMaterial:
    """A material, with the properties that the deck gives.

    Parameters
    ----------
    law : (6, 6), optional
        Stress of a strain, in axes of the material.
    density : float, optional
    lack : str
        Why there is no law.
    """

    law: NDArray | None = None
    density: float | None = None
    lack: str = "has no *ELASTIC"

    def substance(self, name: str) -> Material | None:
        """Modulus of the stiffest axis and density, which reveal the units; None if not given."""
        if self.law is None or not self.density:
            return None
        modulus = 1 / np.diag(np.linalg.inv(self.law))[:3].min()
        return Material(name, float(np.sqrt(modulus / self.density)), self.density)


class Orientation(NamedTuple):
    """Axes of a material: rectangular, or cylindrical about the line from `a` to `b`.

    Parameters
    ----------
    a, b : (3,)
        Along the first axis, and in the plane of the first and second; or points of the line.
    cylindrical : bool
    axis, angle : int, float
        Further turn about one of these axes [degrees].
    """

    a: NDArray
    b: NDArray
    cylindrical: bool
    axis: int = 0
    angle: float = 0.0

    def axes(self, places: NDArray) -> NDArray:
        """Axes of the material as rows at places (n, 3), (n, 3, 3)."""
        if self.cylindrical:
            third = _unit(self.b - self.a)
            arms = places - self.a
            first = _unit(arms - np.outer(arms @ third, third))
        else:
            first, third = _unit(self.a), _unit(np.cross(self.a, self.b))
        first, third = np.broadcast_arrays(first, np.broadcast_to(third, places.shape))
        rows = np.stack([first, np.cross(third, first), third], axis=1)
        turn = Rotation.from_rotvec(np.radians(self.angle) * np.eye(3)[self.axis]).as_matrix()
        return turn.T @ rows


def read_orientation(card: Card) -> Orientation:
    """The axes of *ORIENTATION.

    Raises
    ------
    InputError
        Another system than the two here, or numbers that make no axes.
    """
    system = card.parameters.get("SYSTEM", "RECTANGULAR").upper()
    if system not in ("RECTANGULAR", "CYLINDRICAL"):
        raise card.row.fault(f"*ORIENTATION, SYSTEM={system} is not read",
                             "give RECTANGULAR or CYLINDRICAL")
    first, *rest = [[row.real(word) for word in row.words] for row in card.data] or [[]]
    a, b = np.array(first[:3]), np.array(first[3:6])
    if len(b) < 3 or not (np.linalg.norm(b - a) > 0 if system == "CYLINDRICAL" else
                          np.linalg.norm(np.cross(a, b)) > 0):
        raise card.row.fault(f"*ORIENTATION has the numbers {first}, which define no axes",
                             "give two points, x, y, z each, that are not in line with the origin "
                             "(cylindrical: that differ)")
    turn = rest[0] if rest and len(rest[0]) > 1 else [1, 0.0]
    return Orientation(a, b, system == "CYLINDRICAL", int(turn[0]) - 1, turn[1])


class Section(NamedTuple):
    """The material of the elements of a set, and its axes."""

    element_set: str
    material: str
    orientation: str


def read_elastic(material: DeckMaterial, card: Card) -> None:
    """The law of *ELASTIC.

    Raises
    ------
    InputError
        Too few numbers, or such as no material has.
    """
    kind = card.parameters.get("TYPE", "ISO").upper().replace(" ", "")
    if kind not in _LAWS:
        material.law, material.lack = None, f"has *ELASTIC, TYPE={kind}, which is not read"
        return
    count, law_of = _LAWS[kind]
    numbers = card.reals()
    if len(numbers) < count:
        raise card.row.fault(f"*ELASTIC, TYPE={kind} has {len(numbers)} numbers", f"give {count}")
    if len(numbers) > count + 1:        # one more is the temperature
        material.law, material.lack = None, "has an *ELASTIC that depends on temperature"
        return
    law = law_of(numbers[:count])
    if law is None or not (np.isfinite(law).all() and np.linalg.eigvalsh(law)[0] > 0):
        raise card.row.fault(f"*ELASTIC, TYPE={kind} has the numbers "
                             f"{', '.join(f'{x:g}' for x in numbers[:count])}, which give some "
                             "strain zero or negative energy", "correct them")
    material.law = law


def turned_law(law: NDArray, axes: NDArray) -> NDArray:
    """A law (6, 6) of material axes in axes of the model, (n, 6, 6).

    Parameters
    ----------
    axes : (n, 3, 3)
        Axes of the material as rows.
    """
    unit = np.zeros((6, 3, 3))          # tensors of unit strains; shears are twice the tensor's
    for row, (i, j) in zip(unit, _PAIRS, strict=True):
        row[i, j] += 0.5
        row[j, i] += 0.5
    local = axes[:, None] @ unit @ axes[:, None].transpose(0, 1, 3, 2)
    turn = np.stack([local[:, :, i, j] * (1 if i == j else 2) for i, j in _PAIRS], axis=1)
    return turn.transpose(0, 2, 1) @ law @ turn


_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))


def _isotropic(numbers: list[float]) -> NDArray | None:
    youngs_modulus, poisson_ratio = numbers
    return elasticity(*numbers) if youngs_modulus > 0 and -1 < poisson_ratio < 0.5 else None


def _of_constants(numbers: list[float]) -> NDArray | None:
    """From E1, E2, E3, nu12, nu13, nu23, G12, G13, G23."""
    E, nu, G = np.array(numbers).reshape(3, 3)
    if min(*E, *G) <= 0:
        return None
    compliance = np.diag([*(1 / E), *(1 / G)])
    for (i, j), ratio in zip(((0, 1), (0, 2), (1, 2)), nu, strict=True):
        compliance[i, j] = compliance[j, i] = -ratio / E[i]
    if np.linalg.eigvalsh(compliance)[0] <= 0:
        return None
    return np.linalg.inv(compliance)[np.ix_(_OURS, _OURS)]


def _orthotropic(numbers: list[float]) -> NDArray:
    """From D1111, D1122, D2222, D1133, D2233, D3333, D1212, D1313, D2323."""
    return _anisotropic([*numbers[:6], *[0.0] * 3, numbers[6], *[0.0] * 4, numbers[7],
                         *[0.0] * 5, numbers[8]])


def _anisotropic(numbers: list[float]) -> NDArray:
    """From the columns of the upper triangle, in the decks' order."""
    law = np.zeros((6, 6))
    columns, rows = np.tril_indices(6)
    law[rows, columns] = law[columns, rows] = numbers
    return law[np.ix_(_OURS, _OURS)]


_LAWS = {"ISO": (2, _isotropic), "ISOTROPIC": (2, _isotropic),
         "ENGINEERINGCONSTANTS": (9, _of_constants), "ORTHO": (9, _orthotropic),
         "ORTHOTROPIC": (9, _orthotropic), "ANISO": (21, _anisotropic),
         "ANISOTROPIC": (21, _anisotropic)}


def _unit(vectors: NDArray) -> NDArray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)
