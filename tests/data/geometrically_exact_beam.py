"""Reference histories of beams on joints, from a geometrically exact beam.

The model is the Simo-Reissner beam: centre line x(s), section rotation R(s), strains
Gamma = R^T x' - E1 and kappa = axial(R^T R'), shear and rotary inertia included.  Nothing is shared
with the superelements: no reduction, no floating frame, no implicit solver.

Space: Lagrange elements on Gauss-Lobatto points, which serve as quadrature points as well, so the
mass is diagonal.  The quaternion components are interpolated; vec(2 conj(q) q') at a node is then
the exact curvature of the normalised field there, and a rigid rotation leaves it unchanged.
Time: classical Runge-Kutta below its stability limit, external work integrated alongside.

Run ``python geometrically_exact_beam.py`` to rewrite the npz files.
"""

from collections import namedtuple
from functools import partial
from pathlib import Path
from time import perf_counter

import numba
import numpy as np
from numpy.polynomial import legendre

DENSITY, YOUNG, POISSON = 7.8e-3, 2.1e6, 0.3
AREA, INERTIA, TORSION_CONSTANT, SHEAR_FACTOR = 9.0, 6.75, 11.387, 5.0 / 6.0
SHEAR = YOUNG / (2.0 * (1.0 + POISSON))
# Section stiffness and inertia along the axis (first entry) and across it.
FORCE_STIFFNESS = np.array([YOUNG, SHEAR_FACTOR * SHEAR, SHEAR_FACTOR * SHEAR]) * AREA
MOMENT_STIFFNESS = np.array([SHEAR * TORSION_CONSTANT, YOUNG * INERTIA, YOUNG * INERTIA])
SECTION_INERTIA = DENSITY * INERTIA * np.array([2.0, 1.0, 1.0])
# Columns of the state, one row a node: position, quaternion, velocity, body angular velocity.
POSITION, QUATERNION, VELOCITY, SPIN = slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)
HINGE = np.array([0.0, 0.0, 1.0])  # free rotations of the base, body axes: z only
SPHERICAL = np.ones(3)
FOLDER = Path(__file__).parents[2] / "sebody" / "verify" / "references"


# Equal elements on a straight beam: arc length and summed quadrature weights of the nodes, then
# d/ds and quadrature weights at the points of one element.
Mesh = namedtuple("Mesh", "s nodal derivative weights")


def make_mesh(length, elements, order):
    """Return the `Mesh` of a beam cut into elements of polynomial degree `order`."""
    basis = legendre.Legendre.basis(order)
    points = np.concatenate(([-1.0], np.sort(basis.deriv().roots().real), [1.0]))
    values = basis(points)
    derivative = values[:, None] / values / (points[:, None] - points + np.eye(order + 1))
    np.fill_diagonal(derivative, 0.0)
    derivative -= np.diag(derivative.sum(axis=1))  # a constant has no derivative, to round-off
    half = 0.5 * length / elements
    weights = half * 2.0 / (order * (order + 1) * values**2)
    s, nodal = np.zeros((2, elements * order + 1))
    for element in range(elements):
        nodes = slice(element * order, (element + 1) * order + 1)
        s[nodes] = half * (2 * element + 1 + points)
        nodal[nodes] += weights
    return Mesh(s, nodal, derivative / half, weights)


def stable_step(mesh):
    """Return a safe Runge-Kutta step, 2 / omega_max (the limit is 2.83 / omega_max).

    The element eigenvalue bounds that of the mesh; the second term is the shear-rotation cutoff.
    """
    stiffness = mesh.derivative.T @ (mesh.weights[:, None] * mesh.derivative)
    wave = np.linalg.eigvals(stiffness / mesh.weights[:, None]).real.max() * YOUNG / DENSITY
    return 2.0 / np.sqrt(wave + SHEAR_FACTOR * SHEAR * AREA / (DENSITY * INERTIA))


@numba.njit(inline="always")
def quat_mul(a, b, out):
    """Write the quaternion product a b (scalar first) to `out`."""
    out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]
    out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2]
    out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1]
    out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]


