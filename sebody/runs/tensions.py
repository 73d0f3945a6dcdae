"""Equilibria that only the model has: bodies without stiffening that fold up under tension."""

from typing import NamedTuple

from sebody.assembly.motions import motions
from sebody.contract.layout import MOTION
from sebody.model.numbering import record_counts
from sebody.model.parts import Superelement
from sebody.quantities.reading import Motions
from sebody.results.motion import evaluated
from sebody.runs.limits.axial import Axial, Load
from sebody.runs.limits.body_limits import limits_of, remedy
from sebody.runs.limits.thresholds import FOLDED
from sebody.runs.simulation import Simulation
from sebody.runs.stability import Stiffness
from sebody.runs.state_derivatives import derivative

NEAR = 0.9          # of the tension at which a body folds up: no equilibrium is found there


class Tensions(NamedTuple):
    """Bodies of a run that may fold up under tension."""

    bodies: dict[str, Superelement]
    axial: dict[str, Axial]
    groups: list[Motions]

    @classmethod
    def of(cls, run: Simulation) -> "Tensions":
        """All bodies of its model that have no geometric stiffening."""
        own = {name: limits.axial for name, limits in limits_of(run.model.bodies.values()).items()
               if limits.axial is not None}
        bodies = {name: run.model.bodies[name] for name in own}
        return cls(bodies, own, motions(run.model, run.numbering, bodies.values()))

    def spurious(self, run: Simulation) -> str:
        """Fault of an equilibrium, empty if there is none.

        Beyond the limit of a body that is clamped nothing needs to be wrong but its stiffness.
        """
        worst = self._worst(run)
        if worst is None or worst[1].folding < NEAR:
            return ""
        load, said = worst[1], self._said(*worst)
        if load.tilt > FOLDED:
            return (f"is not that of the structure: the frame is {load.tilt:.2g} rad off the line "
                    f"of the nodes: {said}")
        return f"is unstable: {said}" if load.folding > 1.0 and _unstable(run) else ""

    def reason(self, run: Simulation) -> str:
        """The reason why no equilibrium is found, where it is a tension; empty otherwise."""
        worst = self._worst(run)
        return self._said(*worst) if worst and worst[1].folding > NEAR else ""

    def _said(self, name: str, load: Load) -> str:
        return (f"body {name!r} folds up in its frame under {load.described} (limit "
                f"{load.force / load.folding:.3g}), as its stiffness does not grow with tension: "
                f"{remedy(self.bodies[name])}")

    def _worst(self, run: Simulation) -> tuple[str, Load] | None:
        """The body whose tension is largest against that at which it folds up."""
        ratios = []
        for group in self.groups:
            motion, _ = evaluated(group, run.state.now[None], record_counts(run.numbering))
            y = motion[0][:, MOTION.slices(group.counts)["y"]]
            ratios += [(name, self.axial[name].load(y[k])) for k, name in enumerate(group.bodies)
                       if self.axial[name].bound(y[k:k + 1])[0] > NEAR]
        return max(ratios, key=lambda item: item[1].folding, default=None)


def _unstable(run: Simulation) -> bool:
    """Tell whether a motion that the constraints allow has a negative stiffness."""
    return not Stiffness(run, derivative(run, 0.0, 0.0, 1.0), 0.0).stable()
