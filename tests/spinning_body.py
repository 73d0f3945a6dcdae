"""A body in the frame of its first node, from its constants alone: spin, loads, small motion.

The frame is held, or spins steadily, so its energy needs no kinematics: ``L = zdot^T Mbar zdot / 2
+ Omega . B(z) zdot + Omega . J(z) Omega / 2 - V(y)`` with ``z = (y, eta(y))``.
"""

import numpy as np

from sebody.fem import StiffnessSection, hexahedral_block, straight_beam
from sebody.reduction import RigidFace, component_modes, craig_bampton

SLENDER = StiffnessSection(axial=1e5, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=2e-7, inertia_y=1e-7, inertia_z=1e-7)
CLAMPED = [0, 1, 2, 6, 7, 8]    # node 0 of a beam with two full boundary nodes


def cantilever(section=SLENDER, modes=4, elements=24, select=None):
    model = straight_beam([0, 0, 0], [1, 0, 0], section, elements)
    return craig_bampton(model, [(0, "full"), (elements, "full")], modes, select)


def with_torsion(section, elements, bending, torsion):
    """Two-node body with lateral bending and torsion modes."""
    model = straight_beam([0, 0, 0], [1, 0, 0], section, elements)
    rows = np.r_[0:3, 6 * elements:6 * elements + 3, 3:6, 6 * elements + 3:6 * elements + 6]
    modes = component_modes(model.stiffness, model.mass, rows, 3 * elements).fixed_interface
    size = np.abs(modes.reshape(elements + 1, 6, -1)).max(axis=0)
    kinds = np.array([size[1], size[2], 1e-3 * size[3]]).argmax(axis=0)
    chosen = [*np.flatnonzero(kinds == 0)[:bending], *np.flatnonzero(kinds == 2)[:torsion]]
    return craig_bampton(model, [(0, "full"), (elements, "full")], 3 * elements, sorted(chosen))


class Spinning:
    """A body in the frame of its first node, at FE coordinates zero, which spins steadily."""

    def __init__(self, body, spin, held, stiffened=True):
        i = body.invariants.about(np.zeros(len(body.invariants.c0)))
        n = len(body.mass)
        self.Q, self.lam, self.E, self.Ghat = (i.Q, i.lam, i.E.T, i.Ghat)
        if not stiffened:
            self.Q, self.lam, self.E, self.Ghat = i.Q[:0], i.lam[:0], i.E.T[:0], i.Ghat[:0]
        N = n + len(self.Q)
        self.h = (i.h + i.h.transpose(1, 0, 2))[..., :N]
        self.J2 = (i.J2 + i.J2.transpose(0, 1, 3, 2))[..., :N, :N]
        self.K, self.g, self.S1 = i.K[:, :N, :N], i.g[:, :N], i.S1[:, :N]
        self.M, self.J0, self.spin, self.n = i.Mbar[:N, :N], i.J0, np.asarray(spin, float), n
        self.stiffness = body.stiffness - (self.E.T * self.lam) @ self.E
        self.free = np.setdiff1d(np.arange(n), held)

    def gradient(self, y, load, gravity):
        """Forces and stiffness of y: elastic, centrifugal, fixed-direction loads and weight."""
        z = np.concatenate([y, self.Q @ y @ y / 2])
        Z = np.vstack([np.eye(self.n), self.Q @ y])
        W = self.spin
        force = -(np.einsum("k,l,kln->n", W, W, self.h) + np.einsum(
            "k,l,klmn,n->m", W, W, self.J2, z)) / 2 - self.S1.T @ gravity
        s = self.lam * (self.E @ y) + self.Ghat @ y @ y / 2
        a = self.lam[:, None] * self.E + self.Ghat @ y
        elastic = self.stiffness @ y + (s / self.lam) @ a
        tangent = (self.stiffness + a.T @ (a / self.lam[:, None])
                   + np.tensordot(s / self.lam, self.Ghat, 1)
                   - Z.T @ np.einsum("k,l,klmn->mn", W, W, self.J2) @ Z / 2
                   + np.tensordot(force[self.n:], self.Q, 1))
        return Z.T @ force + elastic - load, tangent, z, Z

    def equilibrium(self, load=None, gravity=None, start=None):
        """Mass, gyroscopic matrix, stiffness of the free coordinates; z and Z."""
        load = np.zeros(self.n) if load is None else load
        gravity = np.zeros(len(self.S1)) if gravity is None else gravity
        y, grid = np.zeros(self.n), np.ix_(self.free, self.free)
        if start is not None:
            y[:] = start
        for _ in range(30):
            force, tangent, z, Z = self.gradient(y, load, gravity)
            step = np.linalg.solve(tangent[grid], force[self.free])
            y[self.free] -= step
            if np.abs(step).max() <= 1e-12 * np.abs(y).max():
                break
        turning = np.tensordot(self.spin, self.K.transpose(0, 2, 1) - self.K, 1)
        return (Z.T @ self.M @ Z)[grid], (Z.T @ turning @ Z)[grid], tangent[grid], z, Z


def roots(M, C, K):
    """Eigenvalues of M a + C v + K x = 0 with positive imaginary parts by size; their growth."""
    n = len(M)
    values = np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)],
                                         [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]]))
    return np.sort(values.imag[values.imag > 0]), values.real.max()


def strip(thickness, elements=20):
    """Slender solid, tied to a node at each end."""
    model = hexahedral_block([0, -thickness / 2, -1], [40, thickness, 2], (elements, 1, 2), 1e6,
                             0.3, 1.0)
    x = model.coordinates[:, 0]
    ends = [RigidFace((place, 0.0, 0.0), tuple(np.flatnonzero(x == place))) for place in (0, 40)]
    return model, ends


def turned_resultants(body):
    """Resultants of interfaces of a body that turns as a whole, over the largest part to cancel.

    Those of internal modes vanish if the modes take the part of the second order that is theirs.
    """
    i = body.invariants
    count = len(body.position_nodes)
    psi = np.array([0.3, -0.8, 0.5])
    arms = body.coordinates[list(body.position_nodes)] - i.origin
    first = np.cross(psi, arms)
    second = np.concatenate([(np.cross(psi, first) / 2).ravel(),
                             np.zeros(len(body.mass) - 3 * count)])
    y = body.rigid_modes_about(i.origin)[:, 3:] @ psi
    own = i.E[:len(y) - body.modes].any(axis=0)
    parts = (i.lam * (i.E.T @ second))[own], (i.Ghat @ y @ y / 2)[own]
    return np.abs(sum(parts)) / np.abs(parts).max()
