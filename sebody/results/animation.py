"""Animations: one page of HTML that needs nothing else, or a film."""

import base64
import html
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody import inputs
from sebody.errors import InputError
from sebody.files import check_target, replacing
from sebody.results import film
from sebody.results.blocks import Blocks
from sebody.results.curves import Panel, panels
from sebody.results.drawing import overview
from sebody.results.notebook import Page, ShownFile
from sebody.results.result import Result
from sebody.results.scenery import DrawnBody, Scenery, extent, scenery
from sebody.results.templates import filled

SUFFIXES = ".html", ".gif", ".mp4"
SCRIPTS = ("numbers", "vectors", "motion", "shapes", "renderer", "camera", "scene", "plot", "main")
FRAMES = 1801           # at most: a minute of thirty a second
FEWEST_FRAMES = 201
NUMBERS = 3_000_000     # of all frames together, beyond which models have fewer of them
SEEN = 1e-5             # of the model's extent: smaller steps of a place are not seen
SIGN = 0.018            # size of signs, of the extent
ROOM = 1.1              # of what is seen at the start, over what moves
SAMPLED = 200           # frames at which the largest displacement is looked for
REAL_TIME = (2.0, 120.0)        # durations that are played at their own speed
SECONDS = 10.0          # that the others take
LONGEST = 30.0          # seconds of a film without a speed


def animate(result: Result, output: str | Path | None = None, *quantities: str, title: str = "",
            speed: float | None = None) -> ShownFile | Page:
    """An animation of a result, which a notebook shows, written to a file if one is given.

    A page shows the model from any side, at any speed, with deformations to scale or enlarged,
    coloured by displacement, with paths of nodes and plots; it needs no network and no other file.
    Superelements with cells show their surface, beams their sections; bodies of reduced matrices
    alone are lines between their nodes.

    Parameters
    ----------
    result : Result
    output : str or Path, optional
        File to write: html, or a film, gif (extra ``plot``) or mp4 (extra ``film``). Without one
        a page is returned.
    *quantities : str
        What the plots of a page show, by names as for `sebody.results.plot`; an overview by
        default.
    title : str
        Heading; the name of the file by default.
    speed : float, optional
        Simulated time for each second of playing; chosen by the duration by default.

    Returns
    -------
    ShownFile or Page
        The path of the file written; without one the page, with a method `save`.

    Raises
    ------
    InputError
        A quantity there is not, a result of one state, a speed that makes too long a film, a
        missing package, or a file that cannot be written.
    WriteError
        Writing fails; an older file is unchanged.
    """
    inputs.instance(result, "result", Result, "give the Result of a run")
    if speed is not None:
        speed = inputs.number(speed, "speed", above=0)
    if output is None:
        return Page(page(result, quantities or overview(result), title or "animation", speed))
    path = ShownFile(check_animation(output))
    title = title or path.stem
    if path.suffix == ".html":
        text = page(result, quantities or overview(result), title, speed)
        with replacing(path, "animation") as file:
            file.write(text.encode())
        return path
    if quantities:
        raise InputError(f"a film shows no plots, such as of {quantities[0]}: make a page (.html), "
                         "or leave the quantities out")
    drawn = scenery(result, film.MOST_FRAMES)
    duration = drawn.t[-1] - drawn.t[0]
    count = film.frames_of(duration, speed or max(_speed(drawn.t), duration / LONGEST), path.suffix)
    with replacing(path, "animation") as file:
        film.write_film(drawn, title, path, count, file)
    return path


def check_animation(output: str | Path) -> Path:
    """The path of an animation, refused before anything is computed for it.

    Raises
    ------
    InputError
        A file that cannot be written, or a package that is missing for a film.
    """
    path = check_target(output, "animation", SUFFIXES)
    if path.suffix != ".html":
        film.check_film(path.suffix)
    return path


def page(result: Result, quantities: Sequence[str], title: str,
         speed: float | None = None) -> str:
    """The text of the page."""
    drawn = scenery(result, _most_frames(result), stressed=True)
    plots = panels({"the result": result}, quantities)
    header, blocks = _header(result, drawn, plots)
    header["speed"] = speed or _speed(drawn.t)
    script = "\n".join(filled(f"{name}.js", {}) for name in SCRIPTS)
    return filled("page.html", {
        "title": html.escape(title), "style": filled("page.css", {}),
        "script": f'"use strict";\n{script}',
        "header": json.dumps(header, allow_nan=False).replace("<", "\\u003c"),
        "numbers": base64.b64encode(blocks.bytes()).decode()})


