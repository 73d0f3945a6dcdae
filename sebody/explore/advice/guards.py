"""Two further runs of the reference model, which the reference could not agree with by chance.

One has steps that share no grid with those of all others: what falls between these, such as a pulse
or a contact, falls on its steps. The other one is slightly disturbed, in all coordinates: where the
motion is unstable, symmetry may keep every other run on a path that no real system follows.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from sebody.explore.advice.measures import lengths
from sebody.explore.advice.outcome import Doubt
from sebody.explore.advice.quantities import Values
from sebody.explore.advice.reference import Reference
from sebody.model.model import Model
from sebody.model.numbering import Numbering, stretch
from sebody.model.variants.copying import copied
from sebody.results.result import Result

OFF_GRID = 0.9271       # of the shortest step: a step that shares no grid with it
NEAR = 4.5              # steps beside a jump of a load, where splines of forces ring
JUMP = 0.05             # of a history's largest value, that counts as a jump
EXPECTED = 3.0          # times the reference's error by its step, that another step may make

SMALL = 1e-6            # of velocities, by which a run is disturbed
FORCES = 0.01           # of that, as forces: soft directions yield by far more than stiff ones
GROWTH = 20.0           # times what a drift at the disturbed velocity makes: more is unstable
TOLD = 5.0              # of the same: more may be, and is said
REAL = 1e-3             # of the motion, that real systems are disturbed by


def off_the_grid(run: Result, values: Values, h: float, reference: Reference,
                 grid: float) -> tuple[float, Doubt]:
    """The distance of a run whose steps share no grid with others from the reference.

    If that is more than the step explains, it is an error that the reference may have.

    Parameters
    ----------
    run : Result
        Recorded at every step.
    values : Values
        Its quantities.
    h : float
        Its step.
    reference : Reference
    grid : float
        Step of the reference's grid.
    """
    worst, where = 0.0, 0.0
    for own, best, size in zip(values.histories, reference.values.histories, reference.sizes,
                               strict=True):
        times = grid * np.arange(len(best))
        clear = (times <= run.t[-1]) & ~_near(times, _jumps(run.numbering), NEAR * h)
        off = lengths(CubicSpline(run.t, own)(times[clear]) - best[clear]) / size
        if off.size and off.max() > worst:
            worst, where = float(off.max()), float(times[clear][np.argmax(off)])
    explained = worst <= EXPECTED * (reference.step_error + reference.error)
    return worst, Doubt(
        0.0 if explained else worst,
        f"a run with steps of {h:.4g}, which share no grid with the others, is off by {worst:.2g} "
        f"at t = {where:.4g}: loads or forces act between steps", "give a smaller h")


def _jumps(numbering: Numbering) -> NDArray:
    """Times at which loads and drives jump, or may."""
    times: list[float] = []
    for _, history in numbering.courses:
        if history.functions:
            times += history.corners
            continue
        jumps = history.jumps()
        sizes = np.max([np.abs(after) for _, _, after in jumps], axis=0) if jumps else 0.0
        times += [t for t, before, after in jumps
                  if (np.abs(after - before) > JUMP * np.maximum(sizes, np.abs(before))).any()]
    return np.array(times)


def _near(times: NDArray, others: NDArray, distance: float) -> NDArray:
    """Times that are near one of others."""
    close = np.zeros(len(times), dtype=bool)
    for t in others:
        close |= np.abs(times - t) <= distance
    return close


class Scales(NamedTuple):
    """Scales of a run: travel and speeds of positions, speed of rotations, force, duration."""

    travel: float
    speed: float
    spin: float
    force: float
    duration: float

    @classmethod
    def of(cls, run: Result) -> "Scales":
        """Those of a run."""
        places, turns = (_solved(run, kind) for kind in (False, True))
        v = run.recorded("v")
        travel = float(np.ptp(run.recorded("q")[:, places], axis=0).max(initial=0.0))
        speed = float(np.abs(v[:, places]).max(initial=0.0))
        spin = float(np.abs(v[:, turns]).max(initial=0.0))
        energy = float((run["energy.kinetic"] + np.abs(run["energy.strain"])).max())
        return cls(travel, speed, spin, energy / travel if travel > 0.0 else 0.0, float(run.t[-1]))


def _solved(run: Result, rotational: bool) -> NDArray:
    """Coordinates of all positions, or rotations, that are solved for."""
    columns = [range(run.numbering.free)[stretch(run.numbering, dof_block)]
               for dof_block in run.model.dof_blocks()
               if dof_block.solved and dof_block.rotational == rotational]
    return np.array([k for one in columns for k in one], dtype=int)


def disturbed(model: Model, scales: Scales) -> Model:
    """A model with small random velocities and forces at all nodes that are free to move."""
    made, rng = copied(model), np.random.default_rng(29)
    for dof_block in made.dof_blocks():
        if dof_block.solved:
            size = scales.spin if dof_block.rotational else scales.speed
            noise = rng.uniform(-1.0, 1.0, dof_block.rate.shape)
            dof_block.rate = dof_block.rate + SMALL * size * noise
    free = [node for node in made.nodes.values() if node.position and node.position.solved]
    for node in free if scales.force > 0.0 else ():
        direction = rng.standard_normal(node.position.start.shape)
        direction *= FORCES * SMALL * scales.force / len(free)
        made.force(node, direction, name=f"disturbance of {node.name}")
    return made


class Growth(NamedTuple):
    """The end of a small disturbance of a motion.

    Parameters
    ----------
    factor : float
        Its size at the end, or at its largest, over that at the start.
    drift : float
        The same of motion that goes on as it is disturbed: of stable systems.
    """

    factor: float
    drift: float

    @property
    def doubt(self) -> Doubt:
        """Effect of a disturbance of a real system on the motion, if it grows."""
        growing = self.factor > GROWTH * self.drift
        return Doubt(min(REAL * self.factor, 1.0) if growing else 0.0,
                     f"the motion is unstable: a small disturbance of all velocities and loads "
                     f"grows to {self.factor:.2g} times its size",
                     "give the model the imperfection that it has, such as a small lateral "
                      "force, or an earlier end")

    @property
    def remark(self) -> list[str]:
        """Remark on a motion that grows a little, as over few times of an instability."""
        if not TOLD * self.drift < self.factor <= GROWTH * self.drift:
            return []
        return [f"a small disturbance grows to {self.factor:.2g} times its size until the end: "
                "the motion may be unstable over longer times"]


def amplified(run: Result, still: Result, scales: Scales) -> Growth:
    """The growth of a disturbance.

    Of models that move by rotations alone, angular velocities are looked at.

    Parameters
    ----------
    run, still : Result
        With and without the disturbance, with the same steps.
    """
    if scales.travel > 0.0:
        off = np.abs(run.recorded("q") - still.recorded("q"))[:, _solved(still, rotational=False)]
        return Growth(float(off.max(initial=0.0)) / (SMALL * scales.travel),
                      1.0 + scales.speed * scales.duration / scales.travel)
    if scales.spin == 0.0:
        return Growth(0.0, 1.0)
    off = np.abs(run.recorded("v") - still.recorded("v"))[:, _solved(still, rotational=True)]
    return Growth(float(off.max(initial=0.0)) / (SMALL * scales.spin), 1.0)
