"""Coefficients of generalized-alpha, with which a step is linearized."""

from typing import NamedTuple

from sebody.engine.state import Scheme


class Coefficients(NamedTuple):
    """Coefficients of generalized-alpha with a step h."""

    h: float
    am: float
    af: float
    b: float
    g: float

    @classmethod
    def of(cls, scheme: Scheme, h: float) -> "Coefficients":
        return cls(h, scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma)

    @property
    def cm(self) -> float:
        """``da' / dy``."""
        return (1 - self.am) / ((1 - self.af) * self.b * self.h**2)

    @property
    def cd(self) -> float:
        """``dv' / dy``."""
        return self.g / (self.b * self.h)

    @property
    def cu(self) -> float:
        """``daux' / dy``."""
        return 1 / (self.b * self.h**2)
