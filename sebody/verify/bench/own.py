"""Runs of this package: the shipped scenes with the settings of the table."""

import statistics
from typing import TYPE_CHECKING, NamedTuple

from sebody.assembly.body_constants import superelement_constants
from sebody.catalogue import builder
from sebody.engine.system import System
from sebody.kernels.loader import element_kernel, load
from sebody.model.parts import Superelement
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.verify.bench.measurement import Measurement
from sebody.verify.references import tip_error

if TYPE_CHECKING:
    from sebody.scenes.scene import Scene

CHAINS = (1, 4, 16, 64, 256, 1024)
LOOPS = (2, 20)
MODES = (4, 16, 32, 64)
OPTION_B = ", inertia material"    # with the paper's option, beside the default


class Case(NamedTuple):
    """One line of the table."""

    scene: str              # name of a scene, or what is varied in one
    variant: str
    parameters: dict        # of its build
    t_end: float
    reference: str          # name of a file of reference data, or nothing
    runs: int

    def build(self) -> "Scene":
        """The scene itself."""
        return builder("hinged-beam" if self.scene == "modes" else self.scene)(**self.parameters)


def cases(scene: str) -> list[Case]:
    """Cases of a scene: chains of several lengths, one of every other scene.

    Of "modes" the hinged beam with several numbers of them. Flexible bodies have the default
    inertia, then option B. The first four cases have the kernels of all.
    """
    if scene == "heavy-top":
        return [Case(scene, "rigid body", {}, 0.0, "", 9)]
    if scene == "four-bar":
        return [Case(scene, f"{n} loops", {"loops": n}, 0.0, "", 3) for n in LOOPS]
    if scene == "modes":
        cases_of_scene = [Case(scene, f"12 + {n} coordinates", {"modes": n}, 0.0, "hinged_beam", 5)
                          for n in MODES]
    elif scene == "chain":
        cases_of_scene = [Case(scene, f"{n} links", {"links": n}, 1.0, "", 9 if n < 256 else 3)
                          for n in CHAINS]
    elif scene == "slider-crank":
        cases_of_scene = [Case(scene, "4 superelements", {"bodies": 4, "modes": 0}, 0.0, "", 5)]
    else:
        name = "spherical_beam" if scene == "spherical-beam" else "hinged_beam"
        cases_of_scene = [Case(scene, "superelement", {}, 0.0, name, 9)]
    return [one for case in cases_of_scene for one in (case, case._replace(
        variant=case.variant + OPTION_B, parameters=case.parameters | {"inertia": "material"}))]


def measure(case: Case) -> Measurement:
    """Run a case several times; time and error are taken from the same runs."""
    results = [_run(case) for _ in range(case.runs)]
    last = results[-1]
    error = (tip_error(case.reference, last.t, last["tip.position"]) if case.reference else None)
    return Measurement(
        case.scene, case.variant, last.numbering.free, float(last.t[1] - last.t[0]),
        statistics.median(r.microseconds_per_step for r in results), last.iterations_per_step,
        error, statistics.median(r.seconds for r in results), flops_per_step(last))


def _run(case: Case) -> Result:
    scene = case.build()
    return Simulation(scene.model, scene.h).run_to(case.t_end or scene.t_end).result()


def flops_per_step(result: Result) -> float:
    """Floating-point operations a step: forces and substitutions of its iterations.

    From the operation counts of the kernels. Iteration matrices are left out, so the fraction of
    the machine's rate that is reached is a lower bound.
    """
    system, bodies = result.system, list(result.model.bodies.values())
    forces = sum(_kernel_flops(body) for body in bodies)
    forces += sum(element_kernel(item.kind).OPERATIONS["residual"][0]
                  for item in (*result.model.rigid_bodies.values(),
                               *result.model.constraints, *result.model.loads))
    return result.iterations_per_step * (forces + _solve_flops(system))


def _kernel_flops(body: Superelement) -> float:
    kernel = load(body.kernel)
    alone, position, rotation, products = kernel.OPERATIONS["residual"]
    n = len(body.reduced.stiffness)
    full = superelement_constants(body)["full"][0] if kernel.N_MODES is None else n
    return (alone + position * len(body.positions) + rotation * len(body.rotations)
            + 2.0 * products * (full * (2 * n - full) + n - full))


def _solve_flops(system: System) -> float:
    """A product with the inverse, or substitution in the blocks of the factors."""
    return 2.0 * system.rows.size
