"""Names of the unknowns as users have them: ``tip.position.y``, ``beam.modes.2``."""

from sebody.assembly.numbering import hidden_states
from sebody.quantities.names import AXES
from sebody.results.result import Result
from sebody.runs.simulation import Simulation


def coordinate_names(run: Simulation | Result) -> list[str]:
    """Names of all coordinates; rotations in space are about the axes of their node."""
    model, numbering = run.model, run.numbering
    names = list(numbering.names)
    for node in model.nodes.values():
        for kind in ("position", "rotation"):
            dof_block = getattr(node, kind)
            if dof_block is None or dof_block not in numbering.dof_blocks:
                continue
            first, size = numbering.dof_blocks[dof_block], dof_block.start.size
            if names[first] == numbering.names[first]:      # of nodes that share it, the first
                labels = [f".{axis}" for axis in AXES[:size]] if size > 1 else [""]
                names[first:first + size] = [f"{node.name}.{kind}{label}" for label in labels]
    for name, body in model.bodies.items():
        first = numbering.modes[name]
        for k in range(body.reduced.modes):
            names[first + k] = f"{name}.modes.{k}"
    for coordinate, name in hidden_states(model, numbering).items():
        names[coordinate] = f"integral of {name}"
    return names
