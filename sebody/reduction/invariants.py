"""Constants of a flexible body's kinetic and strain energy beyond its reduced matrices.

The velocity of the body in its floating frame is ``v0* + Omega_0 x (X + Phi y + Psi eta) + Phi ydot
+ Psi etadot``: what the kinetic energy needs of it are integrals of shapes over the mass, computed
once from the FE mass matrix M. The slaved coordinates ``eta_b = y^T Q_b y / 2`` are displacements
of second order, and the stress resultants ``s_e = lam_e E_e^T y + y^T Ghat_e y / 2`` make the
strain energy of second order.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.tabular import brief
from sebody.basics.vectors import axes_cross

# of the arrays: D axes of translation, r of rotation, n coordinates, N with the slaved ones
LENGTHS = {"c0": ("D",), "S1": ("D", "N"), "J0": ("r", "r"), "g": ("r", "N"), "h": ("r", "r", "N"),
           "K": ("r", "N", "N"), "J2": ("r", "r", "N", "N"), "Mbar": ("N", "N"),
           "Q": ("slaved", "n", "n"), "lam": ("resultants",), "E": ("n", "resultants"),
           "Ghat": ("resultants", "n", "n"), "origin": ("D",)}


def turned_resultants(lam: NDArray, E: NDArray, Ghat: NDArray, turn: NDArray
                      ) -> tuple[NDArray, NDArray, NDArray]:
    """lam, E and Ghat of other resultants, whose squares make the same strain energy.

    Parameters
    ----------
    turn : (n_e, m)
        Orthonormal columns: what the others have of each resultant of unit strain energy.
    """
    roots = np.sqrt(lam)
    others = (turn**2).T @ lam
    return (others, (E * roots) @ turn / np.sqrt(others),
            np.einsum("eij,ef->fij", Ghat / roots[:, None, None], turn * np.sqrt(others)))


@dataclass(frozen=True, eq=False)
class InertiaInvariants:
    """Integrals of the body in its FE axes, about a point near it.

    Coordinates are ``z = (y, eta)`` with ``y = (u_B, psi_B, y_I)`` as in `ReducedBody`; n of y,
    N of z. ``A_k b = e_k x b`` of every nodal vector, ``E_rk`` is the rigid rotation about axis k,
    ``E_t`` the rigid translations. D axes of translation and r of rotation: 3 and 3, in a plane 2
    and 1.

    Parameters
    ----------
    mass : float
        Mass.
    c0 : (D,)
        First moment of mass of the undeformed body [mass length].
    S1 : (D, N)
        ``E_t^T M Phi``: first moment of mass of the deformation.
    J0 : (r, r)
        ``E_rk^T M E_rl``: moments of inertia of the undeformed body.
    g : (r, N)
        ``E_rk^T M Phi``.
    h : (r, r, N)
        ``E_rk^T M A_l Phi``.
    K : (r, N, N)
        ``Phi^T A_k^T M Phi``.
    J2 : (r, r, N, N)
        ``Phi^T A_k^T M A_l Phi``, symmetrised in k and l.
    Mbar : (N, N)
        ``Phi^T M Phi``; its first n rows and columns are the reduced mass.
    Q : (N - n, n, n)
        Symmetric; empty without slaved coordinates.
    lam : (n_e,)
        Elastic eigenvalues of the boundary stiffness whose resultants are of second order.
    E : (n, n_e)
        Their eigenvectors, with zeros for internal modes.
    Ghat : (n_e, n, n)
        Symmetric; empty without geometric stiffness.
    origin : (D,), optional
        The point the integrals are about; the FE origin by default.
    """

    mass: float
    c0: NDArray
    S1: NDArray
    J0: NDArray
    g: NDArray
    h: NDArray
    K: NDArray
    J2: NDArray
    Mbar: NDArray
    Q: NDArray
    lam: NDArray
    E: NDArray
    Ghat: NDArray
    origin: NDArray | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        if self.origin is None:
            object.__setattr__(self, "origin", np.zeros(len(self.c0)))
        for field in fields(self):
            if field.name == "mass":
                continue
            array = np.array(inputs.reals(getattr(self, field.name), f"invariants.{field.name}",
                                          "give an array of real numbers"))
            array.flags.writeable = False
            object.__setattr__(self, field.name, array)

    @property
    def planar(self) -> bool:
        """Tell whether the body lives in the xy plane."""
        return len(self.c0) == 2

    @property
    def slaved(self) -> int:
        """Number of slaved coordinates eta."""
        return len(self.Q)

    @property
    def resultants(self) -> int:
        """Number of stress resultants of second order."""
        return len(self.lam)

    @property
    def stiffens(self) -> bool:
        """Tell if there is anything of second order: stresses of the body change its stiffness."""
        return self.slaved + self.resultants > 0

    @cached_property
    def unstiffened(self) -> "InertiaInvariants":
        """The same body without slaved coordinates and resultants of second order."""
        n = self.Q.shape[1]
        return replace(
            self, S1=self.S1[:, :n], g=self.g[:, :n], h=self.h[..., :n], K=self.K[:, :n, :n],
            J2=self.J2[..., :n, :n], Mbar=self.Mbar[:n, :n], Q=self.Q[:0], lam=self.lam[:0],
            E=self.E[:, :0], Ghat=self.Ghat[:0])

    @property
    def rigidly_followed(self) -> "InertiaInvariants":
        """The same body, with rates of slaved coordinates that count by their rigid part.

        The velocity ``Psi etadot`` is replaced by the rigid motion with the same momentum and
        moment of momentum. What the slaved coordinates are for stays: the work of the loads that
        accelerating, turning and spinning make on them. What goes are products of rates of
        deformation with deformation, in the kinetic energy as ``ydot . M_yeta Q y ydot``. Products
        of this order in the strain energy, which would go with them, are not known: one without
        the other takes energy to high frequencies where a body bends far. Velocities still are
        those of a field, so the kinetic energy is positive, and momenta are the rates of moments
        of mass.
        """
        if not self.slaved:
            return self
        n = self.Q.shape[1]
        moments = axes_cross(self.c0[:, None])[..., 0]     # E_t^T M E_rk, (r, D)
        rigid = np.block([[self.mass * np.eye(len(self.c0)), moments.T], [moments, self.J0]])
        momenta = np.vstack([self.S1, self.g])
        motions = np.linalg.solve(rigid, momenta[:, n:])    # rigid motions of unit rates of eta
        mass, K = np.array(self.Mbar), np.array(self.K)
        mass[:, n:] = momenta.T @ motions
        mass[n:, :n] = mass[:n, n:].T
        turned = np.concatenate([axes_cross(self.S1), self.h.transpose(1, 0, 2)], axis=1)
        K[:, :, n:] = turned.transpose(0, 2, 1) @ motions
        return replace(self, Mbar=mass, K=K)

    def about(self, point: ArrayLike) -> "InertiaInvariants":
        """The same integrals about `point`, (D,) in the FE axes.

        A rigid rotation about the point is ``E_rk - E_t a_k`` with ``a_k = e_k x shift``; the rest
        of the shapes stay.
        """
        point = np.asarray(point, dtype=float)
        shift = point - self.origin
        arms = axes_cross(shift[:, None])[..., 0]      # a_k, (r, D)
        moments = axes_cross(self.c0[:, None])[..., 0]     # E_t^T M E_rk
        return replace(
            self, origin=point, c0=self.c0 - self.mass * shift,
            J0=self.J0 - arms @ moments.T - moments @ arms.T + self.mass * arms @ arms.T,
            g=self.g - arms @ self.S1,
            h=self.h - np.einsum("ki,lin->kln", arms, axes_cross(self.S1)))

    def rotated(self, rotation: ArrayLike, by: ArrayLike) -> "InertiaInvariants":
        """The body rotated about the FE origin, in the old axes.

        Parameters
        ----------
        rotation : (D, D)
            A vector of the body a becomes ``rotation @ a``.
        by : (n, n)
            The same of the reduced coordinates: y becomes ``by @ y``.
        """
        rotation, by = np.asarray(rotation, dtype=float), np.asarray(by, dtype=float)
        axes = np.eye(1) if self.planar else rotation
        whole = np.eye(len(self.Mbar))
        whole[:len(by), :len(by)] = by
        return replace(
            self, origin=rotation @ self.origin, c0=rotation @ self.c0,
            S1=rotation @ self.S1 @ whole.T, J0=axes @ self.J0 @ axes.T, g=axes @ self.g @ whole.T,
            h=np.einsum("ka,lb,abm,nm->kln", axes, axes, self.h, whole, optimize=True),
            K=np.einsum("ka,mi,aij,nj->kmn", axes, whole, self.K, whole, optimize=True),
            J2=np.einsum("ka,lb,mi,abij,nj->klmn", axes, axes, whole, self.J2, whole,
                         optimize=True),
            Mbar=whole @ self.Mbar @ whole.T, Q=by @ self.Q @ by.T, E=by @ self.E,
            Ghat=by @ self.Ghat @ by.T)
