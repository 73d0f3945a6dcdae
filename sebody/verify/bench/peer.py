"""The same scenes in Exudyn, an established C++ code, where it is installed.

Settings are those its documentation advises for speed: the build without range checks, modified
Newton, loads without Python in the loop, no output but one sensor.
"""

import statistics
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version as installed_version
from importlib.util import find_spec
from io import StringIO
from types import ModuleType

from sebody.basics.errors import InputError
from sebody.verify.bench.measurement import Measurement
from sebody.verify.bench.own import LOOPS, MODES
from sebody.verify.references import tip_error

NAME = "Exudyn"
BEAMS = ("hinged-beam", "planar-hinged-beam", "spherical-beam")     # scenes it has models of
LINKS = (1, 4, 16, 64, 256)


def available() -> bool:
    """Tell whether Exudyn can be imported; does not import it."""
    return find_spec("exudyn") is not None


def version() -> str | None:
    """Version of Exudyn, None where it is not installed."""
    try:
        return installed_version("exudyn")
    except PackageNotFoundError:
        return None


def told(scene: str | None = None) -> str:
    """Tell whether a chart has points of Exudyn, and why not, in a sentence."""
    if scene not in BEAMS:
        return f"peers: {NAME} has models of {', '.join(BEAMS)} alone, none of this scene"
    return f"peers: {NAME} {version()}" if available() else f"peers: {NAME} is not installed"


def measure(scene: str) -> list[Measurement]:
    """Run the peer's models of a scene.

    Raises
    ------
    InputError
        Exudyn is not installed.
    """
    if not available():
        raise InputError('Exudyn is not installed: pip install "sebody[bench]"')
    models, mechanisms = imported("peer_models"), imported("peer_mechanisms")
    if scene == "hinged-beam":
        runs = [_beam(scene, f"{NAME} reduced, 12 + 4 coordinates", models.reduced_beam, h)
                for h in (0.02, 0.01, 0.005)]
        return runs + [_beam(scene, f"{NAME} beams in space, {n} elements",
                             lambda h, n=n: models.spatial_beams(h, n), h)
                       for n in (2, 4) for h in (0.02, 0.01, 0.005)]
    if scene == "modes":
        return [_timed(scene, f"{NAME} reduced, 12 + {n} coordinates",
                       lambda h, n=n: models.reduced_beam(h, n, 3.0), 0.01) for n in MODES]
    if scene == "planar-hinged-beam":
        return [_beam(scene, f"{NAME} beams in a plane, {n} elements",
                      lambda h, n=n: models.planar_beams(h, n), h)
                for n in (2, 3, 4) for h in (0.04, 0.02, 0.01, 0.005)]
    if scene == "spherical-beam":
        reduced = _beam(scene, f"{NAME} reduced, 12 + 8 coordinates",
                        models.reduced_spherical_beam, 0.02)
        return [reduced, *(_beam(scene, f"{NAME} beams in space, {n} elements",
                                 lambda h, n=n: models.spherical_beam(h, n), 0.02)
                           for n in (2, 4))]
    if scene == "chain":
        return [_chain(models.chain, n) for n in LINKS]
    variants = {"four-bar": [(f"{NAME} {n} loops", lambda h, n=n: mechanisms.four_bar(h, n), 1e-3)
                             for n in LOOPS],
                "heavy-top": [(f"{NAME} rigid body", mechanisms.heavy_top, 1e-3)],
                "slider-crank": [(f"{NAME} beams in a plane, 4 elements", mechanisms.slider_crank,
                                  2e-5)]}
    return [_timed(scene, *variant) for variant in variants[scene]]


def imported(name: str) -> ModuleType:
    """A module of this folder that imports Exudyn, which prints when it is first imported."""
    sys.exudynFast = True
    with redirect_stdout(StringIO()):       # what is printed may be JSON
        return import_module(f"sebody.verify.bench.{name}")


def _beam(scene: str, variant: str, model: Callable, h: float) -> Measurement:
    """Three runs over 30 s; the path of the tip against the reference."""
    runs = [model(h) for _ in range(3)]
    path = runs[0].tip
    name = "spherical_beam" if scene == "spherical-beam" else "hinged_beam"
    seconds = statistics.median(run.seconds for run in runs)
    return Measurement(scene, variant, runs[0].unknowns, h, 1e6 * seconds / runs[0].steps,
                       runs[0].iterations, tip_error(name, path[:, 0], path[:, 1:]), seconds,
                       processor_seconds=min(run.processor_seconds for run in runs))


def _timed(scene: str, variant: str, model: Callable, h: float) -> Measurement:
    """Three runs of a mechanism, without a reference."""
    runs = [model(h) for _ in range(3)]
    seconds = statistics.median(run.seconds for run in runs)
    return Measurement(scene, variant, runs[0].unknowns, h, 1e6 * seconds / runs[0].steps,
                       runs[0].iterations, None, seconds)


def _chain(model: Callable, links: int) -> Measurement:
    """The first steps of a chain: all of a second, or less of a long one."""
    began = time.perf_counter()
    runs = [model(links, 100 if links <= 16 else 20)]
    while time.perf_counter() - began < 2.0 and len(runs) < 3:
        runs.append(model(links, 100 if links <= 16 else 20))
    seconds = statistics.median(run.seconds for run in runs)
    return Measurement("chain", f"{NAME} {links} links", runs[0].unknowns, 0.01,
                       1e6 * seconds / runs[0].steps, runs[0].iterations, None, seconds)

