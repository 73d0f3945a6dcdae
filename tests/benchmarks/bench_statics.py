"""Equilibria of slender columns and of hanging chains, beside closed solutions.

    python tests/benchmarks/bench_statics.py [--json] [columns] [chains]

Columns: 1, 4 and 16 bodies, L/r 100 to 4000, 0.5 to 2 of Euler's load with side loads of 1e-4 to
1e-2 of it, in ten load steps; the tip's deflection beside the elastica's, and the lowest mode of
each state. Chains: 4 to 40 rods on ball joints, from a V, from an arc above their ends, and
straight and inclined; ends of rods beside those of rods that bend and stretch in a plane: as they
are statically determinate, the forces at an end give the shape of every rod by a boundary value
problem of its own.
"""

import argparse
import json
import sys
import time
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_bvp
from scipy.optimize import fsolve, root

from sebody import Model, SimulationError
from sebody.analysis import equilibrium, vibrations
from sebody.fem import Section, circle

sys.path.insert(0, str(Path(__file__).parent.parent))
from elastica import deflection  # noqa: E402

SHARES, SIDES = (0.5, 0.9, 0.95, 1.05, 1.3, 2.0), (1e-4, 1e-3, 1e-2)
SLENDERNESS, BODIES = (100, 400, 1000, 4000), (1, 4, 16)
STARTS, COUNTS, MODULI, STEPS = ("V", "arc", "straight"), (4, 10, 20, 40), (2e8, 2e11), (1, 10)
PLACE, SPAN = np.array([1.0, 2.0, 3.0]), np.array([3.0, 1.5, -0.7])
LENGTH, WEIGHT = 4.5, 9.81


def column(slenderness: float, share: float, side: float, bodies: int) -> Model:
    """A cantilever of length one under a share of Euler's load."""
    section = circle(2.0 / slenderness, 7e10, 0.3, 2700.0)
    load = share * np.pi**2 * 7e10 * section.inertia_z / 4.0
    model = Model()
    foot, tip = model.node("foot", (0.0, 0.0, 0.0)), model.node("tip", (1.0, 0.0, 0.0))
    model.fix(foot)
    elements, modes = {1: (16, 4), 4: (16, 4), 16: (32, 2)}[bodies]
    model.beam("column", (foot, tip), section, elements, bodies, modes, up=(0.0, 0.0, 1.0))
    model.force(tip, (-load, side * load, 0.0))
    return model


def solved(model: Model, steps: int) -> tuple:
    """The result or None, what was said, and seconds of the processor."""
    began = time.process_time()
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        try:
            result, said = equilibrium(model, steps), ""
        except SimulationError as error:
            result, said = None, str(error)
    seconds = time.process_time() - began
    return result, said or "; ".join(str(w.message) for w in given), seconds


