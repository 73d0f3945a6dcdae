"""Where a scene of `advice_scenes` lies, and its units."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody import Model
from sebody.fem import Section, rectangle

STEEL, ALUMINIUM = (2.1e11, 0.3, 7800.0), (7e10, 0.33, 2700.0)


@dataclass(frozen=True, eq=False)
class Place:
    """Orientation and origin of a scene, and its units of length and mass; that of time stays."""

    rotation: NDArray
    origin: NDArray
    length: float = 1.0
    mass: float = 1.0

    @classmethod
    def plane(cls, angle: float, *origin: float, **units: float) -> "Place":
        """In the plane, turned by an angle [rad]."""
        c, s = np.cos(angle), np.sin(angle)
        return cls(np.array([[c, -s], [s, c]]), np.array(origin), **units)

    @classmethod
    def space(cls, seed: int, *origin: float, **units: float) -> "Place":
        """In space, turned at random."""
        return cls(Rotation.random(random_state=seed).as_matrix(), np.array(origin), **units)

    def point(self, *x: float) -> NDArray:
        """A point given in m."""
        return self.length * (self.rotation @ np.array(x) + self.origin)

    def turned(self, *v: float) -> NDArray:
        """A direction."""
        return self.rotation @ np.array(v)

    def vector(self, *v: float) -> NDArray:
        """A velocity or an acceleration given in m and s."""
        return self.length * self.turned(*v)

    def force(self, *f: float) -> NDArray:
        """A force given in N."""
        return self.mass * self.vector(*f)

    def moment(self, *m: float) -> NDArray | float:
        """A moment given in N m, in the plane a number; likewise a torsion stiffness."""
        scale = self.mass * self.length**2
        return scale * (m[0] if len(self.origin) == 2 else self.turned(*m))

    def stiffness(self, k: float) -> float:
        """A stiffness given in N / m; likewise damping in N s / m."""
        return self.mass * k

    def material(self, modulus: float, ratio: float, density: float) -> tuple[float, float, float]:
        """Young's modulus, Poisson's ratio, density given in Pa and kg / m^3."""
        return modulus * self.mass / self.length, ratio, density * self.mass / self.length**3

    def bar(self, height: float, width: float, material: tuple = STEEL) -> Section:
        """A rectangular section given in m."""
        return rectangle(height * self.length, width * self.length, *self.material(*material))

    def model(self, *gravity: float) -> Model:
        """An empty model, with gravity in m / s^2 if it is given."""
        model = Model(planar=len(self.origin) == 2)
        if gravity:
            model.gravity(self.vector(*gravity))
        return model
