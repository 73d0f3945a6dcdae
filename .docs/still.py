"""A picture of a moving model: ``python .docs/still.py RESULT.npz PICTURE.png``."""

import sys
from pathlib import Path

from sebody import Result
from sebody.pictures import film
from sebody.pictures.colouring import colourings
from sebody.pictures.scene import scenery

STATES = 301        # of those among which it is chosen
LETTERS = 1.7       # over those of a film: cards of the gallery are a third of its size


def write_still(result: Result, path: Path) -> None:
    """Draw a model when its stresses, or else its displacements, are largest."""
    from matplotlib.image import imsave

    drawn = scenery(result, STATES, stressed=True)
    fields = {one.name: one for one in colourings(drawn.bodies, drawn.units)}
    field = fields.get("von_mises") or fields.get("displacement")
    frame = field.frame if field else len(drawn.t) // 3
    picture, = film.pictures(drawn, "", [frame], field and field.name, LETTERS)
    imsave(path, picture)


if __name__ == "__main__":
    write_still(Result.load(sys.argv[1]), Path(sys.argv[2]))