def lowest(result) -> float:
    """Square of the lowest frequency."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return float(vibrations(result, 1).omega[0] ** 2)


def columns(bodies=BODIES, slenderness=SLENDERNESS, shares=SHARES, sides=SIDES) -> list[dict]:
    """One row a column."""
    rows = []
    for share in shares:
        for side in sides:
            exact = deflection(share, side)
            for n in bodies:
                for ratio in slenderness:
                    result, said, seconds = solved(column(ratio, share, side, n), 10)
                    row = {"bodies": n, "L/r": ratio, "share": share, "side": side, "said": said,
                           "seconds": seconds, "error": None}
                    if result is not None:
                        tip = np.hypot(*result["tip.position"][-1, 1:])
                        row |= {"error": float(tip / exact - 1.0), "stability": result.stability,
                                "lowest": lowest(result)}
                    rows.append(row)
    return rows


def points(start: str, count: int) -> NDArray:
    """Ends of the rods where they are made, in the plane they hang in, (n + 1, 2)."""
    end, rod = np.array([np.hypot(*SPAN[:2]), SPAN[2]]), LENGTH / count
    if start == "straight":
        return -rod * np.arange(count + 1)[:, None] * np.array([np.sin(0.7), np.cos(0.7)])
    if start == "V":
        half = count // 2
        x, z = fsolve(lambda p: [np.hypot(*p) - LENGTH / 2.0, np.hypot(*(p - end)) - LENGTH / 2.0],
                      [end[0] / 2.0, -2.0], xtol=1e-14)
        low, part = np.array([x, z]), np.arange(1, half + 1)[:, None] / half
        return np.vstack([np.zeros((1, 2)), part * low, low + part * (end - low)])
    away = np.hypot(*end)
    radius, = fsolve(lambda r: 2.0 * r * np.sin(count * np.arcsin(rod / (2.0 * r))) - away, 0.8,
                     xtol=1e-14)
    half = np.arcsin(rod / (2.0 * radius))
    angle = half * (2.0 * np.arange(count + 1) - count)
    along = end / away
    return (end / 2.0 + radius * np.sin(angle)[:, None] * along + radius * (
        np.cos(angle) - np.cos(count * half))[:, None] * np.array([-along[1], along[0]]))


def chain(start: str, count: int, modulus: float) -> Model:
    """Rods of 4 mm radius on ball joints."""
    section, model = _section(modulus), Model()
    model.gravity((0.0, 0.0, -WEIGHT))
    level = SPAN * (1.0, 1.0, 0.0) / np.hypot(*SPAN[:2])
    places = [PLACE + level * x + np.array([0.0, 0.0, z]) for x, z in points(start, count)]
    last = model.node("p0", places[0])
    model.fix(last, "position")
    for k in range(count):
        begin = last if k == 0 else model.node(f"q{k}", places[k], at=last)
        last = model.node(f"p{k + 1}", places[k + 1])
        model.beam(f"rod {k}", (begin, last), section, 2, 1, 0)
    if start != "straight":
        model.fix(last, "position")
    return model


def hanging(count: int, modulus: float) -> NDArray:
    """Ends of heavy rods that bend and stretch, (n + 1, 2).

    With the force (H, V(s)) at a section, ``EI th' = M, M' = (1 + T / EA)(H sin - V cos)`` and
    ``M = 0`` at both ends of a rod.
    """
    section, rod = _section(modulus), LENGTH / count
    weight, bending, axial = (section.density * section.area * WEIGHT, modulus * section.inertia_y,
                              modulus * section.area)
    end = np.array([np.hypot(*SPAN[:2]), SPAN[2]])
    s, guesses = np.linspace(0.0, rod, 41), {}

    def shape(k: int, H: float, V: float) -> NDArray:
        """From end to end of a rod with the force (H, V) at its first end."""
        def rates(s, y):
            up = V + weight * s
            c, z = np.cos(y[0]), np.sin(y[0])
            stretch = 1.0 + (H * c + up * z) / axial
            return np.array([y[1] / bending, stretch * (H * z - up * c), stretch * c, stretch * z])
        angle = np.arctan2(V + weight * rod / 2.0, H)
        first = guesses.get(k, (s, np.array([0 * s + angle, 0 * s, s * np.cos(angle),
                                             s * np.sin(angle)])))
        found = solve_bvp(rates, lambda a, b: np.array([a[1], b[1], a[2], a[3]]), *first, tol=1e-9,
                          max_nodes=20000)
        assert found.status == 0
        guesses[k] = found.x, found.y
        return found.y[2:, -1]

    def ends(forces: NDArray) -> NDArray:
        H, V = forces
        return np.vstack([np.zeros(2), np.cumsum([
            shape(k, H, V + k * weight * rod) for k in range(count)], axis=0)])
    total = weight * LENGTH
    if count == 0:
        return np.zeros((1, 2))
    rigid = root(lambda f: _rigid(f, count, weight * rod)[-1] - end, (0.3 * total, -0.5 * total),
                 tol=1e-12).x
    found = root(lambda f: ends(f)[-1] - end, rigid, tol=1e-10)
    return ends(found.x)


def _rigid(forces: NDArray, count: int, weight: float) -> NDArray:
    """The same of rods that neither bend nor stretch."""
    way = np.stack([np.full(count, forces[0]), forces[1] + weight * (np.arange(count) + 0.5)], 1)
    way *= LENGTH / count / np.linalg.norm(way, axis=1, keepdims=True)
    return np.vstack([np.zeros(2), np.cumsum(way, axis=0)])


def _section(modulus: float) -> Section:
    return circle(0.004, modulus, 0.3, 7800.0)


def chains(starts=STARTS, counts=COUNTS, moduli=MODULI, steps=STEPS) -> list[dict]:
    """One row a chain."""
    rows = []
    level = SPAN * (1.0, 1.0, 0.0) / np.hypot(*SPAN[:2])
    for count in counts:
        for modulus in moduli:
            exact = hanging(count, modulus) if set(starts) - {"straight"} else None
            for start in starts:
                for n in steps:
                    result, said, seconds = solved(chain(start, count, modulus), n)
                    row = {"start": start, "rods": count, "E": modulus, "steps": n, "said": said,
                           "seconds": seconds, "error": None}
                    if result is not None:
                        ends = np.array([result[f"p{k}.position"][-1] for k in range(count + 1)])
                        own = np.column_stack([(ends - PLACE) @ level, ends[:, 2] - PLACE[2]])
                        # hanging free they are vertical
                        error = own[:, 0] if start == "straight" else own - exact
                        row |= {"error": float(np.abs(error).max()), "stability": result.stability}
                    rows.append(row)
    return rows


KINDS = {"columns": columns, "chains": chains}


def table(rows: list[dict]) -> str:
    """A line a group: how many were found, and the largest errors and times."""
    keys = ("bodies", "share") if "bodies" in rows[0] else ("start", "rods", "E")
    groups: dict[tuple, list[dict]] = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in keys), []).append(row)
    lines = [f"| {', '.join(keys)} | found | largest error | s, median and largest | unstable "
             "states left |", "|---|---|---|---|---|"]
    for group, own in sorted(groups.items(), key=str):
        found = [row for row in own if row["error"] is not None]
        seconds = [row["seconds"] for row in own]
        worst = max((abs(row["error"]) for row in found), default=np.nan)
        left = sum(";" in row["stability"] for row in found)
        lines.append(f"| {', '.join(f'{x:g}' if not isinstance(x, str) else x for x in group)} | "
                     f"{len(found)} of {len(own)} | {worst:.1e} | {np.median(seconds):.2f}, "
                     f"{max(seconds):.2f} | {left} |")
    return "\n".join(lines)


def main(given: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("kinds", nargs="*", choices=[*KINDS, []])
    options = parser.parse_args(given)
    found = {kind: KINDS[kind]() for kind in options.kinds or KINDS}
    print(json.dumps(found, indent=1) if options.json else
          "\n\n".join(table(rows) for rows in found.values()))


if __name__ == "__main__":
    main()