def _most_frames(result: Result) -> int:
    """Frames of a page, fewer for large models."""
    model = result.model
    numbers = 7 * len(model.nodes) + sum(7 + len(body.body.stiffness)
                                         for body in model.bodies.values())
    return int(np.clip(NUMBERS // max(numbers, 1), FEWEST_FRAMES, FRAMES))


def _header(result: Result, drawn: Scenery, plots: list[Panel]) -> tuple[dict, Blocks]:
    """What the page reads: lengths are of the model's extent, places from the middle."""
    blocks = Blocks()
    size, middle = extent(drawn.nodes), _middle(drawn)
    number = {name: k for k, name in enumerate(drawn.nodes)}
    largest = max((_largest(body) for body in drawn.bodies), default=0.0)
    stress = max((float(body.stress.max()) for body in drawn.bodies if body.stress is not None),
                 default=0.0)
    grounds = {node.name for node in result.model.grounds} - set(result.model.nodes)
    header = {
        "about": _about(result, drawn),
        "t": blocks.values(drawn.t[:, None], 1e-6 * np.ptp(drawn.t)),
        "bodies": [_body(blocks, body, middle, size, stress) for body in drawn.bodies],
        "nodes": [{"name": node.name, "ground": node.name in grounds,
                   "position": blocks.values((node.position - middle) / size, SEEN),
                   "rotation": None if node.rotation is None else blocks.values(node.rotation)}
                  for node in drawn.nodes.values()],
        "links": [{"kind": link.kind, "ends": [number[name] for name in link.ends]}
                  for link in drawn.links],
        "signs": [{"kind": sign.kind, "name": sign.name, "node": number[sign.node],
                   "carrier": number[sign.carrier], "axes": sign.axes.T.tolist()}
                  for sign in drawn.signs],
        "sign": SIGN, "view": _view(drawn, middle, size),
        "trace": number[drawn.farthest],
        "largest": {"displacement": largest / size, "stress": stress},
        "units": {"displacement": size, "stress": 1.0},
        "plots": [_plot(blocks, plot, drawn.states) for plot in plots if plot.kind == "history"],
    }
    return header, blocks


def _body(blocks: Blocks, body: DrawnBody, middle: NDArray, size: float, stress: float) -> dict:
    surface, modes = body.surface, body.amplitudes.shape[1]
    turning = modes and np.any(surface.turns)
    # rows: components of stations, columns: amplitudes
    moves, turns = (np.ascontiguousarray(shapes.reshape(modes, 3 * len(surface.points)).T)
                    for shapes in (surface.moves / size, surface.turns))
    return {"name": body.name, "modes_count": modes,
            "points": blocks.values(surface.points / size, SEEN / 10),
            "moves": blocks.values(moves), "turns": blocks.values(turns) if turning else None,
            "stations": blocks.indices(surface.stations),
            "offsets": (blocks.values(surface.offsets / size)
                        if np.any(surface.offsets) else None),
            "triangles": blocks.indices(surface.triangles), "edges": blocks.indices(surface.edges),
            "origin": blocks.values((body.origin - middle) / size, SEEN),
            "rotation": blocks.values(body.rotation),
            "amplitudes": blocks.values(body.amplitudes),
            "stress": (blocks.colours(body.stress / stress)
                       if body.stress is not None and stress > 0 else None)}


def _plot(blocks: Blocks, plot: Panel, states: NDArray) -> dict:
    values = np.column_stack([curve.y for curve in plot.curves])
    return {"title": plot.title, "labels": [curve.label for curve in plot.curves],
            "range": [float(values.min()), float(values.max())],
            "values": blocks.values(values[states])}


def _middle(drawn: Scenery) -> NDArray:
    places = np.concatenate([node.position for node in drawn.nodes.values()])
    return (places.min(axis=0) + places.max(axis=0)) / 2


def _view(drawn: Scenery, middle: NDArray, size: float) -> dict:
    """Where the eye is at the start, and the grid."""
    places = (np.concatenate([node.position for node in drawn.nodes.values()]) - middle) / size
    radius = max(float(np.linalg.norm(places, axis=1).max()), 0.35)
    floor = np.asarray(drawn.floor, dtype=float)
    spacing = 10.0 ** np.floor(np.log10(radius * size)) / size
    spacing *= next(k for k in (0.2, 0.5, 1.0) if radius / (k * spacing) <= 10)
    return {"up": drawn.up.tolist(), "towards": drawn.towards.tolist(), "target": [0.0] * 3,
            "radius": ROOM * radius,
            "floor": {"middle": (((places @ floor).min() - 0.06) * floor).tolist(),
                      "normal": floor.tolist(), "half": 1.6 * radius, "spacing": float(spacing)}}


def _largest(body: DrawnBody) -> float:
    """Largest displacement of a body by its deformation."""
    if not body.amplitudes.shape[1]:
        return 0.0
    stride = max(1, len(body.amplitudes) // SAMPLED)
    shapes = body.surface.moves.reshape(len(body.surface.moves), -1)
    return max(float(np.linalg.norm((row @ shapes).reshape(-1, 3), axis=1).max())
               for row in body.amplitudes[::stride])


def _speed(t: NDArray) -> float:
    """Simulated time for each second of playing."""
    duration = float(t[-1] - t[0])
    if REAL_TIME[0] <= duration <= REAL_TIME[1]:
        return 1.0
    rough = duration / SECONDS
    power = 10.0 ** np.floor(np.log10(rough))
    return float(next(k * power for k in (1, 2, 5, 10) if k * power >= 0.999 * rough))


def _about(result: Result, drawn: Scenery) -> str:
    model = result.model
    bodies = len(model.bodies) + len(model.rigid_bodies)
    return (f"{bodies} bod{'ies' if bodies != 1 else 'y'}, {result.numbering.free} unknowns, "
            f"t = {drawn.t[0]:.6g} to {drawn.t[-1]:.6g}, {len(drawn.t)} frames")
