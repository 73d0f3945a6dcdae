"""Paths where another body takes the place of one that they go along."""

from dataclasses import replace

from sebody.basics.errors import InputError
from sebody.contract.names import path_across_kind, path_kind, path_load_kind, path_turn_kind
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, OnPath, Path, Superelement


def paths_on(model: Mechanism, body: Superelement) -> list[Path]:
    """Paths that go along a superelement."""
    return [path for path in model.paths.values()
            if any(piece.carrier is body for piece in path.pieces)]


def refuse_paths(model: Mechanism, body: Superelement, what: str) -> None:
    """Refuse a change of a superelement that paths go along.

    Raises
    ------
    InputError
        There is such a path; the message names it.
    """
    for path in paths_on(model, body):
        raise InputError(f"{what}: path {path.name!r} goes along superelement {body.name!r}: build "
                         "the model anew with the other body")


def put_on(model: Mechanism, old: Superelement, made: Superelement) -> None:
    """Let paths along a superelement go along another one, reduced from the same FE model.

    Raises
    ------
    InputError
        The FE nodes of the new body are unknown or others.
    """
    changed: dict[Path, Path] = {}
    moved: dict[Element, Element] = {}
    for path in paths_on(model, old):
        before, after = old.reduced.recovery, made.reduced.recovery
        if before is None or after is None or before.coordinates.shape != after.coordinates.shape:
            raise InputError(f"path {path.name!r} goes along FE nodes of {made.name!r}, and the "
                             "body in its place has none or others")
        if FRAMES[made.frame].traits.incremental:
            raise InputError(f"path {path.name!r} goes along {made.name!r}, whose frame "
                             f"{made.frame!r} averages the rotations of a step: give it another "
                             "frame, such as 'converged_mean'")
        changed[path] = model.paths[path.name] = replace(path, pieces=tuple(
            piece._replace(carrier=made) if piece.carrier is old else piece
            for piece in path.pieces))
    for load in model.loads:
        if load.path is not None and load.path.path in changed:
            on = load.path._replace(path=changed[load.path.path])
            own = on.here.carrier is made
            moved[load] = replace(load, path=on, attachments=on.here.attachments,
                                  kind=path_load_kind(FRAMES[made.frame].kernel, model.planar)
                                  if own else load.kind)
    model.loads = [moved.get(load, load) for load in model.loads]
    for joint in model.joints:
        known: dict[Element, Element] = {}
        for one in joint.constraints:
            if one.path is None or one.path.path not in changed:
                continue
            on = one.path._replace(path=changed[one.path.path])
            kept = one.attachments[one.carried[0]:]
            kind = one.kind
            if on.here.carrier is made:
                kind = _kind(on, FRAMES[made.frame].kernel, model.planar)
            known[one] = replace(one, kind=kind, attachments=on.here.attachments + kept, path=on,
                                 shares=known.get(one.shares) if one.shares else None)
        joint.constraints = tuple(known.get(one, one) for one in joint.constraints)


def _kind(on: OnPath, frame: str, planar: bool) -> str:
    """Kind of an element of a joint on a path of a body with this frame."""
    if on.turns:
        return path_turn_kind(frame, planar)
    return path_kind(frame, planar) if on.section is None else path_across_kind(frame)
