"""Free frames of slender members that spin and are struck: one body each, and nonlinear beams.

They turn fast and bend far enough for everything of second order to matter, and their members carry
vibrations that ordinary steps do not resolve. Nothing but the blow does work, so their energy is
constant once it is over.
"""

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from sebody import (
    InputError,
    LimitWarning,
    Model,
    SimulationError,
    generalized_alpha,
    simulate,
)
from sebody.fem import Section, frame
from sebody.reduction import craig_bampton

SECTION = Section(area=1e-4, inertia_y=8e-10, inertia_z=8e-10, torsion=1.6e-9, youngs_modulus=7e10,
                  poisson_ratio=0.3, density=2700.0)
TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
OVER = 0.01         # time after which no force acts
RISE = 0.002        # of the force, and its fall
ELEMENTS = 8        # of each member, in the body


class Struck(NamedTuple):
    """A frame, how it turns and how it is struck."""

    points: NDArray                         # (n, 3)
    members: list[tuple[int, int]]
    kept: list[int]                         # points that are boundary nodes
    modes: int = 12
    section: Section = SECTION
    spin: tuple[float, float, float] = (1.0, -2.0, 15.0)
    forces: NDArray | None = None           # (kept, 3); of size 60 in random directions by default
    seed: int = 0

    def body(self):
        """The frame as one reduced body."""
        model = frame(self.points, self.members, self.section, ELEMENTS)
        return craig_bampton(model, [(k, "full") for k in self.kept], self.modes)

    def blows(self) -> NDArray:
        """Forces on the boundary nodes."""
        if self.forces is not None:
            return self.forces
        directions = np.random.default_rng(self.seed).normal(size=(len(self.kept), 3))
        return 60.0 * directions / np.linalg.norm(directions, axis=1, keepdims=True)

    def model(self, body=None, **options) -> Model:
        """As one superelement."""
        model = Model()
        nodes = [model.node(f"p{k}", self.points[k]) for k in self.kept]
        model.superelement("frame", self.body() if body is None else body, nodes, **options)
        return self._started(model)

    def beams(self, elements: int | None = None) -> Model:
        """As nonlinear beams, of as many unknowns as the body unless told otherwise."""
        if elements is None:
            unknowns = 6 * len(self.kept) + self.modes
            elements = max(2, 1 + round((unknowns / 6 - len(self.points)) / len(self.members)))
        model = Model()
        nodes = [model.node(f"p{k}", point) for k, point in enumerate(self.points)]
        for k, (start, end) in enumerate(self.members):
            model.beam(f"member {k}", (nodes[start], nodes[end]), self.section, elements)
        return self._started(model)

    def _started(self, model: Model) -> Model:
        model.rigid_velocity((0, 0, 0), self.spin, self.points.mean(axis=0))
        for k, force in zip(self.kept, self.blows(), strict=True):
            model.force(f"p{k}", force, [(0, 0), (RISE, 1), (OVER - RISE, 1), (OVER, 0)])
        return model


def cross(modes: int = 12) -> Struck:
    """Four arms in space, tips kept."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])
    return Struck(points @ TURN.T, [(0, 1), (0, 2), (0, 3), (0, 4)], [1, 2, 3, 4], modes)


def u_frame(modes: int = 12) -> Struck:
    """Three members in a U, ends kept."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    return Struck(points @ TURN.T, [(0, 1), (1, 2), (2, 3)], [0, 3], modes)


def t_frame(modes: int = 12) -> Struck:
    """Three members in a T, tips kept."""
    points = np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, -1, 0.0]])
    return Struck(points @ TURN.T, [(0, 1), (0, 2), (0, 3)], [1, 2, 3], modes)


def ring(modes: int = 12) -> Struck:
    """A closed frame that is not flat, four interfaces around it."""
    angles = np.arange(8) * np.pi / 4
    points = 0.7 * np.column_stack([np.cos(angles), 0.7 * np.sin(angles), 0.1 * np.sin(2 * angles)])
    return Struck(points @ TURN.T, [(k, (k + 1) % 8) for k in range(8)], [0, 2, 4, 6], modes,
                  spin=(0.0, 0.0, 20.0))


