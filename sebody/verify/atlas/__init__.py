"""``sebody atlas``: known limits: theory, measured value, how sebody reacts.

Every row of the table is a number that a run has to show: theory or another program predicts it,
or it says what this program is to do there.
"""

import warnings
from collections.abc import Callable, Iterable

from sebody.basics.errors import InputError, LimitWarning
from sebody.contract.names import element_name, superelement_name
from sebody.runs.first_run import PARTS, compile_missing
from sebody.verify.atlas import (
    frames,
    geometry,
    inertia,
    integration,
    spin,
    steps,
    torsion,
    trust,
)
from sebody.verify.atlas.draw import draw
from sebody.verify.atlas.finding import Finding, Row

CASES: dict[str, Callable[[], Finding]] = {
    "divergence": spin.spurious_divergence,
    "torsion": torsion.soft_torsion,
    "one-body": spin.frequencies,
    "spin-up": spin.spin_up_outcomes,
    "euler": spin.buckling,
    "beck": spin.flutter,
    "impulse": inertia.impulses,
    "small-increments": inertia.small_increments,
    "damping": integration.damping_of_constraints,
    "newton": integration.newton,
    "million-steps": integration.million_steps,
    "following-steps": steps.following,
    "struck-frame": frames.struck_frame,
    "half-turn": geometry.half_turn,
    "collinear": geometry.collinear,
    "massless": geometry.massless_rotations,
    "weights": geometry.negative_weights,
    "missed-loads": trust.missed_loads,
    "beam-damping": trust.damping_by_division,
    "rotating-frequencies": trust.frequencies_that_rotate,
    "instability": trust.instability,
}
# kernels of all cases, to compile them at once; what a case needs besides it compiles itself
KERNELS = tuple(
    superelement_name(*names) for names in (
        ("f2", "converged_mean", "frame_axes"), ("f2", "converged_mean", "material"),
        ("f2", "mean", "material"),
        ("f2", "mean_small", "material"), ("f2m4", "converged_mean", "material"),
        ("f2t1", "positions", "material"),
        ("planar-f2", "converged_mean", "material"), ("planar-f2m2", "converged_mean", "material"),
        ("planar-f2m4", "converged_mean", "material"), ("f2", "converged_mean", "floating_field"),
        ("planar-f2", "converged_mean", "floating_field"),
        ("f2m4s2e1", "converged_mean", "floating_field"),
        ("planar-f2m2s2e1", "converged_mean", "floating_field"),
        ("any", "converged_mean", "floating_field"),
        ("any", "positions", "floating_field"))) + tuple(
    element_name(kind) for kind in (
        "force", "torque", "planar_force", "planar_follower_force", "planar_on_line",
        "planar_point_mass", "planar_torque"))

__all__ = ["CASES", "KERNELS", "Finding", "Row", "check_names", "draw", "explore", "prepare",
           "report"]


def prepare() -> None:
    """Compile what all cases need, as far as the cache lacks it."""
    compile_missing(KERNELS, PARTS)


def check_names(names: Iterable[str]) -> None:
    """Refuse unknown cases.

    Raises
    ------
    InputError
        The first one that is unknown.
    """
    for name in names:
        if name not in CASES:
            raise InputError(f"the atlas has no case {name!r}: there are {', '.join(CASES)}")


def explore(name: str) -> Finding:
    """Run a case; its warnings are part of what it shows and are not given again.

    Raises
    ------
    InputError
        An unknown case.
    """
    check_names([name])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)
        return CASES[name]()


def report(finding: Finding) -> str:
    """Theory, what the program does, and a line for every number."""
    lines = [finding.title, f"  theory   {finding.theory}", f"  program  {finding.program}"]
    wide = max(len(row.what) for row in finding.rows)
    lines += [f"    {row.what:{wide}}  {row.source:9} {row.expected:<12.6g} "
              f"measured {row.measured:<12.6g} {'ok' if row.passed else 'DIFFERS'}"
              for row in finding.rows]
    return "\n".join(lines)
