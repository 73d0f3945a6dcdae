"""The state about which an analysis is made: of a run, of a result, or of a model."""

from __future__ import annotations

from numpy.typing import ArrayLike

from sebody.basics import inputs
from sebody.basics.errors import SimulationError
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.runs.statics import equilibrium


def state_of(run: Simulation | Result | Model, spin: ArrayLike | None = None,
             hub: Node | str | None = None) -> Simulation | Result:
    """The state that a run or a result has reached; of a model, that of its equilibrium.

    Parameters
    ----------
    spin : (3,) array_like or float, optional
        Angular velocity of the steady rotation in which a model is in equilibrium [1/time].
    hub : Node or str, optional
        A node on the axis of this rotation.

    Raises
    ------
    InputError
        Neither a run nor a result nor a model.
    SimulationError
        A model without an equilibrium.
    """
    inputs.instance(run, "run", Simulation | Result | Model, "give a Simulation, the Result of a "
                    "run or of an equilibrium, or a Model")
    if not isinstance(run, Model):
        return run
    try:
        return equilibrium(run, spin=spin, hub=hub)
    except SimulationError as error:
        raise SimulationError(f"of a model, small motion is that about its equilibrium: {error}. "
                              "Give Simulation(model, h) for the state as built",
                              error.result) from error
