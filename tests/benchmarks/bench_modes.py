"""How many modes `Accuracy` takes, and how true its estimate is, of twenty bodies.

    python tests/benchmarks/bench_modes.py [--json] [--beam | --frequencies]

Beams, frames, plates and solids of random size, section, place and interfaces, and a beam with an
element of 1e-4 of the stiffness, nearly two bodies (the clamped stiffness has a condition of 1e10;
where it is worse, rounding of the FE matrices decides). What is true comes from the full
matrices: the dynamic stiffness of the interface, all other DOFs eliminated, at frequencies
throughout the band, and the free vibrations of the whole model. The least number of modes is the
smallest with a true error within the tolerance; beside it stand those of Rubin's and MacNeal's
methods, counted as internal modes of the reduced body.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from sebody.fem import (
    FEModel,
    Section,
    frame,
    hexahedral_block,
    planar_beam,
    straight_beam,
)
from sebody.fem.selection import nodes_on_plane
from sebody.reduction import Accuracy, MeanFace, RigidFace, reduce
from sebody.reduction.accuracy import enough_modes
from sebody.reduction.boundary import boundary_of
from sebody.reduction.methods import METHODS, clamped

TOLERANCE = 1e-3
BODIES = 20
FREQUENCIES = 40        # of a band
MOST = 80               # free modes that are tried
NEAR = 1e-6             # relative distance from a resonance of the interior that is left out
STEEL, ALUMINIUM = (2.1e11, 0.3, 7800.0), (7e10, 0.33, 2700.0)

Body = tuple[FEModel, list]


def random_section(random: np.random.Generator) -> Section:
    """Rectangles of steel, up to five times as high as wide."""
    width, height = 0.02, 0.02 * random.uniform(1, 5)
    return Section(width * height, height * width**3 / 12, width * height**3 / 12,
                   0.2 * height * width**3, *STEEL)


def beam(random: np.random.Generator) -> Body:
    """Between two random points, one end perhaps hinged."""
    count = int(random.integers(12, 24))
    model = straight_beam(*random.normal(size=(2, 3)), random_section(random), count)
    return model, [(0, "full"), (count, str(random.choice(["full", "translation"])))]


def elbow(random: np.random.Generator) -> Body:
    """Three members in space, held at one, two or three ends."""
    model = frame(random.normal(size=(4, 3)), [(0, 1), (1, 2), (1, 3)], random_section(random), 7)
    return model, [(0, "full"), (2, "full"), (3, "translation")][:int(random.integers(1, 4))]


def plate(random: np.random.Generator) -> Body:
    """Held at two edges."""
    size = [1.0, random.uniform(0.4, 1.0), random.uniform(0.01, 0.03)]
    model = hexahedral_block(random.normal(size=3), size, (8, 5, 1), *ALUMINIUM)
    return model, ends(model, 0, random)


def solid(random: np.random.Generator) -> Body:
    """A block held at two opposite faces."""
    model = hexahedral_block(random.normal(size=3), random.uniform(0.3, 1.0, 3), (4, 4, 3),
                             *ALUMINIUM)
    return model, ends(model, int(random.integers(3)), random)


def ends(model: FEModel, axis: int, random: np.random.Generator) -> list:
    """The faces at both ends of an axis: rigid, or means."""
    found = []
    for place in (model.coordinates[:, axis].min(), model.coordinates[:, axis].max()):
        nodes = nodes_on_plane(model, place * np.eye(3)[axis], np.eye(3)[axis])
        middle = model.coordinates[list(nodes)].mean(axis=0)
        face = RigidFace(middle, nodes) if random.random() < 0.5 else MeanFace(nodes)
        found.append((face, "full"))
    return found


def nearly_two(random: np.random.Generator) -> Body:
    """A beam with one soft element, held at one end and at its middle."""
    section = random_section(random)
    model = straight_beam(*random.normal(size=(2, 3)), section, 16)
    rows = slice(6 * 11, 6 * 13)
    one = straight_beam(*model.coordinates[11:13], section, 1).stiffness.toarray()
    stiffness = model.stiffness.toarray()
    stiffness[rows, rows] -= (1 - 1e-4) * one
    return replace(model, stiffness=stiffness), [(0, "full"), (8, "full")]


def family(count: int = BODIES, seed: int = 1) -> list[tuple[str, Body, float]]:
    """Kind, body, and end of the band: above one to eight free elastic vibrations."""
    random = np.random.default_rng(seed)
    makers = [*[make for _ in range(count) for make in (beam, elbow, plate, solid)][:count - 1],
              nearly_two]
    found = []
    for make in makers:
        body = make(random)
        squares = linalg.eigh(body[0].stiffness.toarray(), body[0].mass.toarray(),
                              eigvals_only=True, subset_by_index=[6, 15])
        up_to = np.sqrt(squares[int(random.integers(1, 9))]) / (2 * np.pi)
        found.append((make.__name__, body, float(up_to * random.uniform(1.02, 1.2))))
    return found


class Truth:
    """Dynamic stiffness of the interface by full matrices, and errors of reductions against it."""

    def __init__(self, model: FEModel, boundary: Sequence, up_to: float):
        edge = boundary_of(model, boundary)
        self._K, self._M = (edge.ties.project(m).toarray() for m in (model.stiffness, model.mass))
        values = edge.values(np.eye(len(self._K)))      # boundary coordinates of the DOFs
        self._still = linalg.null_space(values)
        self._moved = np.linalg.pinv(values)
        self._squares = linalg.eigh(*(self._still.T @ m @ self._still for m in (self._K, self._M)),
                                    eigvals_only=True)
        self.omegas = 2 * np.pi * up_to * np.linspace(0, 1, FREQUENCIES + 1)[1:]
        self._exact = [self._dynamic_stiffness(omega) for omega in self.omegas]
        bare = replace(model, geometric_stiffness=None)
        body = reduce(bare, boundary)
        self._norm = body.stiffness, body.mass

    def _dynamic_stiffness(self, omega: float) -> NDArray | None:
        if np.min(np.abs(self._squares / omega**2 - 1)) < NEAR:
            return None
        D = self._K - omega**2 * self._M
        within = self._still.T @ D @ self._still
        across = self._still.T @ D @ self._moved
        return self._moved.T @ D @ self._moved - across.T @ np.linalg.solve(within, across)

    def error(self, stiffness: NDArray, mass: NDArray) -> float:
        """Largest error of reduced matrices, boundary coordinates first."""
        held = len(self._norm[0])
        worst = 0.0
        for omega, exact in zip(self.omegas, self._exact, strict=True):
            if exact is None:
                continue
            D = stiffness - omega**2 * mass
            found = D[:held, :held]
            if len(D) > held:
                found = found - D[:held, held:] @ np.linalg.solve(D[held:, held:], D[held:, :held])
            norm = self._norm[0] + omega**2 * self._norm[1]
            worst = max(worst, np.abs(linalg.eigh((found + found.T - exact - exact.T) / 2, norm,
                                                  eigvals_only=True)).max())
        return worst

    def free_error(self, stiffness: NDArray, mass: NDArray) -> float:
        """Largest relative error of the free frequencies within the band."""
        exact = linalg.eigh(self._K, self._M, eigvals_only=True)
        count = int(np.sum(exact <= self.omegas[-1]**2))
        found = linalg.eigh(stiffness, mass, eigvals_only=True)[6:count]
        return float(np.abs(np.sqrt(found / exact[6:count]) - 1).max(initial=0.0))


def least_free(body: Body, truth: Truth, method: str) -> int | None:
    """Least number of internal modes of a method by free modes, None beyond its limit.

    By halving: errors fall with the number of modes, but for the last digits.
    """
    model = replace(body[0], geometric_stiffness=None, mass_field=None)

    def tried(modes: int) -> int | None:
        found = reduce(model, body[1], modes, method)
        return found.modes if truth.error(found.stiffness, found.mass) <= TOLERANCE else None

    low, high = -1, MOST
    enough = tried(high)
    while enough is not None and high - low > 1:
        middle = (low + high) // 2
        found = tried(middle)
        low, high, enough = (middle, high, enough) if found is None else (low, middle, found)
    return enough


def measure(kind: str, body: Body, up_to: float) -> dict:
    """What is chosen and estimated, what is true, and what would do, of one body."""
    model, boundary = body
    edge = boundary_of(model, boundary)
    matrices, interior, static = clamped(model, edge)
    chosen, estimate = enough_modes(static, interior, matrices, Accuracy(TOLERANCE, up_to))
    truth, pairs = Truth(model, boundary, up_to), {}
    for modes in range(chosen, -1, -1):
        pairs[modes] = static.with_vibrations(interior, modes).project(*matrices)
        if truth.error(*pairs[modes]) > TOLERANCE:
            break
    true = truth.error(*pairs[chosen])
    # below the least number no number does: errors fall with every mode
    least = chosen if true > TOLERANCE else min(
        (n for n, pair in pairs.items() if truth.error(*pair) <= TOLERANCE), default=chosen)
    return {"body": kind, "dofs": matrices[0].shape[0], "up_to": up_to, "modes": chosen,
            "least": least, "estimate": estimate, "true": true,
            "effectivity": estimate / true, "free": truth.free_error(*pairs[chosen]),
            **{method: least_free(body, truth, method) for method in ("rubin", "macneal")}}


def by_frequencies(kind: str, body: Body, up_to: float) -> dict:
    """Modes by either criterion, what the free frequencies are off by, and Rubin's shapes."""
    model, boundary = body
    edge = boundary_of(model, boundary)
    matrices, interior, static = clamped(model, edge)
    truth, found = Truth(model, boundary, up_to), {}
    for of in ("stiffness", "frequencies"):
        found[of] = enough_modes(static, interior, matrices, Accuracy(TOLERANCE, up_to, of))
    count, estimate = found["frequencies"]

    def true(modes: int) -> float:
        return truth.free_error(*static.with_vibrations(interior, modes).project(*matrices))
    least = next((n for n in range(count - 1, -1, -1) if true(n) > TOLERANCE), -1) + 1
    bare = replace(model, geometric_stiffness=None, mass_field=None)
    rubin = reduce(bare, boundary, Accuracy(TOLERANCE, up_to), "rubin")
    return {"body": kind, "dofs": matrices[0].shape[0], "up_to": up_to,
            "stiffness": found["stiffness"][0], "modes": count, "least": least,
            "estimate": estimate, "true": true(count), "rubin": rubin.modes,
            "rubin_true": truth.free_error(rubin.stiffness, rubin.mass)}


