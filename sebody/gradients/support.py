"""Runs that have exact gradients; all others are refused by name, with what to do instead."""


from sebody.basics.errors import InputError
from sebody.basics.warned import warn
from sebody.engine.state import Scheme
from sebody.gradients.laws import remembering
from sebody.gradients.linear import DENSE
from sebody.kernels.loader import element_kernel_name, products_kernel_name
from sebody.model.frames import FRAMES
from sebody.model.model import Model
from sebody.model.path_joints import PATH
from sebody.runs.simulation import Simulation

USER_FORCE = "user_force"


def refuse_model(model: Model) -> None:
    """Refuse what has no derivative before anything is run.

    Raises
    ------
    InputError
        Joints on paths, incremental frames, sampled controllers, or functions of the user without
        derivatives.
    """
    for name, one in model.controllers.items():
        if one.period:
            raise InputError(f"controller {name!r} is sampled, which is not differentiated: leave "
                             "out period= for a continuous law, or use an Ensemble with values on "
                             "both sides")
    for load in model.loads:
        if load.law is not None and load.law.derivatives is None:
            raise InputError(f"the law of controller {load.law.controller!r} is a function without "
                             "derivatives: give derivatives= with it, or use an Ensemble with "
                             "values on both sides")
    for joint in model.joints:
        if joint.kind == PATH:
            raise InputError(f"joint {joint.name!r} is on a path, which is not differentiated: use "
                             "an Ensemble with values on both sides")
    for load in model.loads:
        if load.path is not None:
            raise InputError(f"force {load.name!r} moves along a path, which is not "
                             "differentiated: use an Ensemble with values on both sides")
    for body in model.bodies.values():
        if FRAMES[body.frame].traits.incremental:
            exact = ", ".join(name for name, frame in FRAMES.items()
                              if not frame.traits.incremental)
            raise InputError(f"superelement {body.name!r}: frame {body.frame!r} depends on the "
                             "steps that led to a state, and its forces are not differentiated by "
                             f"those: use one of {exact}")
    for load in model.loads:
        if load.kind == USER_FORCE:
            raise InputError(f"force {load.name!r} is a function of yours, whose derivatives are "
                             "not known: use springs, dampers, tables or profiles for gradients, "
                             "or an Ensemble with values on both sides")


def refuse_run(run: Simulation) -> None:
    """Refuse runs whose steps are no functions of the state before.

    Warns of constraints of index 2, which are differentiated to the order of the scheme; `level`
    leads to the caller that is shown.

    Raises
    ------
    InputError
        Contacts of points inside bodies, inputs that are set from outside, samples of sensors,
        ropes that slip on sheaves, motions without mass.
    """
    for rope in run.model.ropes.values():
        for one in rope.frictions:
            raise InputError(f"{one.name!r} lets rope {rope.name!r} slip, a motion without mass, "
                             "which is not differentiated: leave friction= of the sheave out, or "
                             "use an Ensemble with values on both sides")
    for one in remembering(run):
        if products_kernel_name(element_kernel_name(one.kind)) is None:
            raise InputError(f"contact {one.name!r} is one of a point inside a body, which is not "
                             "differentiated: let a node of the body touch, or use an Ensemble "
                             "with values on both sides")
    if remembering(run) and run.numbering.free > DENSE:
        raise InputError(f"{remembering(run)[0].name!r} keeps numbers from step to step, which is "
                         f"differentiated in models of up to {DENSE} unknowns, and this one has "
                         f"{run.numbering.free}: use an Ensemble with values on both sides")
    written = {name for one in run.model.controllers.values() for name in one.outputs}
    if given := [name for name in run.numbering.memory.ports if name not in written]:
        name = given[0]
        raise InputError(f"actuator {name!r}: what is set during a run is not differentiated: give "
                         "the history of the input as a table of a force, torque or drive")
    for name, sensor in run.model.sensors.items():
        if sensor.period:
            raise InputError(f"sensor {name!r} has samples, which are not differentiated: leave "
                             f"out its rate, or the sensor, and give {sensor.quantity!r} itself as "
                             "a quantity")
    if run.system.massless[0]:
        raise InputError("a motion of the model has no mass, and its accelerations at the start no "
                         "derivative: give every node mass and inertia")
    if run.scheme.stabilized:       # which the scheme of a run without constraints is not
        if kept := remembering(run):
            raise InputError(f"{kept[0].name!r} keeps numbers from step to step, which is "
                             "differentiated only without constraints of index 2: use a fixed step "
                             "with generalized_alpha(index=3)")
        warn("constraints of index 2 (of variable steps the default) shift positions in directions "
             "that are held where motion is differentiated, so derivatives differ from those of "
             "the run by about the error of its steps: halve the step, or divide the tolerance by "
             "eight, to see by how much; fixed steps of generalized_alpha(index=3) have exact "
             "derivatives")


def refuse_laws(run: Simulation, what: str) -> None:
    """Refuse friction, contacts and stops where what they keep is not followed.

    Raises
    ------
    InputError
    """
    if found := remembering(run):
        raise InputError(f"{found[0].name!r} keeps numbers from step to step, as friction, "
                         f"contacts and stops do, which {what} cannot follow: leave it out, or "
                         "compare runs")


def refuse_scheme(scheme: Scheme, what: str) -> None:
    """Refuse constraints of index 2, which some uses do not linearize.

    Raises
    ------
    InputError
        Names the use.
    """
    if scheme.stabilized:
        raise InputError(f"{what} with constraints of index 2 are not available: give "
                         "generalized_alpha(index=3), which is the default")
