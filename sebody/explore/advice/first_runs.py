"""Beginning of a search: runs of the reference model with several steps, and guards."""

from dataclasses import replace

import numpy as np

from sebody.basics.errors import InputError, SimulationError
from sebody.explore.advice.changes import Choice, Step
from sebody.explore.advice.estimates import Estimates
from sebody.explore.advice.guards import (
    OFF_GRID,
    Scales,
    amplified,
    disturbed,
    off_the_grid,
)
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.judgement import SHARE, SHORTER, judge
from sebody.explore.advice.labels import in_brief
from sebody.explore.advice.loads import SEEN
from sebody.explore.advice.outcome import Trial
from sebody.explore.advice.quantities import sizes_of
from sebody.explore.advice.reference import ORDER_FACTOR, Reference, reference, still
from sebody.explore.advice.runner import FINER, Laboratory, Tried
from sebody.explore.advice.runs import Run
from sebody.model.model import Model

GOOD = 0.2              # of the tolerance, that the reference may be off by without shorter steps
LARGEST = 0.9           # relative tolerance, that an absolute one is at most
LONGER = (2, 4)         # given steps, that a step may be
MISSED = 0.2            # of a load, that steps which are tried may not see
REGULAR = 0.05          # error from which errors by the step fall as they will for shorter ones
COARSE = 0.02           # error by a step up to the given one, with which forms are tried alone
LONGEST = 2.0           # of the tolerance, that a longer step is expected to be off by
SHORTEST = 64           # parts of the given step, of the grid


def run_first(lab: Laboratory) -> None:
    """Run the reference, and judge it.

    Raises
    ------
    InputError
        Quantities that do not exist or do not change, or a tolerance that the reference model
        does not reach.
    SimulationError
        It does not run, or its error does not fall with the step.
    """
    _shorten(lab)
    choice = lab.detailed
    first = lab.run_detailed(choice.step.h)
    for k in still(first.values):
        what = f"quantity {lab.quantities.histories[k]!r} does not change"
        if not np.ptp(first.result.recorded("q"), axis=0).any():
            raise InputError(f"{what}: the model does not move; give it loads, a drive or "
                             "initial velocities")
        raise InputError(f"{what}: give one that the motion changes")
    if lab.absolute is not None:
        lab.tolerance = min(lab.absolute / max(sizes_of(first.values)), LARGEST)
    _with_several_steps(lab)
    judge(lab.reference, lab.tolerance, lab.runs.h, lab.bases)
    lab.unit = lab.cost.work(choice, lab.bases[min(lab.bases)].iterations)
    _lengthen(lab)
    lab.table += [Trial(in_brief(lab.parts, choice), h, 0.0, run.seconds)
                  for h, run in sorted(lab.bases.items())]
    _guard(lab)
    _learn(lab, choice, first)


def _with_several_steps(lab: Laboratory) -> None:
    """Run the reference model until its error is known, and small where shorter steps help."""
    for part in FINER[1:]:
        try:
            lab.run_detailed(lab.runs.h / part)
        except SimulationError:
            if part > 1:
                raise
            lab.run_detailed(lab.runs.h / SHORTER[0])    # the fall of errors needs three runs
    lab.reference = _reference(lab)
    for part in SHORTER:
        if lab.runs.h / part in lab.bases:
            continue
        most = ORDER_FACTOR**(len(SHORTER) - SHORTER.index(part))
        hopeless = (lab.reference.step_error < REGULAR
                    and lab.reference.step_error / most > lab.tolerance)
        if lab.reference.error <= GOOD * lab.tolerance or hopeless:
            break
        lab.run_detailed(lab.runs.h / part)
        lab.reference = _reference(lab)