def beam_table(counts: Sequence[int] = (0, 1, 2, 3, 4, 8)) -> list[dict]:
    """Frequencies of a uniform planar beam, times sqrt(rho A L^4 / E I), by method and modes.

    Both ends are interfaces; held are the deflection and slope of one, nothing, or its deflection.
    """
    # so slender that rotary inertia and axial motion do not show: E I = rho A = 1, L = 2
    model = planar_beam([0, 0], [2, 0], Section(1.0, 1e-8, 1e-8, 1e-8, 1e8, 0.3, 1.0), 60)
    model = replace(model, geometric_stiffness=None)
    rows = []
    for method in METHODS:
        for modes in counts if method != "guyan" else (0,):
            body = reduce(model, [(0, "full"), (60, "full")], modes, method)
            row = {"method": method, "modes": modes, "order": len(body.mass)}
            for name, held in (("clamped-free", [0, 1, 4]), ("free-free", []),
                               ("pinned-free", [0, 1])):
                kept = np.setdiff1d(np.arange(len(body.mass)), held)
                K, M = (m[np.ix_(kept, kept)] for m in (body.stiffness, body.mass))
                # the inverse problem: coordinates may be massless
                inverse = linalg.eigh(M, K + M, eigvals_only=True)[::-1]
                squares = 16 * (1 / inverse[inverse > 1e-12] - 1)
                bending = squares[(squares > 1) & (squares < 1e6)]
                row[name] = np.sqrt(bending[:3]).tolist()
            rows.append(row)
    return rows