@numba.njit(inline="always")
def relative(a, b, out):
    """Write the vector part of the quaternion product conj(a) b to `out`."""
    out[0] = a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2]
    out[1] = a[0] * b[2] - a[2] * b[0] - a[3] * b[1] + a[1] * b[3]
    out[2] = a[0] * b[3] - a[3] * b[0] - a[1] * b[2] + a[2] * b[1]


@numba.njit(inline="always")
def cross(a, b, out):
    """Write the vector product a x b to `out`."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@numba.njit(inline="always")
def rotate(q, sign, v, out):
    """Write R v (sign 1) or R^T v (sign -1) to `out`, R the rotation of the unit quaternion `q`."""
    x, y, z = sign * q[1], sign * q[2], sign * q[3]
    a = 2.0 * (y * v[2] - z * v[1])
    b = 2.0 * (z * v[0] - x * v[2])
    c = 2.0 * (x * v[1] - y * v[0])
    out[0] = v[0] + q[0] * a + y * c - z * b
    out[1] = v[1] + q[0] * b + z * a - x * c
    out[2] = v[2] + q[0] * c + x * b - y * a


@numba.njit
def internal_forces(state, mesh, force, moment, gradient):
    """Return the strain energy; write the nodal forces and moments that come from it.

    `force` is in inertial axes.  `moment`, in body axes, is that of stretch and shear only;
    `gradient` is the derivative of the energy of curvature in the quaternions as free 4-vectors.
    """
    order = mesh.weights.size - 1
    force[:], moment[:], gradient[:] = 0.0, 0.0, 0.0
    slope, bend, couple = np.empty(7), np.empty(4), np.zeros(4)
    stretch, curvature, stress, turned = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    energy = 0.0
    for point in range(mesh.weights.size * ((state.shape[0] - 1) // order)):
        i, start = point % (order + 1), point // (order + 1) * order
        q = state[start + i, 3:7]
        slope[:] = 0.0
        for j in range(order + 1):
            for c in range(7):
                slope[c] += mesh.derivative[i, j] * state[start + j, c]
        rotate(q, -1.0, slope[:3], stretch)
        relative(q, slope[3:], curvature)
        for c in range(3):
            strain, bent = stretch[c] - (1.0 if c == 0 else 0.0), 2.0 * curvature[c]
            stress[c] = mesh.weights[i] * FORCE_STIFFNESS[c] * strain
            couple[c + 1] = mesh.weights[i] * MOMENT_STIFFNESS[c] * bent
            energy += 0.5 * (stress[c] * strain + couple[c + 1] * bent)
        cross(stretch, stress, turned)
        moment[start + i] += turned
        quat_mul(slope[3:], couple, bend)
        gradient[start + i] -= 2.0 * bend
        rotate(q, 1.0, stress, turned)
        quat_mul(q, couple, bend)
        for j in range(order + 1):
            for c in range(3):
                force[start + j, c] -= mesh.derivative[i, j] * turned[c]
            for c in range(4):
                gradient[start + j, c] += 2.0 * mesh.derivative[i, j] * bend[c]
    return energy


@numba.njit
def rate(state, torque, lift, free, mesh, out):
    """Write the time derivative of `state` to `out`; return strain energy and load power.

    `torque` is about the inertial z axis at the base, `lift` along it at the tip; `free` selects
    the rotations that the joint at the base leaves free.
    """
    n = state.shape[0]
    force, moment, gradient = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 4))
    energy = internal_forces(state, mesh, force, moment, gradient)
    spin, part, gyro = np.zeros(4), np.empty(3), np.empty(3)
    rotate(state[0, 3:7], -1.0, np.array([0.0, 0.0, torque]), part)
    moment[0] += part
    force[-1, 2] += lift
    power = lift * state[-1, 9] + np.sum(part * state[0, 10:13])
    for k in range(n):
        spin[1:] = state[k, 10:13]
        quat_mul(state[k, 3:7], 0.5 * spin, out[k, 3:7])
        # A body rotation d moves q by q (0, d) / 2, so its moment is -vec(conj(q) G) / 2.
        relative(state[k, 3:7], gradient[k], part)
        cross(spin[1:], SECTION_INERTIA * spin[1:], gyro)
        out[k, 0:3] = state[k, 7:10]
        out[k, 7:10] = force[k] / (mesh.nodal[k] * DENSITY * AREA)
        out[k, 10:13] = ((moment[k] - 0.5 * part) / mesh.nodal[k] - gyro) / SECTION_INERTIA
    out[0, 7:10] = 0.0
    out[0, 10:13] *= free
    return energy, power


@numba.njit
def advance(state, step, torque, lift, free, mesh):
    """Advance `state` by one Runge-Kutta step; return the strain energy before it and the work.

    The loads hold three samples: start, middle and end of the step.
    """
    trial, total, slope = state.copy(), state.copy(), np.empty_like(state)
    before, work = 0.0, 0.0
    for stage in range(4):
        at = (stage + 1) // 2
        energy, power = rate(trial, torque[at], lift[at], free, mesh, slope)
        before = energy if stage == 0 else before
        share = step / 6.0 if stage in (0, 3) else step / 3.0
        total += share * slope
        work += share * power
        trial[:] = state + (step if stage == 2 else 0.5 * step) * slope
    for n in range(state.shape[0]):
        total[n, 3:7] /= np.sqrt(np.sum(total[n, 3:7] ** 2))
    state[:] = total
    return before, work


@numba.njit
def integrate(state, step, substeps, torque, lift, free, mesh):
    """Return states, strain energy and work at every `substeps`-th step, and peak strain energy.

    The loads are sampled every half step, with one step more than is asked for, because the
    strain energy of a state is known only once the next step starts.
    """
    steps = (torque.size - 1) // 2
    samples = (steps - 1) // substeps + 1
    states = np.empty((samples, state.shape[0], 13))
    strain, work = np.empty(samples), np.empty(samples)
    done, peak = 0.0, 0.0
    for k in range(steps):
        row, now = k // substeps, slice(2 * k, 2 * k + 3)
        if k % substeps == 0:
            states[row], work[row] = state, done
        energy, gained = advance(state, step, torque[now], lift[now], free, mesh)
        if k % substeps == 0:
            strain[row] = energy
        done, peak = done + gained, max(peak, energy)
    return states, strain, work, peak


def simulate(mesh, direction, free, torque, lift, end, interval):
    """Simulate a beam at rest, its base held by a joint at the origin.

    Parameters
    ----------
    mesh : Mesh
        See `make_mesh`.
    direction : float
        Angle of the beam from x to y at the start.
    free : ndarray, shape (3,)
        `HINGE` or `SPHERICAL`.
    torque, lift : callable
        Torque about inertial z at the base and force along it at the tip, of an array of times.
        Kinks should fall on multiples of `interval`.
    end, interval : float
        Duration and output interval.

    Returns
    -------
    dict of ndarray
        t, tip_position, base_angular_velocity (inertial axes), kinetic, strain, external_work,
        angular_momentum (about the joint, inertial axes), peak_strain (largest of all steps).
    """
    state = np.zeros((mesh.s.size, 13))
    state[:, 0], state[:, 1] = mesh.s * np.cos(direction), mesh.s * np.sin(direction)
    state[:, 3], state[:, 6] = np.cos(0.5 * direction), np.sin(0.5 * direction)
    samples = round(end / interval)
    substeps = int(np.ceil(interval / stable_step(mesh)))
    step = interval / substeps
    times = 0.5 * step * np.arange(2 * samples * substeps + 3)
    loads = torque(times), lift(times)
    states, strain, work, peak = integrate(state, step, substeps, *loads, free, mesh)
    history = {"t": np.linspace(0.0, end, samples + 1), **observe(states, mesh)}
    return {**history, "strain": strain, "external_work": work, "peak_strain": np.array(peak)}


def observe(states, mesh):
    """Return tip, base angular velocity, kinetic energy and angular momentum of `states`."""
    q, velocity, spin = states[..., QUATERNION], states[..., VELOCITY], states[..., SPIN]
    mass = DENSITY * AREA * mesh.nodal[:, None]
    inertia = SECTION_INERTIA * mesh.nodal[:, None]
    kinetic = 0.5 * np.sum(mass * velocity**2 + inertia * spin**2, axis=(1, 2))
    momentum = mass * np.cross(states[..., POSITION], velocity) + turn(q, inertia * spin)
    return {
        "tip_position": states[:, -1, POSITION],
        "base_angular_velocity": turn(q[:, 0], spin[:, 0]),
        "kinetic": kinetic,
        "angular_momentum": momentum.sum(axis=1),
    }


def turn(q, v):
    """Return the vectors `v` turned by the unit quaternions `q`."""
    twice = 2.0 * np.cross(q[..., 1:], v)
    return v + q[..., :1] * twice + np.cross(q[..., 1:], twice)


def piecewise_linear(times, values):
    """Return the function of time that joins the given points, constant outside."""
    return lambda t: np.interp(t, times, values)


def half_sine(peak, start=15.0, duration=0.1):
    """Return the function of time ``peak * sin(pi (t - start) / duration)``, zero outside."""
    return lambda t: peak * np.sin(np.pi * np.clip((t - start) / duration, 0.0, 1.0))


STRONG_TORQUE = piecewise_linear([0.0, 2.5, 5.0, 7.5], [0.0, 1.2e4, 1.2e4, 0.0])
PAPER_TORQUE = piecewise_linear([0.0, 0.2, 10.0, 10.2], [0.0, 200.0, 200.0, 0.0])
PAPER_LIFT = piecewise_linear([15.0, 15.2, 15.4], [0.0, 100.0, 0.0])
STRONG_LENGTH, PAPER_LENGTH = 100.0 * np.sqrt(2.0), 141.42


def hinged_beam(elements=8, order=4, interval=0.01):
    """Return the history of the hinged beam under the strong torque."""
    mesh = make_mesh(STRONG_LENGTH, elements, order)
    return simulate(mesh, np.pi / 4, HINGE, STRONG_TORQUE, np.zeros_like, 30.0, interval)


def strong_beam(peak, elements=8, order=6, interval=0.05):
    """Return the history on a spherical joint, strong torque, then a tip impulse (`half_sine`)."""
    mesh = make_mesh(STRONG_LENGTH, elements, order)
    return simulate(mesh, np.pi / 4, SPHERICAL, STRONG_TORQUE, half_sine(peak), 30.0, interval)


def paper_beam(elements=8, order=4, interval=0.05):
    """Return the history on a spherical joint under the loads of the published example."""
    mesh = make_mesh(PAPER_LENGTH, elements, order)
    return simulate(mesh, 0.0, SPHERICAL, PAPER_TORQUE, PAPER_LIFT, 30.0, interval)


def report(name, history, seconds):
    """Print the energy balance and the energies of one run."""
    total = history["kinetic"] + history["strain"]
    error = np.abs(total - history["external_work"]).max() / total.max()
    print(f"{name}: {seconds:.0f} s, energy balance {error:.1e} of the largest energy,")
    print(f"    final energy {total[-1]:.8g}, peak strain energy {history['peak_strain']:.8g}")


def main():
    """Run all scenes and write their npz files."""
    scenes = {
        "hinged_beam": {"": hinged_beam},
        "spherical_beam_strong": {
            f"_{peak}": partial(strong_beam, float(peak)) for peak in (700, 2800)
        },
        "spherical_beam": {"": paper_beam},
    }
    for name, runs in scenes.items():
        stored = {}
        for suffix, run in runs.items():
            start = perf_counter()
            history = run()
            report(name + suffix, history, perf_counter() - start)
            stored["t"] = history.pop("t")
            # Rounding to single precision is far below the discretisation error of this one.
            omega = history["base_angular_velocity"]
            history["base_angular_velocity"] = omega.astype(np.float32)
            stored.update({key + suffix: value for key, value in history.items()})
        np.savez_compressed(FOLDER / f"{name}.npz", **stored)


if __name__ == "__main__":
    main()
