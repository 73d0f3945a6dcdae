"""Units and cautions in pages and films."""

import json
import re

import numpy as np
import pytest

from sebody import Model, simulate
from sebody.fem import rectangle, straight_beam
from sebody.pictures.colouring import colourings
from sebody.pictures.scene import scenery
from sebody.reduction import craig_bampton
from sebody.results import animate


@pytest.fixture(scope="module", params=["mm t N s", ""])
def result(request):
    section = rectangle(4, 8, 2.1e5, 0.3, 7.85e-9)
    body = craig_bampton(straight_beam((0, 0, 0), (100, 0, 0), section, 8),
                         [(0, "full"), (8, "full")], 2)
    model = Model(units=request.param)
    nodes = [model.node(name, point) for name, point in
             zip(("base", "tip"), body.coordinates, strict=True)]
    model.superelement("beam", body, nodes)
    model.revolute(nodes[0], (0, 0, 1), name="hinge")
    model.gravity((0, -9810, 0))
    return simulate(model, h=1e-3, t_end=0.03)


def test_legends_have_the_units_of_the_model(result, tmp_path):
    drawn = scenery(result, 20, stressed=True)
    found = {one.name: one.unit for one in colourings(drawn.bodies, drawn.units)}
    known = bool(result.units)
    assert found == ({"displacement": "mm", "von_mises": "MPa"} if known else
                     {"displacement": "length", "von_mises": "force/length^2"})
    text = animate(result, tmp_path / "page.html", "tip.velocity", "tip.rotation").read_text()
    header = json.loads(re.search(r'id="header">(.*?)</script>', text, re.DOTALL)[1])
    assert [one["unit"] for one in header["fields"]] == list(found.values())
    assert header["time_unit"] == ("s" if known else "") and header["cautions"] == []
    units = {one["name"]: one["unit"] for one in header["plots"]["all"]}
    assert units["tip.velocity"] == ("mm/s" if known else "length/time")
    assert units["tip.rotation"] == "rad"
    assert units["energy"] == ("N mm" if known else "force length")


def test_films_take_units(result, tmp_path):
    from matplotlib.image import imread

    path = animate(result, tmp_path / "film.gif", colour="von_mises", speed=0.03 / 0.2)
    first = imread(path)
    assert first.ndim == 3 and np.ptp(first) > 100
