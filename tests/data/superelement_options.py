"""Energies of one superelement after a strong impulse, by inertia option and frame.

The scene is `examples/spherical_beam_strong.py`. Only the reduced matrices are those of the
package; coordinates, velocities and time integration are written again from their definitions:
the Lagrangian T - V of local coordinates y and their velocities, (24) and (34) of the paper, summed
at the middle of each step, and the discrete Euler-Lagrange equations of that sum (a variational
integrator, without numerical damping), with derivatives by complex steps. There is no virtual work,
no tangent and no generalized-alpha scheme in it.

    python tests/data/superelement_options.py

prints the numbers that `sebody/verify/atlas/inertia.py` and `tests/scenes/test_spherical_beam.py`
quote, in some minutes.
"""

import math
import sys

import numpy as np

from sebody.fem import straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes.hinged_beam import SECTION

TIP = np.array([100.0, 100.0, 0.0])
FORMS = (("mean", "frame_axes"), ("node", "material"),
         ("mean", "material"))     # frame, inertia option
STEP, END, AFTER = 0.0025, 30.0, 15.2
TINY = 1e-30            # complex step


def torque(t):
    """About z at the base: up over 2.5, constant to 5, down to 7.5."""
    return 1.2e4 * np.interp(t, [0.0, 2.5, 5.0, 7.5], [0.0, 1.0, 1.0, 0.0])


def strike(t, peak):
    """Along z at the tip."""
    return peak * math.sin(math.pi * (t - 15.0) / 0.1) if 15.0 < t < 15.1 else 0.0


def turn(vector):
    """Rotation matrices of rotation vectors (..., 3), also complex ones."""
    square = (vector * vector).sum(-1)[..., None, None]
    angle = np.sqrt(square + 1e-40)
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    S = np.moveaxis(np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]), (0, 1), (-2, -1))
    return np.eye(3) + np.sin(angle) / angle * S + 2 * (np.sin(angle / 2) / angle)**2 * S @ S


def rotation_vector(R):
    """Inverse of `turn` below half a turn."""
    axis = np.stack([R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0],
                     R[..., 1, 0] - R[..., 0, 1]], -1) / 2
    sine = np.sqrt((axis * axis).sum(-1) + 1e-40)
    cosine = (np.trace(R, axis1=-2, axis2=-1) - 1) / 2
    angle = 2 * np.arctan(sine / (1 + cosine))      # real for real rotations, to the last bit
    return (angle / sine)[..., None] * axis


class Superelement:
    """The beam with its base on a spherical joint: R_1, x_2, R_2 and four modes."""

    def __init__(self, frame, inertia):
        fe_model = straight_beam((0, 0, 0), TIP, SECTION, 20)
        body = craig_bampton(fe_model, [(0, "full"), (20, "full")], 4)
        self.M, self.S, self.n = body.mass, body.stiffness, len(body.mass) - 3
        self.frame, self.inertia = frame, inertia

    def moved(self, q, z):
        """A configuration (R_1, x_2, R_2, modes) with a variation (..., n)."""
        R1, x2, R2, modes = q
        return (R1 @ turn(z[..., :3]), x2 + z[..., 3:6], R2 @ turn(z[..., 6:9]),
                modes + z[..., 9:])

    def energies(self, before, after, h):
        """T and V at the middle of a step."""
        phi1, phi2 = (rotation_vector(np.swapaxes(before[k], -1, -2) @ after[k]) for k in (0, 2))
        R1, R2 = before[0] @ turn(phi1 / 2), before[2] @ turn(phi2 / 2)
        x2, modes = (before[1] + after[1]) / 2, (before[3] + after[3]) / 2
        between = rotation_vector(np.swapaxes(R1, -1, -2) @ R2)
        share = 0.5 if self.frame == "mean" else 0.0      # of the way from node 1 to node 2
        R0 = R1 @ turn(share * between)
        to_frame = np.swapaxes(R0, -1, -2)
        arm = (to_frame @ x2[..., None])[..., 0] - TIP
        velocity = (to_frame @ ((after[1] - before[1]) / h)[..., None])[..., 0]
        spins = [phi1 / h, phi2 / h]
        if self.inertia == "frame_axes":
            spins = [(to_frame @ R @ spin[..., None])[..., 0]
                     for R, spin in zip((R1, R2), spins, strict=True)]
        y = np.concatenate(np.broadcast_arrays(
            -share * arm, (1 - share) * arm, -share * between, (1 - share) * between), -1)
        y = np.concatenate([y, modes], -1)
        rate = np.concatenate([0 * velocity, velocity, *spins, (after[3] - before[3]) / h], -1)
        return ((rate @ self.M) * rate).sum(-1) / 2, ((y @ self.S) * y).sum(-1) / 2

    def slopes(self, before, after, h, of_after):
        """Derivatives of h (T - V) of a step in the configuration at its end or beginning."""
        steps = 1j * TINY * np.eye(self.n)
        ends = [tuple(part[..., None, :, :] if k in (0, 2) else part[..., None, :]
                      for k, part in enumerate(q)) for q in (before, after)]
        ends[of_after] = self.moved(ends[of_after], steps)
        T, V = self.energies(*ends, h)
        return h * (T - V).imag / TINY

    def loads(self, q, t, peak):
        """Generalised forces."""
        force = np.zeros(self.n)
        force[:3] = q[0].real.T @ [0.0, 0.0, torque(t)]
        force[5] = strike(t, peak)
        return force


def run(frame, inertia, peak, h=STEP, t_end=END):
    """Times, kinetic and strain energies at the middles of the steps."""
    beam = Superelement(frame, inertia)
    q = (np.eye(3), TIP.copy(), np.eye(3), np.zeros(beam.n - 9))
    p, z, jacobian, found = np.zeros(beam.n), np.zeros(beam.n), None, []
    for k in range(round(t_end / h)):
        push = p + h / 2 * beam.loads(q, k * h, peak)
        for iteration in range(40):
            if jacobian is None or iteration % 8 == 7:
                jacobian = _jacobian(beam, q, z, h)
            rest = push + beam.slopes(q, beam.moved(q, z), h, False)
            step = np.linalg.solve(jacobian, rest)
            z = z - step
            if np.abs(step).max() < 1e-10:
                break
        else:
            raise RuntimeError(f"no convergence at t = {k * h}")
        if iteration > 4:
            jacobian = None
        after = beam.moved(q, z)
        T, V = beam.energies(q, after, h)
        found.append(((k + 0.5) * h, T.real, V.real))
        p = beam.slopes(q, after, h, True) + h / 2 * beam.loads(after, (k + 1) * h, peak)
        q = after
    return np.array(found).T


def _jacobian(beam, q, z, h, size=1e-6):
    """Of the slopes in the variation of the end, by central differences."""
    around = [beam.slopes(q, beam.moved(q, z + s * size * np.eye(beam.n)), h, False)
              for s in (1, -1)]
    return (around[0] - around[1]).T / (2 * size)


def main():
    """Print energies after the impulse and the largest strain energy."""
    peak = float(sys.argv[1]) if len(sys.argv) > 1 else 2800.0
    print("frame  option  energy at 15.2  largest strain energy")
    for frame, inertia in FORMS:
        t, T, V = run(frame, inertia, peak)
        print(f"{frame:5}  {inertia:6}  {np.interp(AFTER, t, T + V):14.1f}  {V.max():10.1f}",
              flush=True)


if __name__ == "__main__":
    main()
