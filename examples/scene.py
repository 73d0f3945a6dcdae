"""What a scene is: a model with the step and the time it is meant to be run with."""

from collections.abc import Callable
from dataclasses import dataclass

from sebody import Model, simulate


@dataclass(frozen=True, eq=False)
class Scene:
    """A model ready to run."""

    name: str
    summary: str
    model: Model
    h: float
    t_end: float
    base: str = "base"      # nodes that the standard picture shows
    tip: str = "tip"


def main(build: Callable[[], Scene]) -> None:
    """Run a scene as a script, with its summary and picture."""
    from sebody.pictures.plots import save_picture

    scene = build()
    result = simulate(scene.model, scene.h, scene.t_end)
    picture = save_picture(result, f"{scene.name}.png", scene.base, scene.tip)
    print(result.summary())
    print("picture:", picture)
