"""Animations: one page of HTML that needs nothing else, or a film."""

from pathlib import Path

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target, replacing
from sebody.basics.spelling import naming_arguments
from sebody.pictures import film
from sebody.pictures.drawing import overview
from sebody.pictures.notebook import Page, ShownFile
from sebody.pictures.page_data import page, speed_of
from sebody.pictures.scene import scenery
from sebody.results.result import Result

SUFFIXES = ".html", ".gif", ".mp4"
COLOURS = "body", "displacement", "von_mises"
LONGEST = 30.0          # seconds of a film without a speed


@naming_arguments
def animate(result: Result, output: str | Path | None = None, *quantities: str, title: str = "",
            speed: float | None = None, colour: str | None = None,
            reference: str | None = None) -> ShownFile | Page:
    """An animation of a result, which a notebook shows, written to a file if one is given.

    A page shows the model from any side, at any speed, with deformations to scale or enlarged,
    coloured by displacement or stress, with paths of nodes, loads, and plots of any quantity; it
    needs no network and no other file. Superelements with cells show their surface, beams their
    sections; bodies of reduced matrices alone are lines between their nodes.

    Parameters
    ----------
    result : Result
    output : str or Path, optional
        File to write: html, or a film, gif (extra ``plot``) or mp4 (extra ``film``). Without one
        a page is returned.
    *quantities : str
        What a page plots first, by names as for `sebody.results.plot`; an overview by default.
    title : str
        Heading; the name of the file by default.
    speed : float, optional
        Simulated time for each second of playing; chosen by the duration by default.
    colour : {'body', 'displacement', 'von_mises'}, optional
        What bodies are coloured by, in a page at first. By default a page shows displacements if
        there are any, a film the bodies.
    reference : str, optional
        Node that displacements of its body, and of bodies welded to it, are measured from, or
        ``"frame"``, the floating frames of all bodies; by default the first node of each body that
        is fixed, else the first one with a joint. A page can change it.

    Returns
    -------
    ShownFile or Page
        The path of the file written; without one the page, with a method `save`.

    Raises
    ------
    InputError
        A quantity there is not, a result of one state, a speed that makes too long a film, a
        colour or reference that no body has, a missing package, or a file that cannot be written.
    WriteError
        Writing fails; an older file is unchanged.
    """
    inputs.instance(result, "result", Result, "give the Result of a run")
    if speed is not None:
        speed = inputs.number(speed, "speed", above=0)
    if colour is not None:
        _check_colour(result, inputs.choice(colour, "colour", COLOURS))
    title = inputs.text(title, "title")
    if output is None:
        return Page(page(result, quantities or overview(result), title or "animation", speed,
                         colour, reference))
    path = ShownFile(check_animation(output))
    title = title or path.stem
    if path.suffix == ".html":
        text = page(result, quantities or overview(result), title, speed, colour, reference)
        with replacing(path, "animation") as file:
            file.write(text.encode())
        return path
    if quantities:
        raise InputError(f"a film cannot show plots, such as of {quantities[0]}: make a page "
                         "(.html), or leave the quantities out")
    drawn = scenery(result, film.MOST_FRAMES, colour == "von_mises", reference)
    duration = drawn.t[-1] - drawn.t[0]
    speed = speed or max(speed_of(drawn.t), duration / LONGEST)
    count = film.frames_of(duration, speed, path.suffix)
    with replacing(path, "animation") as file:
        film.write_film(drawn, title, path, count, file, None if colour == "body" else colour)
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


def _check_colour(result: Result, colour: str) -> None:
    """Refuse a colour that no body has."""
    shapes = {name: body.reduced.recovery for name, body in result.model.bodies.items()}
    drawn = {name: one for name, one in shapes.items() if one is not None and one.cells}
    if colour == "displacement" and not drawn:
        raise InputError("colour is 'displacement', but no body of the model has the cells of an "
                         "FE model, which colours need: leave colour out")
    if colour == "von_mises" and not any(one.stress for one in drawn.values()):
        raise InputError("colour is 'von_mises', but the stresses of all bodies are unknown "
                         f"({', '.join(drawn) or 'none has cells'}): give FE models with a "
                         "material or stress=, or leave it out")
