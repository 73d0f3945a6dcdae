"""Choice between runs that are made eight at a time and one by one: a table of facts.

The choice depends on the model, its parameters and the number of steps of all runs, never on which
runs are asked for together or on what was compiled before: a run has the same bits in both.
"""

import numpy as np

from sebody.assembly.equal_bodies import most_together
from sebody.compiler import choice
from sebody.contract.counts import MEMBERS
from sebody.explore.ensembles.start_values import OWN_STARTS, Fact, Image
from sebody.kernels.loader import element_kernel_name, takes_one_member
from sebody.model.model import Model
from sebody.runs.simulation import Simulation

WORTH_IT = 500_000      # steps of all runs together, a second or more one by one


FACTS = (       # each lets runs be made one by one alone
    *OWN_STARTS,
    Fact("sensors that Python reads, one run at a time",
         lambda one: bool(one.system.control.outside[0])),
    Fact("sampled controllers with index 2 or motions without mass", lambda one: bool(
        one.system.control.periods.size
        and (one.scheme.stabilized or one.system.massless[0]))),
    Fact("elements that keep numbers, as contacts and friction, among rigid bodies alone",
         lambda one: not one.model.bodies and any(
             element.law is None for element in one.numbering.memories)),
    Fact("joints and forces on paths, whose places are looked up in one run at a time",
         lambda one: any(e.path is not None for e in (*one.model.constraints, *one.model.loads))),
    Fact("springs by tables, whose rows are looked up in one run at a time",
         lambda one: any(e.kind.removeprefix("planar_").startswith("table_")
                         for e in one.model.loads)),
    Fact("eight equal bodies or more, which each run evaluates eight at a time",
         lambda one: most_together(one.model) >= MEMBERS),
)


def why_one_by_one(template: Simulation) -> str:
    """The reason why runs of a model are made one by one; empty where eight go at a time.

    Parameters
    ----------
    template : Simulation
        Of the model as built.
    """
    if reason := choice.why_no_lanes():
        return reason
    for fact in FACTS:
        if fact.holds(template):
            return fact.reason
    return ""


def matrices_at_once(template: Simulation) -> bool:
    """Tell if matrices of eight members are made at once: members want them in nearly every step.

    So they do in large models of bodies that rotate against each other.
    """
    system = template.system
    return (not template.dense and bool(system.linked[0]) and not system.regularized[0]
            and not system.control.periods.size
            and not any(takes_one_member(name) for name in kernels_of(template.model)))


def why_parameters_part(image: Image) -> str:
    """The reason why runs with some parameters go one by one, where the model allows eight."""
    if not image.linear:
        return "with these parameters the model is built anew for each run"
    from sebody.engine.lanes.arrays import shared_places  # imports the lanes

    one, slots = image.template, image.lines.slots
    if any(np.any((slots >= part.start) & (slots < part.stop))
           for part in shared_places(one.system, one.state, image.offsets)):
        return "these parameters change what runs made eight at a time have in common"
    return ""


def kernels_of(model: Model) -> list[str]:
    """Names of the kernels of a model."""
    elements = (*model.rigid_bodies.values(), *model.constraints, *model.loads)
    return sorted({body.kernel for body in model.bodies.values()}
                  | {element_kernel_name(element.kind) for element in elements})
