"""Which runs have exact gradients; all others are refused by name, with what to do instead."""

from warnings import warn

from sebody.engine.state import Scheme
from sebody.errors import InputError, LimitWarning
from sebody.generated.options import FRAMES
from sebody.kernels.loader import element_kernel
from sebody.model.model import Model
from sebody.runs.simulation import Simulation

USER_FORCE = "user_force"
COUNTED = ("angle",)        # what torsion springs keep to count turns, no force depends on it else


def refuse_model(model: Model) -> None:
    """Refuse what has no derivative before anything is run.

    Raises
    ------
    InputError
        Incremental frames, controllers, or forces by functions of the user.
    """
    if model.controllers:
        raise InputError(f"controller {next(iter(model.controllers))!r}: gradients of models with "
                         "controllers are not available, sampled or continuous: leave it out, "
                         "give what it sets as a table of a force, torque or drive, or use an "
                         "Ensemble with values on both sides")
    for body in model.bodies.values():
        if FRAMES[body.frame].incremental:
            exact = ", ".join(name for name, frame in FRAMES.items()
                              if not frame.incremental)
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

    Warns of constraints of index 2, which are differentiated to the order of the scheme.

    Raises
    ------
    InputError
        Friction, contacts, actuators, sensors, motions without mass.
    """
    if remembering := [one.name for one in run.numbering.memories
                       if element_kernel(one.kind).MEMORY != COUNTED]:
        raise InputError(f"{remembering[0]!r} keeps numbers from step to step, as friction, "
                         "contacts and stops do, and these are not differentiated: leave it out, "
                         "or use an Ensemble with values on both sides")
    if run.sampling.has_inputs:
        name = next(iter(run.numbering.memory.ports))
        raise InputError(f"actuator {name!r}: what is set during a run is not differentiated: give "
                         "the history of the input as a table of a force, torque or drive")
    if run.model.sensors:
        name, sensor = next(iter(run.model.sensors.items()))
        raise InputError(f"sensor {name!r}: samples are not differentiated: leave the sensor out, "
                         f"and give {sensor.quantity!r} itself as a quantity")
    if run.system.massless[0]:
        raise InputError("a motion of the model has no mass, and its accelerations at the start no "
                         "derivative: give every node mass and inertia")
    if run.scheme.stabilized:       # which the scheme of a run without constraints is not
        warn("constraints of index 2 (of variable steps the default) shift positions in directions "
             "that are held where motion is differentiated, so derivatives differ from those of "
             "the run by about the error of its steps: halve the step, or divide the tolerance by "
             "eight, to see by how much; fixed steps of generalized_alpha(index=3) have exact "
             "derivatives", LimitWarning, stacklevel=4)


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
