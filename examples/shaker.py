"""A box of aluminium members on a shaker that moves it at random.

The table follows a history whose accelerations have the spectral density of a specification, by
sines with random phases; the box stands on it with its four feet. The same test in the
frequency domain is `random_response`, whose rms values are those of the run within its scatter.

Look at ``lid.acceleration.x`` beside ``table.acceleration.x``: the box vibrates with its own
frequencies.
"""

from itertools import combinations, product

import numpy as np

from sebody import Model
from sebody.basics import inputs
from sebody.fem import Section, frame
from sebody.reduction import RigidFace, craig_bampton
from sebody.scenes.scene import Scene

SIZES = np.array([0.4, 0.3, 0.25])          # m
MEMBER = Section(1.6e-4, 2.1e-9, 2.1e-9, 3.6e-9, 7e10, 0.33, 2700.0)
SPECIFICATION = ((20.0, 0.5), (40.0, 2.0), (150.0, 2.0), (200.0, 0.7))      # Hz, (m/s^2)^2/Hz
RATIO, MODES, LID = 0.03, 8, 1.5            # damping of free vibrations; mass on a corner [kg]
FADE = 0.3          # s, in which the motion of the table grows


def history(seed: int, length: float):
    """Displacements of the table over time, which grow from rest."""
    random = np.random.default_rng(seed)
    first, last = SPECIFICATION[0][0], SPECIFICATION[-1][0]
    f = np.arange(first, last, 1.0 / length) + 0.5 / length
    density = np.exp(np.interp(np.log(f), *np.log(np.array(SPECIFICATION)).T))
    amplitude = np.sqrt(2.0 * density / length)
    phase, omega = random.uniform(0.0, 2.0 * np.pi, len(f)), 2.0 * np.pi * f
    t = np.arange(0.0, length, 0.05 / last)
    waves = np.cos(np.outer(t, omega) + phase)
    begun = 0.5 - 0.5 * np.cos(np.pi * np.minimum(t / FADE, 1.0))
    return np.column_stack([t, begun * (waves @ (-amplitude / omega**2))])


def build(seed: int = 1, length: float = 4.0) -> Scene:
    """The scene.

    Parameters
    ----------
    seed : int
        Of the random phases.
    length : float
        Of the test [s].
    """
    seed, length = inputs.integer(seed, "seed", least=0), inputs.number(length, "length", above=0)
    corners = np.array(list(product((0.0, 1.0), repeat=3))) * SIZES
    edges = [(i, j) for i, j in combinations(range(8), 2)
             if np.count_nonzero(corners[i] != corners[j]) == 1]
    feet = tuple(k for k in range(8) if corners[k, 2] == 0.0)
    middle = (*SIZES[:2] / 2, 0.0)
    body = craig_bampton(frame(corners, edges, MEMBER, 4),
                         [(RigidFace(middle, feet), "full"), (7, "translation")], MODES)
    model = Model(units="m kg s N")
    table, lid = model.node("table", middle), model.node("lid", corners[7], "translation")
    model.superelement("box", body.damped(RATIO), [table, lid])
    model.point_mass("weight", lid, LID)
    model.fix(table, "rotation")
    model.move(table, (1.0, 0.0, 0.0), history(seed, length), name="shaker")
    return Scene("shaker", "a box on a shaker that moves at random", model, h=2e-4,
                 t_end=length - 0.01, base="table", tip="lid")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