def _learn(lab: Laboratory, choice: Choice, first: Run) -> None:
    """Put the runs so far and their errors into the table, and begin estimates with them."""
    errors = {h: lab.error(run) for h, run in lab.bases.items()}
    finest = min(errors)
    errors[finest] = max(lab.reference.step_error, lab.reference.error)
    lab.table = [replace(one, error=errors[one.step]) if one.kind == "reference" else one
                 for one in lab.table]
    for h in sorted(errors):
        run = lab.bases[h]
        lab.tried.append(Tried(choice._replace(step=Step(h)), errors[h], errors[h],
                               run.seconds, lab.worst(run), run.h))
    recorded = Recorded(lab.model, first.result, lab.quantities.wholes(first.result),
                        lab.reference.sizes, first.values.frequencies, lab.parts)
    lab.estimates = Estimates(recorded, lab.parts,
                              {Step(h): error for h, error in errors.items()})


def _shorten(lab: Laboratory) -> None:
    """Take a part of the given step as the grid where loads need shorter ones.

    Raises
    ------
    InputError
        No part that is tried resolves a load.
    """
    if not lab.quantities.histories:
        return
    given = lab.runs.h
    while (load := lab.missed(lab.runs.h / FINER[0])).share > SEEN:
        lab.runs.h /= 2
        if given / lab.runs.h > SHORTEST:
            raise InputError(
                f"{load.name} changes too fast for the step: even steps of "
                f"{2 * lab.runs.h / FINER[0]:.3g} miss {load.share:.0%} of it, most at t = "
                f"{load.time:.5g}; give a smaller h than {given:g}")
        lab.remarks = [f"{load.name} needs shorter steps than those of {given:g}: the grid "
                       f"is {lab.runs.h:g}"]


def _lengthen(lab: Laboratory) -> None:
    """Find the longest step that the motion is resolved with: forms are tried with it alone."""
    if not lab.quantities.histories:
        lab.trial = Step(max(lab.bases))
        return
    _try_longer(lab)
    # unresolved vibrations make forms differ by up to the error of the step
    most = {h: COARSE if h <= lab.runs.h else SHARE * lab.tolerance for h in lab.bases}
    resolving = [h for h, run in lab.bases.items() if lab.worst(run).error <= most[h]]
    lab.trial = Step(max(resolving, default=min(lab.bases)))


def _try_longer(lab: Laboratory) -> None:
    """Run the reference model with longer steps than the given one where they may do."""
    h, count = lab.runs.h, round(lab.runs.t_end / lab.runs.h)
    for k in LONGER:
        error = lab.worst(lab.bases[max(lab.bases)]).error
        if (count % k or ORDER_FACTOR * error > LONGEST * lab.tolerance
                or lab.missed(k * h).share > MISSED):
            return
        try:
            lab.run_detailed(k * h)
        except (InputError, SimulationError):       # such as a step that divides no period
            return


def _guard(lab: Laboratory) -> None:
    """Run the reference model off the grid, and disturbed: what that casts doubt on."""
    fine = min(lab.bases)
    lab.warnings = lab.bases[fine].result.warnings
    if not lab.quantities.histories:
        return
    whole = lab.builder.build(lab.detailed)
    step = Step(_off_grid(fine, whole))
    known = lab.bases[fine].values.frequencies
    run = lab.beside(whole, step, "off the grid of all others", 1, known)
    off, doubt = off_the_grid(run.result, run.values, step.h, lab.reference, lab.runs.h)
    lab.table[-1] = replace(lab.table[-1], error=off)
    coarse = min(lab.trial.h, max(h for h in lab.bases if h <= lab.runs.h))
    still = lab.bases[coarse].result
    scales = Scales.of(still)
    other = lab.beside(disturbed(whole, scales), Step(coarse), "slightly disturbed", 0, known)
    lab.table[-1] = replace(lab.table[-1], error=lab.apart(other, coarse))
    growth = amplified(other.result, still, scales)
    lab.doubts += [doubt, growth.doubt]
    lab.remarks += growth.remark


def _off_grid(fine: float, model: Model) -> float:
    """A step that is slightly shorter than another one; it divides the periods of samples, too."""
    periods = [one.period for one in model.sensors.values() if one.period]
    periods += [one.period for one in model.controllers.values() if one.period]
    return max(periods) / (round(max(periods) / fine) + 1) if periods else OFF_GRID * fine


def _reference(lab: Laboratory) -> Reference:
    values = [lab.bases[h].values for h in sorted(lab.bases, reverse=True)]
    return reference(values, lab.absolute is not None)
