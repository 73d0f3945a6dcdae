"""Reasons why a run stopped, and what to do about them."""

import numpy as np

from sebody.contract.layout import OFF_PATH
from sebody.engine.state import (
    FINEST,
    GAP,
    NO_START,
    REASONS,
    SLOW,
    State,
)
from sebody.engine.system import System
from sebody.model.model import Model
from sebody.model.numbering import Numbering
from sebody.model.path_joints import PATH, way_of
from sebody.results.contact_states import states
from sebody.runs import user_faults
from sebody.runs.redundancy import contradiction, multiplying, parties_of

MUCH = 1.0          # coefficient of friction above which a rod may jam before it slides
WITHOUT_MASS = ("The model has motions without mass, such as those of MacNeal's bodies, which jump "
                "where loads or contacts begin: give their nodes a mass by rigid_body, reduce "
                "these bodies by another method, such as rubin, or use")
KEPT = "results up to this time are kept"


def explained(model: Model, system: System, state: State, numbering: Numbering) -> str:
    """The message of a run whose last step failed."""
    time, reason = float(state.clock.time), int(state.control.reason)
    stopped = f"stopped at t = {time:.6g}"
    if fault := user_faults.fault(model, time):
        return f"{stopped}: {fault}; {KEPT}"
    if reason == OFF_PATH:
        return f"{stopped}: {_beyond(model, numbering, state)}; {KEPT}"
    if reason == GAP:
        if told := contradiction(system, state, numbering):
            return f"{stopped}: {told}; {KEPT}"
        reason = SLOW
    if reason == NO_START:
        return (f"{stopped}, where loads jump: {REASONS[reason]}, as "
                f"{_unsettled(system, state, numbering)}; {KEPT}")
    variable = state.control.adaptive == 1
    shortest = state.clock.chosen if variable else state.clock.step / FINEST
    if system.massless[0]:      # rates of what jumps are larger in shorter steps
        remedy = f"{WITHOUT_MASS} {'a larger tolerance' if variable else 'another step'}"
    else:
        remedy = (f"Use {'a larger tolerance' if variable else 'a smaller step'}, "
                  + ("check the loads, or divide bodies that bend far" if model.bodies else
                     "or check the loads"))
    return (f"{stopped}: {REASONS[reason]}, even with the step reduced to {shortest:.3g}; {KEPT}. "
            f"{remedy}{_jammed(model, numbering, state)}")


def _beyond(model: Model, numbering: Numbering, state: State) -> str:
    """The point that is at the end of its path, and the end: the nearest of all."""
    found = []
    for joint in model.joints:
        if joint.kind != PATH:
            continue
        on = joint.constraints[0].path
        assert on is not None           # of a joint of this kind
        way, path = way_of(joint, "a run"), on.path
        s, rate = (float(row[numbering.dof_blocks[way]]) for row in (state.q_old, state.v_old))
        found += [(abs(s - end) / path.length, f"joint {joint.name!r} comes to the {word} of path "
                   f"{path.name!r}, whose length is {path.length:.6g}: its way is {s:.6g} and the "
                   f"rate {rate:.3g}; give the path ends='straight' or 'stop', or hold the joint "
                   "before")
                  for end, word, kind in zip((0.0, path.length), ("beginning", "end"), path.ends,
                                             strict=True) if kind == "refuse"]
    return min(found)[1]


def of_start(system: System, state: State, numbering: Numbering) -> str:
    """The message of a run whose first state has no accelerations."""
    reason = int(state.control.reason)
    why = REASONS[reason]
    if reason == NO_START:
        why += f", as {_unsettled(system, state, numbering)}"
    return f"the initial state has no accelerations: {why}"


def _unsettled(system: System, state: State, numbering: Numbering) -> str:
    """Name the largest of the last corrections of accelerations and multipliers, and the reason."""
    n = system.diagonal.size
    change = np.abs(state.correction[:n] * state.weight[:n])
    if not np.isfinite(change).all():
        return "masses and forces are too large or too different for numbers: check their units"
    held = multiplying(system)
    if held[int(np.argmax(change))]:
        parties = parties_of(numbering.names, np.where(held, change, 0.0))
        return (f"the forces of {parties} do not settle: their constraints nearly repeat each "
                "other, or hold what moves hardly any mass; put joints further apart, or one in "
                "place of several")
    return (f"the acceleration of {numbering.names[int(np.argmax(change))]} does not settle: it "
            "moves hardly any mass beside the stiffness there, or a force on it depends on "
            "accelerations; add mass or inertia there, or soften what acts on it")


def _jammed(model: Model, numbering: Numbering, state: State) -> str:
    """A remark on what slides, or will: with much friction bodies may have no motion (Painleve)."""
    contacts = states(model, numbering, state.frames)
    jams = [load.name for load in model.loads if contacts.get(load.name) == "slides"
            or load.constants.get("coefficient", 0.0) > MUCH]
    if not jams:
        return ""
    return (f". With the friction of {', '.join(jams)} sliding may jam, with no motion that "
            "continues it (Painleve's paradox): lower the coefficient, or soften the contact")
