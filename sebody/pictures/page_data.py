"""The page of an animation: a template, scripts, a header and numbers."""

import base64
import html
import json
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from sebody.pictures import page_bodies, palette
from sebody.pictures.blocks import Blocks
from sebody.pictures.colouring import Colouring, colourings
from sebody.pictures.drawn_nodes import extent
from sebody.pictures.page_bodies import Measure
from sebody.pictures.page_plots import plots
from sebody.pictures.rope_lines import numbers_of_ropes
from sebody.pictures.scene import Scenery, scenery, seen_places
from sebody.pictures.templates import filled
from sebody.results.result import Result

SCRIPTS = ("numbers", "vectors", "motion", "bodies", "references", "shapes", "renderer", "camera",
           "marks", "contacts", "labels", "scene", "legend", "pointer", "plot", "controls", "main")
FRAMES = 1801           # at most: a minute of thirty a second
FEWEST_FRAMES = 201
NUMBERS = 3_000_000     # of all frames together, beyond which models have fewer of them
SIGN = 0.018            # size of signs, of the extent
FAR = 0.15              # between neighbouring nodes, from which signs have this size
SMALLEST = 0.2          # of this size
ROOM = 1.1              # of what is seen at the start, over what moves
REAL_TIME = (2.0, 120.0)        # durations that are played at their own speed
SECONDS = 10.0          # that the others take


def page(result: Result, quantities: Sequence[str], title: str, speed: float | None = None,
         colour: str | None = None, reference: str | None = None) -> str:
    """The text of the page; see `sebody.results.animate`."""
    drawn = scenery(result, _most_frames(result), stressed=True, reference=reference)
    blocks = Blocks()
    header = _header(blocks, result, drawn)
    header |= {"speed": speed or speed_of(drawn.t), "colour": colour,
               "plots": plots(blocks, result, drawn, quantities)}
    script = "\n".join(filled(f"{name}.js", {}) for name in SCRIPTS)
    return filled("page.html", {
        "title": html.escape(title), "style": filled("page.css", {}),
        "script": f'"use strict";\n{script}',
        "header": json.dumps(header, allow_nan=False, separators=(",", ":")).replace(
            "<", "\\u003c"),
        "numbers": base64.b64encode(blocks.bytes()).decode()})


def speed_of(t: NDArray) -> float:
    """Simulated time for each second of playing."""
    duration = float(t[-1] - t[0])
    if REAL_TIME[0] <= duration <= REAL_TIME[1]:
        return 1.0
    rough = duration / SECONDS
    power = 10.0 ** np.floor(np.log10(rough))
    return float(next(k * power for k in (1, 2, 5, 10) if k * power >= 0.999 * rough))


def _most_frames(result: Result) -> int:
    """Frames of a page, fewer for large models."""
    model = result.model
    numbers = 7 * len(model.nodes) + sum(7 + len(body.reduced.stiffness)
                                         for body in model.bodies.values())
    numbers += numbers_of_ropes(model)
    return int(np.clip(NUMBERS // max(numbers, 1), FEWEST_FRAMES, FRAMES))


def _header(blocks: Blocks, result: Result, drawn: Scenery) -> dict:
    """Header that the page reads: lengths / characteristic length, places from the middle."""
    places = seen_places(drawn)
    measure = Measure(extent(drawn.nodes), (places.min(axis=0) + places.max(axis=0)) / 2)
    fields = colourings(drawn.bodies, drawn.units)
    stress = next((field.largest for field in fields if field.name == "von_mises"), 1.0)
    return {
        "about": _about(result, drawn), "cautions": result.cautions,
        "time_unit": drawn.units.time if drawn.units else "",
        "t": blocks.values(drawn.t[:, None], 1e-6 * np.ptp(drawn.t)),
        "size": measure.size, "middle": measure.middle.tolist(),
        "bodies": page_bodies.bodies(blocks, drawn, measure, stress),
        "entries": [entry._asdict() for entry in drawn.entries],
        "nodes": page_bodies.nodes(blocks, result, drawn, measure),
        "contacts": page_bodies.contacts(blocks, drawn, measure),
        "ropes": page_bodies.ropes(blocks, drawn, measure),
        **page_bodies.marks(blocks, drawn),
        "sign": _sign(drawn, measure), "view": _view(drawn, measure.places(places), measure.size),
        "trace": list(drawn.nodes).index(drawn.farthest),
        "fields": [_field(field) for field in fields], "planar": drawn.planar,
        "palette": {name.lower(): value for name, value in vars(palette).items()
                    if name.isupper()},
    }


def _field(one: Colouring) -> dict:
    return {"name": one.name, "title": one.title, "unit": one.unit, "largest": one.largest,
            "peak": {"value": one.largest, "frame": one.frame, "body": one.body,
                     "station": one.station}}


def _sign(drawn: Scenery, measure: Measure) -> float:
    """Size of signs: smaller where nodes are near each other."""
    places = np.array([node.position[0] for node in drawn.nodes.values()])
    places = np.unique(np.round(measure.places(places), 6), axis=0)
    if len(places) < 2:
        return SIGN
    apart = np.median(cKDTree(places).query(places, 2)[0][:, 1])
    return SIGN * float(np.clip(apart / FAR, SMALLEST, 1.0))


def _view(drawn: Scenery, places: NDArray, size: float) -> dict:
    """The place of the eye at the start, and the grid."""
    radius = max(float(np.linalg.norm(places, axis=1).max()), 0.35)
    floor = np.asarray(drawn.floor, dtype=float)
    spacing = 10.0 ** np.floor(np.log10(radius * size)) / size
    spacing *= next(k for k in (0.2, 0.5, 1.0) if radius / (k * spacing) <= 10)
    return {"up": drawn.up.tolist(), "towards": drawn.towards.tolist(), "target": [0.0] * 3,
            "radius": ROOM * radius,
            "floor": {"middle": (((places @ floor).min() - 0.06) * floor).tolist(),
                      "normal": floor.tolist(), "half": 1.6 * radius, "spacing": float(spacing)}}


def _about(result: Result, drawn: Scenery) -> str:
    model = result.model
    bodies = len(model.bodies) + len(model.rigid_bodies)
    return (f"{bodies} bod{'ies' if bodies != 1 else 'y'}, {result.numbering.free} unknowns, "
            f"t = {drawn.t[0]:.6g} to {drawn.t[-1]:.6g}, {len(drawn.t)} frames")
