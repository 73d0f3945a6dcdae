"""Estimated changes by omitted modes and rigid bodies, against runs of the simplified models.

    python tests/benchmarks/bench_contributions.py [--json] [--finer N] [--picture FILE] [NAME ...]

On the scenes of `advise` as they are given: for up to four bodies of each, spread over the model,
all modes left out, the last mode left out, and the body rigid. Changes below 1e-6 of a quantity's
range are left out: runs are not so exact. With parts of the step: simplified models have other
errors by the step than the full one, which estimates do not have; changes that are larger than
what half the step changes are counted apart. The picture: a jib on a mast.
"""

import argparse
import json
import sys
import time
import warnings
from pathlib import Path

import numpy as np

from sebody import LimitWarning, simulate
from sebody.analysis import contributions
from sebody.basics.errors import SebodyError
from sebody.model.variants import keep_modes, rigid
from sebody.runs.schemes import generalized_alpha

sys.path.insert(0, str(Path(__file__).parent))
from advice_general import GENERAL
from advice_scenes import SCENES, AdviceScene

MOST = 4                # bodies of a scene
LEAST = 1e-6            # change that counts
LARGE = 0.3             # beyond first order
CLOSE = 0.8, 1.25       # estimated over true
STEPS = 400             # longest run
PICTURED = "jib on a mast"
SCHEME = generalized_alpha(tolerance=1e-10)


def measured(scene: AdviceScene, finer: int = 1) -> list[dict]:
    """Rows of a scene, with a part of its step.

    Raises
    ------
    SebodyError
        The scene has no contributions.
    """
    model, h = scene.build(), scene.h / finer
    t_end = scene.h * min(round(scene.t_end / scene.h), STEPS)
    names = [name for name in scene.quantities if " " not in name]
    if scene.start is not None or not names:
        raise SebodyError("it starts in equilibrium" if names else "its quantities are measures")
    places = np.unique(np.linspace(0, len(model.bodies) - 1, MOST).round().astype(int))
    bodies = [list(model.bodies)[k] for k in places]
    found = contributions(model, h, t_end, names, bodies, scheme=SCHEME)
    rows, by_step = [], dict(zip(found.quantities, found.by_step.tolist(), strict=True))
    for one in found.rows:
        made = _simplified(model, one.body, one.change)
        if made is None:
            continue
        began = time.process_time()
        try:
            run = simulate(made(), h, t_end, scheme=SCHEME)
        except SebodyError:
            continue            # a rigid body between fixed nodes, or the simplified one fails
        seconds = time.process_time() - began
        for name in names:
            base = found.values[name]
            size = np.abs(base - base[0]).max()
            true = _largest(run[name], base)
            own = np.abs(found.history(name, one.body, one.change)).max() / size
            if true > LEAST:
                rows.append({"scene": scene.name, "body": one.body, "change": one.change,
                             "quantity": name, "true": true, "ratio": own / true,
                             "step": by_step[name],
                             "run": seconds, "all": found.seconds})
    return rows


def _largest(values, base):
    """Largest difference, relative to the largest change of the base."""
    return float(np.abs(values - base).max() / np.abs(base - base[0]).max())


def _simplified(model, body, change):
    modes = model.bodies[body].reduced.modes
    return {"rigid": lambda: rigid(model, body).model,
            "without modes": lambda: keep_modes(model, body, 0).model,
            f"without mode {modes - 1}": lambda: keep_modes(model, body, modes - 1).model
            }.get(change)


def summary(rows: list[dict]) -> dict:
    """Shares within the bounds, of small and of large changes."""
    def share(some):
        ratios = np.array([row["ratio"] for row in some])
        return {"count": len(some), "within": float(np.mean(
            (ratios >= CLOSE[0]) & (ratios <= CLOSE[1]))) if len(some) else None}
    return {"up to 0.3": share([row for row in rows if row["true"] <= LARGE]),
            "beyond": share([row for row in rows if row["true"] > LARGE]),
            "above what half the step changes": share([row for row in rows
                                                       if row["true"] > row["step"]]),
            "all": share(rows)}


def picture(path: str) -> None:
    """Contributions to the motion of the jib's tip."""
    scene = next(one for one in SCENES if one.name == PICTURED)
    contributions(scene.build(), scene.h, scene.t_end, ["tip.position", "tip.acceleration"],
                  scheme=SCHEME).save_picture(path)


def main(given=None):
    """Print what was measured."""
    warnings.simplefilter("ignore", LimitWarning)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--finer", type=int, default=1, metavar="N", help="parts of a step")
    parser.add_argument("--picture", metavar="FILE")
    options = parser.parse_args(given)
    if options.picture:
        picture(options.picture)
        return
    rows, left = [], {}
    for scene in (*SCENES, *GENERAL):
        if options.names and scene.name not in options.names:
            continue
        try:
            rows += (own := measured(scene, options.finer))
        except SebodyError as reason:
            left[scene.name] = str(reason)
            own = []
        if not options.json:
            for row in own:
                print("{scene:20} {body:14.14} {change:16} {quantity:24.24} {true:9.2e} "
                      "{ratio:7.3f}".format(**row), flush=True)
    if options.json:
        print(json.dumps({"rows": rows, "summary": summary(rows), "left out": left}))
        return
    for what, value in {**summary(rows), **left}.items():
        print(f"{what:24} {value}")


if __name__ == "__main__":
    main()
