"""Least mass of the rod of a slider-crank within a stress limit: a height for each element.

    python tests/benchmarks/bench_sizing.py [--json] [--elements N] [--iterations N]
        [--picture FILE]

The crank turns at a constant speed, one turn is looked at. All largest stresses, one in each
element, are conditions of `scipy.optimize.minimize`, with exact derivatives.
"""

import argparse
import json
import time
import warnings
from math import cos, sin

import numpy as np

from sebody import LimitWarning, Model
from sebody.analysis import size_heights
from sebody.fem import rectangle

RADIUS, LENGTH, SPEED, PISTON = 0.15, 0.5, 60.0, 0.5
HEIGHT, LIMIT, BOUNDS = 0.02, 60e6, (0.004, 0.04)
H, T_END = 5e-4, 0.105


def section(height):
    """Of a rod of steel, 10 mm wide."""
    return rectangle(height, 0.01, 2.1e11, 0.3, 7850.0)


def slider_crank(elements=200, modes=4):
    """The crank pin moves on a circle as prescribed; the rod and the piston follow."""
    model = Model(planar=True)
    pin, piston = model.node("pin", (RADIUS, 0.0)), model.node("piston", (RADIUS + LENGTH, 0.0))
    model.beam("rod", (pin, piston), section(HEIGHT), elements, 1, modes, inertia="material")
    model.point_mass("mass", piston, PISTON)
    model.slider(piston, axis=(1.0, 0.0))
    w = SPEED
    model.move(pin, (RADIUS, 0.0), (lambda t: cos(w * t) - 1.0, lambda t: -w * sin(w * t),
                                    lambda t: -w**2 * cos(w * t)))
    model.move(pin, (0.0, RADIUS), (lambda t: sin(w * t), lambda t: w * cos(w * t),
                                    lambda t: -w**2 * sin(w * t)))
    model.rigid_velocity((0.0, RADIUS * w), -w * RADIUS / LENGTH, about=(RADIUS, 0.0))
    return model


def sizing(model, elements=200, iterations=50):
    """Heights of least mass, and what they took."""
    return size_heights(model, H, T_END, "rod", np.full(elements, HEIGHT), section,
                        LIMIT, BOUNDS, iterations)


def main(given=None):
    """Print what was measured."""
    warnings.simplefilter("ignore", LimitWarning)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--elements", type=int, default=200, metavar="N")
    parser.add_argument("--iterations", type=int, default=50, metavar="N")
    parser.add_argument("--picture", metavar="FILE", help="of heights and stresses")
    options = parser.parse_args(given)
    model = slider_crank(options.elements)      # compiles the functions of its drive
    began = time.process_time()
    found = sizing(model, options.elements, options.iterations)
    spent = time.process_time() - began
    rows = {"mass": found.mass, "mass before": found.mass_before,
            "largest stress / limit": float(found.stresses.max() / LIMIT),
            "elements at a stress within 1 % of the limit or the least height": float(np.mean(
                (found.stresses > 0.99 * LIMIT) | (found.heights < 1.01 * BOUNDS[0]))),
            "iterations": found.iterations, "runs": found.runs, "seconds": found.seconds,
            "of the processor": spent,
            "ended": found.message}
    if options.picture:
        found.save_picture(options.picture)
    if options.json:
        print(json.dumps(rows))
        return
    for what, value in rows.items():
        print(f"{what:66} {value}")


if __name__ == "__main__":
    main()
