"""Integrals of a body's shapes over its mass: what its kinetic energy in a moving frame needs.

Points of mass carry a displacement and, if they have rotary inertia, a rotation vector; ``A_k``
turns both by a unit rate about axis k. To second order in the rotation vector psi a section turns
with ``omega = Omega_0 - psi x Omega_0 + psi x (psi x Omega_0) / 2 + psidot - psi x psidot / 2``;
the terms of second order in psi belong to K and J2.
"""

from itertools import product

import numpy as np
from numpy.typing import NDArray

from sebody.basics.vectors import skew
from sebody.fem.mass_field import MassField


class MassIntegrals:
    """Integrals about `origin` over the points of a mass field."""

    def __init__(self, field: MassField, origin: NDArray):
        self._field = field
        self._arms = arms = field.points - origin
        count, self.dimension = arms.shape
        self.size = float(np.linalg.norm(arms, axis=1).max())   # of the body
        self.angles = 1 if self.dimension == 2 else 3
        shift = np.broadcast_to(np.eye(self.dimension), (count, self.dimension, self.dimension))
        turn = np.broadcast_to(np.eye(self.angles), (count, self.angles, self.angles))
        still = np.zeros((count, self.angles, self.dimension))
        self._translations = shift, still                       # E_t
        # (e_k x v)_c = turns[k, c, b] v_b
        self._turns = _cross(np.eye(self.dimension)[None])[:, 0]
        self._rotations = _cross(arms[:, :, None])[..., 0].transpose(1, 2, 0), turn     # E_r

    def shapes(self, basis: NDArray) -> tuple[NDArray, NDArray]:
        """Displacements (p, D, m) and rotations (p, r, m) of the points in the columns of basis."""
        count = len(self._field.points)
        moved = (self._field.translation @ basis).reshape(count, self.dimension, -1)
        if self._field.rotation is None:
            return moved, np.zeros((count, self.angles, basis.shape[1]))
        return moved, (self._field.rotation @ basis).reshape(count, self.angles, -1)

    def largest(self, basis: NDArray) -> NDArray:
        """Largest rotation of a point, or displacement over size, of columns of basis, (m,)."""
        moved, turned = self.shapes(basis)
        return np.maximum(np.linalg.norm(moved, axis=1).max(axis=0) / self.size,
                          np.linalg.norm(turned, axis=1).max(axis=0))

    def loads(self) -> NDArray:
        """Forces (n_dofs, 12), planar (n_dofs, 4), of unit accelerations and squared spins.

        ``M E_tk``, ``M E_rk`` and ``A_l^T M E_rk``, symmetrised in k and l: what accelerating,
        turning and spinning the undeformed body does to it; the latter two over its size, so that
        all have the same unit.
        """
        weighed = [self._weighed(rigid) for rigid in (self._translations, self._rotations)]
        spins = self._turned(weighed[1])        # A_l M E_rk: [l][..., k], A_l^T = -A_l
        cases = [*weighed]
        for k in range(self.angles):
            for l in range(k, self.angles):     # noqa: E741
                cases.append(tuple(-(spins[l][part][..., [k]] + spins[k][part][..., [l]]) / 2
                                   for part in (0, 1)))
        moved, turned = (np.concatenate([case[part] for case in cases], axis=2) for part in (0, 1))
        moved[..., self.dimension:] /= self.size
        turned[..., self.dimension:] /= self.size
        forces = self._field.translation.T @ moved.reshape(-1, moved.shape[2])
        if self._field.rotation is not None:
            forces = forces + self._field.rotation.T @ turned.reshape(-1, turned.shape[2])
        return forces

    def isotropic(self) -> NDArray:
        """Factors of the loads that make every direction count alike, in any axes of the body.

        A product of spins about two axes stands for two entries of a symmetric tensor.
        """
        spins = [1.0 if k == l else np.sqrt(2.0)
                 for k in range(self.angles) for l in range(k, self.angles)]  # noqa: E741
        return np.array([1.0] * (self.dimension + self.angles) + spins)

    def integrals(self, basis: NDArray) -> dict[str, NDArray]:
        """All integrals but Mbar's stiffness companions, by the names of `InertiaInvariants`."""
        shapes = self.shapes(basis)
        weighed = self._weighed(shapes)
        rigid_t, rigid_r = self._translations, self._rotations
        weighed_r = self._weighed(rigid_r)
        # a product for every pair of components; turning shapes mixes the pairs
        parts = [np.ascontiguousarray(shapes[0][:, c]) for c in range(self.dimension)]
        loads = [np.ascontiguousarray(weighed[0][:, c]) for c in range(self.dimension)]
        S = np.array([[part.T @ load for load in loads] for part in parts])
        arms = np.array([[weighed_r[0][:, c].T @ part for part in parts]
                         for c in range(self.dimension)])
        turns = self._turns
        values = {
            "c0": self._first_moment(), "S1": self._dot(rigid_t, weighed),
            "J0": self._dot(rigid_r, weighed_r), "g": self._dot(rigid_r, weighed),
            "h": np.einsum("lcb,cbrn->rln", turns, arms),
            "K": np.einsum("kcb,bcmn->kmn", turns, S),
            "J2": np.einsum("kcb,lcd,bdmn->klmn", turns, turns, S, optimize=True),
            "Mbar": np.einsum("ccmn->mn", S),
        }
        if self._field.inertia is not None:
            self._add_rotations(values, shapes[1], weighed[1], weighed_r[1])
        values["J2"] = (values["J2"] + values["J2"].transpose(1, 0, 2, 3)) / 2
        return values

    def _add_rotations(self, found: dict[str, NDArray], psi: NDArray, moments: NDArray,
                       rigid_moments: NDArray) -> None:
        """Add the rotary inertia of the points; in a plane it does not turn."""
        found["Mbar"] = found["Mbar"] + _flat(psi).T @ _flat(moments)
        if self.angles == 1:
            return
        turned = _cross(psi)
        K, J2 = self._second_order(psi)
        weighed = [self._field.inertia @ one for one in turned]
        found["K"] = found["K"] + K + [_flat(one).T @ _flat(moments) for one in turned]
        found["J2"] = found["J2"] + J2 + [[_flat(one).T @ _flat(other) for other in weighed]
                                          for one in turned]
        found["h"] = found["h"] + np.array([_flat(rigid_moments).T @ _flat(one)
                                            for one in turned]).transpose(1, 0, 2)

    def _first_moment(self) -> NDArray:
        places = self._arms[:, :, None], np.zeros((len(self._arms), self.angles, 1))
        return self._dot(self._translations, self._weighed(places))[:, 0]

    def _second_order(self, psi: NDArray) -> tuple[NDArray, NDArray]:
        """Terms of the second-order rotation of the points in K and J2 (none in a plane).

        ``K_k += psi^T skew(J e_k) psi / 2`` and ``J2_kl -= psi^T (X + X^T) psi / 4`` with ``X =
        skew(J e_k)^T skew(e_l) + skew(J e_l)^T skew(e_k)``.
        """
        axes = np.eye(3)
        moment = [skew(self._field.inertia[:, :, k]) for k in range(3)]
        flat = psi.reshape(-1, psi.shape[2])

        def project(matrices: NDArray) -> NDArray:
            return flat.T @ (matrices @ psi).reshape(flat.shape)
        K = np.array([project(moment[k]) / 2 for k in range(3)])
        J2 = np.zeros((3, 3, *K.shape[1:]))
        for k, m in product(range(3), repeat=2):
            X = (moment[k].transpose(0, 2, 1) @ skew(axes[m])
                 + moment[m].transpose(0, 2, 1) @ skew(axes[k]))
            J2[k, m] = -project(X + X.transpose(0, 2, 1)) / 4
        return K, J2

    def _weighed(self, shapes: tuple[NDArray, NDArray]) -> tuple[NDArray, NDArray]:
        moved, turned = shapes
        momentum = (self._field.mass @ moved.reshape(len(moved), -1)).reshape(moved.shape)
        if self._field.inertia is None:
            return momentum, np.zeros_like(turned)
        return momentum, self._field.inertia @ turned

    def _dot(self, first: tuple[NDArray, NDArray], second: tuple[NDArray, NDArray]) -> NDArray:
        """Sum over points of the products of two sets of shapes, (m1, m2)."""
        products = _flat(first[0]).T @ _flat(second[0])
        return products if self._field.inertia is None else products + (
            _flat(first[1]).T @ _flat(second[1]))

    def _turned(self, shapes: tuple[NDArray, NDArray]) -> list[tuple[NDArray, NDArray]]:
        """``A_k`` of the shapes, for every k."""
        moved, turned = shapes
        vectors = _cross(turned) if self.angles == 3 else np.zeros((1, *turned.shape))
        return list(zip(_cross(moved), vectors, strict=True))


def _flat(shapes: NDArray) -> NDArray:
    """Points and components (p, c, m) as rows, (p c, m)."""
    return shapes.reshape(-1, shapes.shape[2])


def _cross(vectors: NDArray) -> NDArray:
    """``e_k x v`` of vectors (p, D, m) for every axis k, (r, p, D, m)."""
    if vectors.shape[1] == 2:
        return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)[None]
    x, y, z = vectors[:, 0], vectors[:, 1], vectors[:, 2]
    zero = np.zeros_like(x)
    return np.array([np.stack(turned, axis=1) for turned in (
        (zero, -z, y), (z, zero, -x), (-y, x, zero))])
