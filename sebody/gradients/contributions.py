"""Contributions of every part of a model to some quantities: modes and flexibility of its bodies,
by one run and one sweep for all, and their options, by a run each.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import NamedTuple, cast
from warnings import catch_warnings, simplefilter

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError, LimitWarning
from sebody.basics.spelling import unknown
from sebody.engine.state import Scheme
from sebody.gradients.gradient import Differentiated, fitting
from sebody.gradients.ranking import Contributions, ranked
from sebody.gradients.responses import Histories, linearized
from sebody.gradients.simplifications import Amplitude, Deformation, Motion
from sebody.gradients.support import refuse_laws, refuse_model, refuse_scheme
from sebody.model.model import Model
from sebody.model.variants import with_options
from sebody.runs.simulation import Simulation
from sebody.runs.steps import whole_steps
from sebody.runs.whole_runs import simulate
from sebody.small_motion.moved_states import ADDED_UP, UNMOVED


class Options(NamedTuple):
    """Those of `with_options`."""

    inertia: str | None
    stiffening: bool


class Simplification(NamedTuple):
    """A body that is simplified: by what it loses of the motion, or by other options."""

    body: str
    change: str
    motions: tuple[Motion, ...] = ()
    options: Options | None = None


def contributions(model: Model, h: float, t_end: float, quantities: str | Iterable[str],
                  bodies: Iterable[str] | None = None, scheme: Scheme | None = None
                  ) -> Contributions:
    """Contributions of modes, flexibility and options of each body to some quantities.

    The model runs once. Its equations, linearized along this run, then tell how it would move
    without each mode and with each body rigid: changes of first order, over all of the run. What
    stiffening and the inertia option contribute is the exact change, by a run each. A run with half
    the step says what the step changes.

    Parameters
    ----------
    model : Model
        As rich as it may have to be. Stays as it is.
    h, t_end : float
        Fixed step, and end of the run, a multiple of it [time].
    quantities : str or iterable of str
        Names as results have them.
    bodies : iterable of str, optional
        Superelements that are looked at; all by default.
    scheme : Scheme, optional
        `generalized_alpha` with rho 0.9 and a tolerance of 1e-10 by default.

    Raises
    ------
    InputError
        Unknown names, quantities that do not change or have no derivatives, no superelements,
        features of the model that are not differentiated, see `gradient`.
    SimulationError
        The run fails.

    Examples
    --------
    >>> found = contributions(model, 0.01, 5.0, ["tip.position", "hinge.force"])
    >>> print(found)
    >>> found.history("tip.position", "beam", "without mode 1")
    """
    inputs.instance(model, "model", Model, "give a sebody.Model")
    h = inputs.number(h, "h", above=0)
    t_end = h * whole_steps(inputs.number(t_end, "t_end", above=0), h)
    names = _names(quantities)
    chosen = _bodies(model, bodies)
    refuse_model(model)
    began, scheme = time.perf_counter(), fitting(scheme)
    refuse_scheme(scheme, "contributions")
    one = Differentiated(model, h, t_end, scheme)
    refuse_laws(one.run, "contributions")
    each = simplifications(one.run, chosen)
    like = [j for j, simpler in enumerate(each) if simpler.options is None]
    values, found = linearized(one, [each[j].motions for j in like], names)
    changes = {name: np.full((*own.shape, len(each)), np.nan) for name, own in values.items()}
    for name in names:
        changes[name][..., like] = found[name]
    for j, simpler in enumerate(each):
        if simpler.options is not None:
            _measure(model, simpler, h, t_end, scheme, values, changes, j)
    rows, order = ranked(names, [(simpler.body, simpler.change) for simpler in each],
                         one.history.times, values, changes)
    with catch_warnings():
        simplefilter("ignore", LimitWarning)    # said of the run above
        finer = simulate(model, h / 2, t_end, scheme=scheme, output_every=2)
    by_step = np.array([np.abs(finer[name] - own).max() / np.abs(own - own[0]).max()
                        for name, own in values.items()])
    return Contributions(names, one.history.times, values, rows,
                         {name: own[..., order] for name, own in changes.items()}, by_step,
                         time.perf_counter() - began, one.history.seconds)


def _measure(model: Model, simpler: Simplification, h: float, t_end: float, scheme: Scheme,
             values: Histories, changes: Histories, j: int) -> None:
    """Changes by other options, from a run with these."""
    assert simpler.options is not None
    made = with_options(model, simpler.body, inertia=simpler.options.inertia,
                        stiffening=simpler.options.stiffening).model
    result = simulate(cast(Model, made), h, t_end, scheme=scheme)
    for name, own in values.items():
        changes[name][..., j] = result[name] - own


def _names(quantities: str | Iterable[str]) -> tuple[str, ...]:
    given = [quantities] if isinstance(quantities, str) else inputs.items(
        quantities, "quantities", "give names of quantities")
    if not given:
        raise InputError("quantities: none is given; give names of quantities")
    for name in given:
        inputs.name(name, "name of a quantity")
        if name in UNMOVED or name.endswith(ADDED_UP):
            raise InputError(f"quantity {name!r} is no function of a state: give a motion, a force "
                             "or another quantity of a state")
    return tuple(dict.fromkeys(given))


def _bodies(model: Model, bodies: Iterable[str] | None) -> list[str]:
    if not model.bodies:
        raise InputError("the model has no superelement: there are no modes, flexibility or "
                         "options whose contributions could be found")
    if bodies is None:
        return list(model.bodies)
    given = inputs.items(bodies, "bodies", "give names of superelements")
    if not given:
        raise InputError("bodies: none is given; give names of superelements, or leave it out for "
                         "all")
    for name in given:
        if name not in model.bodies:
            raise unknown("superelement", name, model.bodies, "the model has", "the model has none")
    return list(dict.fromkeys(given))


def simplifications(run: Simulation, bodies: Iterable[str]) -> list[Simplification]:
    """Every mode left out, every body rigid, every simpler option, of some bodies."""
    model, numbering = run.model, run.numbering
    found = []
    for name in bodies:
        body = model.bodies[name]
        each = amplitudes(run, name)
        found += [Simplification(name, f"without mode {k}", (one,)) for k, one in enumerate(each)]
        if len(each) > 1:
            found.append(Simplification(name, "without modes", tuple(each)))
        found.append(Simplification(name, "rigid", (Deformation(body, numbering),)))
        if body.stiffening:
            found.append(Simplification(name, "without stiffening", options=Options(
                None, False)))
        if body.inertia == "floating_field":
            found.append(Simplification(name, "inertia 'material'", options=Options(
                "material", False)))
    return found


def amplitudes(run: Simulation, body: str) -> list[Motion]:
    """Those of all modes of a superelement."""
    first, total = run.numbering.modes.get(body, 0), run.numbering.total
    return [Amplitude(first + k, total) for k in range(run.model.bodies[body].reduced.modes)]