NAMED = {"cross": cross, "U": u_frame, "T": t_frame, "ring": ring}


def at_random(seed: int) -> Struck:
    """A tree or a ring in space of 3 to 8 interfaces, 0 to 16 modes, struck to turn 0.05 to 0.3."""
    random = np.random.default_rng(seed)
    count, modes = int(random.integers(3, 9)), int(random.integers(0, 17))
    points, members = _grown(random, count)
    depth = random.uniform(0.004, 0.012)
    width = depth * random.uniform(1.0, 2.0)
    section = Section(
        area=width * depth, inertia_y=width * depth**3 / 12, inertia_z=depth * width**3 / 12,
        torsion=0.2 * width * depth**3, youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)
    ends = [k for k in range(len(points)) if sum(k in member for member in members) == 1]
    kept = sorted(ends[:count] + [k for k in range(len(points)) if k not in ends]
                  [:max(0, count - len(ends))])
    start = Struck(points @ Rotation.random(random_state=seed).as_matrix().T, members, kept, modes,
                   section, tuple(random.normal(size=3) * random.uniform(2.0, 10.0)))
    forces = random.normal(size=(len(kept), 3))
    return start._replace(forces=forces * random.uniform(0.05, 0.3) / _turned(start, forces))


def of_three(seed: int, turn: float) -> Struck:
    """A frame of three or four members in space, three interfaces, 12 modes, struck to turn so."""
    random = np.random.default_rng(seed)
    points, members = _grown(random, 3)
    inner = [k for k in range(len(points)) if sum(k in member for member in members) > 1]
    kept = sorted([k for k in range(len(points)) if k not in inner][:3] + inner)[:3]
    depth = random.uniform(0.005, 0.01)
    width = depth * random.uniform(1.0, 2.0)
    section = Section(
        area=width * depth, inertia_y=width * depth**3 / 12, inertia_z=depth * width**3 / 12,
        torsion=0.2 * width * depth**3, youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)
    start = Struck(points @ Rotation.random(random_state=seed).as_matrix().T, members, kept, 12,
                   section, tuple(random.normal(size=3) * random.uniform(2.0, 8.0)))
    forces = random.normal(size=(3, 3))
    return start._replace(forces=forces * turn / _turned(start, forces))


class Off(NamedTuple):
    """A struck body beside nonlinear beams."""

    error: float        # largest of its interfaces, by the size of the body
    turn: float         # largest rotation of an interface against another one
    warnings: tuple[str, ...]


def beside_beams(struck: Struck, periods: float = 4.0, steps: int = 500) -> Off:
    """Run a struck frame and beams, four a member, over some periods of its slowest vibration."""
    body = struck.body()
    slowest = 2 * np.pi / np.sqrt(eigh(body.stiffness, body.mass, eigvals_only=True)[6])
    t_end = max(periods * slowest, 3 * OVER)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)
        own, beams = (simulate(model, t_end / steps, t_end)
                      for model in (struck.model(body), struck.beams(4)))
    apart = max(np.linalg.norm(own[f"p{k}.position"] - beams[f"p{k}.position"], axis=1).max()
                for k in struck.kept)
    turned = [beams[f"p{k}.rotation"] for k in struck.kept]
    turn = max(Rotation.from_matrix(np.swapaxes(a, 1, 2) @ b).magnitude().max()
               for i, a in enumerate(turned) for b in turned[:i])
    return Off(float(apart / np.ptp(struck.points, axis=0).max()), float(turn), own.warnings)


