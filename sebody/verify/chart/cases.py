"""Variants of scenes made for charts: frames, inertia, divisions, modes, steps, schemes."""

import inspect
from typing import NamedTuple

from sebody.catalogue import builder
from sebody.engine.state import Scheme
from sebody.runs.schemes import generalized_alpha, hht

# scene: the quantity whose history is compared
SCENES = {"hinged-beam": "tip.position", "planar-hinged-beam": "tip.position",
          "spherical-beam": "tip.position", "spherical-beam-strong": "tip.position",
          "slider-crank": "pin.rotation", "spin-up": "tip.position"}
# finer: name, of the step of the scene
STEPS = {0.25: "step x 4", 0.5: "step x 2", 1.0: "step x 1", 2.0: "step / 2", 4.0: "step / 4"}
TOLERANCE = 1e-2    # of the model that is advised
COARSEST = 4        # histories are compared on a grid of so many of the scene's own steps


class Variant(NamedTuple):
    """A variant of a scene."""

    family: str
    label: str
    parameters: dict        # of the scene's build
    finer: float = 1.0      # than the scene's own step
    scheme: Scheme = generalized_alpha()


def variants(scene: str) -> list[Variant]:
    """All points of a scene's chart, as far as it has the parameters."""
    known = inspect.signature(builder(scene)).parameters
    planar = not builder(scene)().model.rotation_size == 3
    points = [*_frames(planar), *_divisions(), *_beams(), *_schemes()]
    return [v for v in points if set(v.parameters) <= set(known)]


def _frames(planar: bool) -> list[Variant]:
    frames = ["node", "converged_mean"] + ([] if planar else ["mean", "mean_small"])
    titles = {"node": "frame at a node", "converged_mean": "mean frame",
              "mean": "mean frame, one iteration", "mean_small": "mean frame, linear increments"}
    kinds = [(f"{titles[f]}, option b", {"frame": f, "inertia": "material"}) for f in frames]
    kinds += [("mean frame, option a", {"inertia": "frame_axes"}),
              ("frame at a node, option c", {"frame": "node"}), ("mean frame, option c", {}),
              ("mean frame, option c, no stiffening", {"stiffening": False})]
    return [Variant("frames and inertia", *one) for one in kinds]


def _divisions() -> list[Variant]:
    kinds = [Variant("modes" + of, f"1 body, {m} modes" + of.replace("B", "option b"),
                     {"modes": m, "bodies": 1} | given)
             for of, given in (("", {}), (", B", {"inertia": "material"})) for m in (0, 1, 2, 4, 8)]
    kinds += [Variant("bodies", f"{n} bodies, {m} modes", {"bodies": n, "modes": m,
                                                           "elements": 24})
              for n in (2, 4, 8) for m in (0, 2)]
    kinds += [Variant("steps", f"1 body, 4 modes, {STEPS[f]}", {"bodies": 1, "modes": 4}, f)
              for f in STEPS if f != 1.0]
    return kinds + [Variant("steps", f"2 bodies, 0 modes, {STEPS[f]}",
                            {"bodies": 2, "modes": 0, "elements": 24}, f)
                    for f in STEPS if f != 1.0]


def _beams() -> list[Variant]:
    return [Variant("nonlinear beams", f"{n} nonlinear beam{'s' * (n > 1)}, {STEPS[f]}",
                    {"bodies": n, "modes": 0, "elements": n}, f)
            for n in (1, 2, 3, 5, 8) for f in STEPS]


def schemes() -> dict[str, Scheme]:
    """Schemes besides the default."""
    return {"rho 0.5": generalized_alpha(0.5), "rho 1": generalized_alpha(1.0),
            "HHT -0.1": hht(-0.1), "tolerance 1e-6": generalized_alpha(tolerance=1e-6),
            "tangent of the paper": generalized_alpha(tangent="paper")}


def _schemes() -> list[Variant]:
    return [Variant("schemes", name, {}, 1.0, scheme) for name, scheme in schemes().items()]