def main(arguments: Sequence[str] | None = None, bodies: int = BODIES) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--beam", action="store_true", help="frequencies of a beam by method")
    parser.add_argument("--frequencies", action="store_true",
                        help="modes by the criterion of free frequencies alone")
    chosen = parser.parse_args(arguments)
    if chosen.beam:
        _print_beam(beam_table(), chosen.json)
        return
    if chosen.frequencies:
        _print_frequencies([by_frequencies(*case) for case in family(bodies)], chosen.json)
        return
    rows = [measure(*case) for case in family(bodies)]
    if chosen.json:
        print(json.dumps(rows, indent=1))
        return
    print("| body | DOFs | band (Hz) | modes | least | estimate | true | effectivity | free | "
          "Rubin | MacNeal |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        print("| {body} | {dofs} | {up_to:.4g} | {modes} | {least} | {estimate:.2e} | {true:.2e} | "
              "{effectivity:.3f} | {free:.1e} | {rubin} | {macneal} |".format(**row))


def _print_frequencies(rows: list[dict], as_json: bool) -> None:
    if as_json:
        print(json.dumps(rows, indent=1))
        return
    print("| body | DOFs | band (Hz) | stiffness | frequencies | least | estimate | true | Rubin | "
          "true |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        print("| {body} | {dofs} | {up_to:.4g} | {stiffness} | {modes} | {least} | {estimate:.1e} "
              "| {true:.1e} | {rubin} | {rubin_true:.1e} |".format(**row))


def _print_beam(rows: list[dict], as_json: bool) -> None:
    if as_json:
        print(json.dumps(rows, indent=1))
        return
    supports = ("clamped-free", "free-free", "pinned-free")
    print("| method | modes | order | " + " | ".join(supports) + " |")
    print("|---|---|---|---|---|---|")
    for row in rows:
        values = " | ".join(", ".join(f"{value:.5f}" for value in row[name]) for name in supports)
        print(f"| {row['method']} | {row['modes']} | {row['order']} | {values} |")


if __name__ == "__main__":
    main()