def _grown(random: np.random.Generator, count: int) -> tuple[NDArray, list[tuple[int, int]]]:
    """Points and members: a star, a chain with branches, or a ring with arms."""
    kind = random.integers(3)
    if kind == 0:
        ends = _directions(random, count) * random.uniform(0.4, 1.2, (count, 1))
        return np.vstack([np.zeros(3), ends]), [(0, 1 + k) for k in range(count)]
    if kind == 1:
        points, members = [np.zeros(3)], []
        for k in range(1, count + 2):
            root = int(random.integers(max(0, k - 3), k))
            points.append(points[root] + random.uniform(0.4, 1.0) * _directions(random, 1)[0])
            members.append((root, k))
        return np.array(points), members
    angles = np.arange(count) * 2 * np.pi / count
    height = 0.1 * random.normal(size=count)
    points = np.column_stack([np.cos(angles), 0.8 * np.sin(angles), height])
    return 0.7 * points, [(k, (k + 1) % count) for k in range(count)]


def _directions(random: np.random.Generator, count: int) -> NDArray:
    found = random.normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def _turned(struck: Struck, forces: NDArray) -> float:
    """Largest rotation of a boundary node against the others that the blow makes, linearly."""
    body = struck._replace(modes=0).body()
    squares, shapes = eigh(body.stiffness, body.mass)
    nodes = len(struck.kept)
    impulse = np.zeros(len(squares))
    impulse[:3 * nodes] = (OVER - RISE) * forces.ravel()
    elastic = shapes[:, 6:]
    amplitudes = elastic.T @ impulse / np.sqrt(squares[6:])
    turns = np.sqrt(((elastic[3 * nodes:6 * nodes] * amplitudes)**2).sum(axis=1)).reshape(nodes, 3)
    return float(np.linalg.norm(turns, axis=1).max())


class Energies(NamedTuple):
    """What a run did to the energy after the blow, over that of vibrations at its end."""

    gain: float         # largest increase
    loss: float         # at the end
    end: float          # time reached
    steps: int
    warned: bool


def energies(model: Model, step: float, vibration: float, t_end: float = 1.0,
             rho: float = 0.9) -> Energies:
    """Run a struck frame."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", LimitWarning)
        try:
            result = simulate(model, step, t_end, generalized_alpha(rho))
        except SimulationError as error:
            result = error.result
    after = result.t > OVER - step / 2
    try:
        energy = (result["energy.kinetic"] + result["energy.strain"])[after]
    except InputError:      # the last state of a run that failed has none
        energy = np.array([0.0, np.inf])
    if not len(energy):     # stopped during the blow
        energy = np.array([0.0, np.inf])
    return Energies(float(energy.max() - energy[0]) / vibration,
                    float(energy[0] - energy[-1]) / vibration, float(result.t[-1]), result.steps,
                    bool(told) or bool(result.failure))


def vibration(struck: Struck, step: float = 1e-4) -> float:
    """Energy of vibrations of the struck frame: what rigid motion with its momenta has not."""
    result = simulate(struck.beams(), step, 2 * OVER)
    energy = result["energy.kinetic"][-1] + result["energy.strain"][-1]
    body = struck._replace(modes=0).body()
    inertia, centre = _inertia(body)
    momentum, moment = result["momentum"][-1], result["angular_momentum"][-1]
    place = _centre(result, struck, centre)
    spin = moment - np.cross(place, momentum)
    turn = _attitude(result, struck)
    rigid = momentum @ momentum / (2 * body.total_mass)
    return float(energy - rigid - spin @ np.linalg.solve(turn @ inertia @ turn.T, spin) / 2)


def _inertia(body) -> tuple[NDArray, NDArray]:
    centre = np.asarray(body.centre_of_mass)
    rigid = body.rigid_modes_about(centre)
    return (rigid.T @ body.mass @ rigid)[3:, 3:], centre


def _attitude(result, struck: Struck) -> NDArray:
    """Rotation of best fit of all points."""
    now = np.array([result[f"p{k}.position"][-1] for k in range(len(struck.points))])
    found, _ = Rotation.align_vectors(now - now.mean(axis=0),
                                      struck.points - struck.points.mean(axis=0))
    return found.as_matrix()


def _centre(result, struck: Struck, centre: NDArray) -> NDArray:
    """Where the centre of mass has moved."""
    momentum = result["momentum"]
    mass = struck._replace(modes=0).body().total_mass
    moved = np.trapezoid(momentum, result.t, axis=0) / mass
    return centre + moved
