"""Bodies with many interfaces under loads, for what leaving resultants out of them changes."""

from dataclasses import replace
from typing import NamedTuple
from unittest.mock import patch

import numpy as np
from numpy.linalg import LinAlgError
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation
from spinning_body import Spinning, roots

from sebody.fem import StiffnessSection, frame, hexahedral_block
from sebody.reduction import RigidFace, craig_bampton, stiffening

TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
ENDS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.3, 0.6, 0.1], [0.9, -0.7, 0.2],
                 [0.2, 0.5, 0.5]])
HUB = np.array([0.6, 0.05, 0.1])
FREQUENCIES = 6         # lowest ones that are compared


def arms(bending=1.6, axial=1e5, unit=1.0):
    """Section of the frames, in any unit of length."""
    return StiffnessSection(axial=axial, bending_y=unit**2, bending_z=bending * unit**2,
                            torsion=0.8 * unit**2, mass=1.0,
                            inertia_x=(1 + bending) * 1e-6 * unit**2,
                            inertia_y=1e-6 * unit**2, inertia_z=bending * 1e-6 * unit**2)


def star(modes, ends=ENDS, hub=HUB, turn=TURN, unit=1.0, order=None, **section):
    """Arms in space that meet in a hub, with an interface at each end."""
    order = range(len(ends)) if order is None else order
    points = unit * np.vstack([hub, ends]) @ turn.T
    model = frame(points, [(0, 1 + k) for k in range(len(ends))], arms(unit=unit, **section), 6,
                  up=turn[:, 2])
    return craig_bampton(model, [(1 + k, "full") for k in order], modes)


def random_star(modes, seed, count=5, **section):
    """The same with arms of random directions and lengths."""
    random = np.random.default_rng(seed)
    ends = random.normal(size=(count, 3))
    ends *= random.uniform(0.4, 1.2, (count, 1)) / np.linalg.norm(ends, axis=1, keepdims=True)
    return star(modes, ends, np.zeros(3), **section)


def ring(modes, count=6):
    """A closed frame that is not flat, with interfaces all around."""
    angles = np.arange(12) * np.pi / 6
    points = np.column_stack([np.cos(angles), 0.7 * np.sin(angles), 0.1 * np.sin(2 * angles)])
    model = frame(points @ TURN.T, [(k, (k + 1) % 12) for k in range(12)], arms(), 3,
                  up=TURN[:, 2])
    return craig_bampton(model, [(12 // count * k, "full") for k in range(count)], modes)


def patched_block(modes, thickness, layers):
    """A plate, or a block, of hexahedra with five rigid patches."""
    model = hexahedral_block((0, -0.25, -thickness / 2), (1.0, 0.5, thickness), (10, 5, layers),
                             1e6, 0.3, 1.0)
    faces = []
    for k, place in enumerate(((0, -0.25), (0, 0.25), (1, -0.25), (1, 0.25), (0.5, 0.05))):
        height = 0.0 if layers == 1 else thickness / 2 * (-1) ** (k + 1)
        near = (np.abs(model.coordinates[:, :2] - place) < 0.101).all(axis=1)
        if layers > 1:
            near &= np.isclose(model.coordinates[:, 2], height)
        faces.append(RigidFace((*place, height), tuple(np.flatnonzero(near))))
    return craig_bampton(model, [(face, "full") for face in faces], modes).rotated(TURN)


def with_all(make, *arguments, **options):
    """The body that `make` makes, with all its resultants."""
    with patch.object(stiffening, "_MANY", 1000), patch.object(stiffening, "_WEAK", 0.0):
        return make(*arguments, **options)


def without_any(body):
    """It without resultants: its load modes stay."""
    i = body.invariants
    return replace(body, invariants=replace(i, lam=i.lam[:0], E=i.E[:, :0], Ghat=i.Ghat[:0]))


class Case(NamedTuple):
    """Nodes that are held, spin, and forces on the reduced coordinates."""

    held: tuple[int, ...]
    spin: np.ndarray
    load: np.ndarray


def coordinates_of(body, nodes):
    """Reduced coordinates of full nodes."""
    first = 3 * len(body.coordinates)
    return np.concatenate([np.r_[3 * k:3 * k + 3, first + 3 * k:first + 3 * k + 3] for k in nodes])


def motion(body, y):
    """Largest rotation of a boundary node, or displacement over the size of the body."""
    count = len(body.coordinates)
    size = np.linalg.norm(body.coordinates - body.coordinates.mean(axis=0), axis=1).max()
    moved, turned = y[:6 * count].reshape(2, count, 3)
    return max(np.linalg.norm(moved, axis=1).max() / size, np.linalg.norm(turned, axis=1).max())


def loaded(body, case, share=1.0):
    """Coordinates and lowest frequencies under a share of the loads, which grow step by step."""
    for steps in (4, 16, 64):       # where a step is too large, iterations run away
        y, frequencies = _loaded(body, case, share, steps)
        if motion(body, y) < 1.0:
            break
    return y, frequencies


def _loaded(body, case, share, steps):
    held, y = coordinates_of(body, case.held), None
    for part in np.linspace(share / steps, share, steps):
        at = Spinning(body, np.sqrt(part) * case.spin, held)
        mass, turning, stiffness, z, _ = at.equilibrium(part * case.load, start=y)
        y = z[:at.n]
    return y, roots(mass, turning, stiffness)[0][:FREQUENCIES]


def cases(body, seed, spins=4, loads=4, largest=0.1):
    """Spins about random axes and forces or moments on random nodes, of nodes held in four ways.

    They move the body, with all its resultants, by up to `largest` of its size.
    """
    random, found = np.random.default_rng(seed), []
    count, n = len(body.coordinates), len(body.mass)
    for held in ((0,), (2,), (0, 3), (1, 2)):
        free = np.setdiff1d(np.arange(n), coordinates_of(body, held))
        K, M = (matrix[np.ix_(free, free)] for matrix in (body.stiffness, body.mass))
        first = np.sqrt(eigh(K, M, eigvals_only=True, subset_by_index=(0, 0))[0])
        for _ in range(spins):
            axis = random.normal(size=3)
            found.append(Case(held, 0.6 * first * axis / np.linalg.norm(axis), np.zeros(n)))
        for kind in range(loads):
            node = random.choice([k for k in range(count) if k not in held])
            at, load, y = coordinates_of(body, [node]), np.zeros(n), np.zeros(n)
            load[at[3 * (kind % 2):][:3]] = random.normal(size=3)
            y[free] = np.linalg.solve(K, load[free])
            found.append(Case(held, np.zeros(3), 0.8 * largest / motion(body, y) * load))
    return [limited(body, case, largest) for case in found]


def limited(body, case, largest):
    """The case with smaller loads, if it moves the body further than allowed."""
    share = 1.0
    for _ in range(8):
        moved = motion(body, loaded(body, case, share)[0])
        if moved < 1.02 * largest:
            break
        share *= largest / moved
    return Case(case.held, np.sqrt(share) * case.spin, share * case.load)


def errors(body, whole, given):
    """Largest relative error of a frequency, and that of the motion, of every case, (k, 2)."""
    found = []
    for case in given:
        exact, expected = loaded(whole, case)
        try:
            y, frequencies = loaded(body, case)
        except LinAlgError:
            found.append((np.inf, np.inf))
            continue
        found.append((np.abs(frequencies / expected - 1).max(),
                      motion(body, y - exact) / motion(body, exact)))
    return np.array(found)
