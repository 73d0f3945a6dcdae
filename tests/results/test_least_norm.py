"""Forces of redundant joints against a pseudo-inverse of their equations, made from the motion."""

import numpy as np
import pytest
from everyday import CUBE, GRAVITY, Place, bricard

from sebody import generalized_alpha, simulate
from sebody.assembly import build

H, T_END = 4e-3, 1.6
PLACES = {"as it is": Place(), "turned, in other units, backwards": Place.at_random(
    7, length=250.0, mass=0.02, backwards=True)}
RODS = np.diff(CUBE, axis=0)
AXES = np.array([np.cross(RODS[k - 1], RODS[k]) for k in range(6)])
JOINTS = ["revolute at rod 0", *(f"revolute at end {k}" for k in range(5))]


def skew(a):
    return np.cross(np.eye(3), a)


def across(axis):
    """Two unit vectors normal to an axis, as columns."""
    return np.linalg.svd(axis[None])[2][1:].T


def demand(place, result, k):
    """Force and moment about its beginning that each of five rods takes in a recorded state."""
    found = np.zeros((5, 6))
    for body in range(5):
        R = result[f"rod {body}.rotation"][k]
        along = R @ place.point(RODS[body])
        spin, turn = (result[f"rod {body}.angular_{what}"][k] for what in ("velocity",
                                                                           "acceleration"))
        middle = (result[f"rod {body}.acceleration"][k] + np.cross(turn, along / 2.0)
                  + np.cross(spin, np.cross(spin, along / 2.0)))
        J = place.mass / 12.0 * (along @ along * np.eye(3) - np.outer(along, along))
        force = place.mass * (middle - place.point((0.0, -GRAVITY, 0.0)))
        found[body] = *force, *(J @ turn + np.cross(spin, J @ spin)
                                + np.cross(along / 2.0, force))
    return found.ravel()


def transmission(place, result, k):
    """What five forces and six moments, normal to the hinges' axes, give the rods: (30, 27).

    The hinge at the end of rod k pushes this rod, and the next one back. The place of the first is
    fixed without an equation, so its force has no part in the norm.
    """
    found = np.zeros((5, 6, 27))
    turns = [result[f"rod {body}.rotation"][k] for body in range(5)]
    for joint in range(6):
        turned = turns[joint] if joint < 5 else np.eye(3)
        moments = slice(15 + 2 * joint, 17 + 2 * joint)
        normals = across(turned @ place.turned(AXES[joint]))
        if joint == 0:
            found[0, 3:, moments] = normals
            continue
        forces = slice(3 * joint - 3, 3 * joint)
        found[joint - 1, :3, forces] = np.eye(3)
        found[joint - 1, 3:, forces] = skew(turns[joint - 1] @ place.point(RODS[joint - 1]))
        found[joint - 1, 3:, moments] = normals
        if joint < 5:
            found[joint, :3, forces] = -np.eye(3)
            found[joint, 3:, moments] = -normals
    return found.reshape(30, 27)


def least(place, result, k):
    """Forces and moments of the hinges by the pseudo-inverse, and what they leave unbalanced."""
    points = np.array([place.point(CUBE[j]) for j in (0, 1, 1, 2, 2, 3, 3, 4, 4, 5)])
    length = np.linalg.norm(points - points.mean(axis=0), axis=1).max()
    size = np.repeat([1.0, length], [15, 12])
    equations, right = transmission(place, result, k)[3:], demand(place, result, k)[3:]
    answer = size * (np.linalg.pinv(equations * size, rcond=1e-6) @ right)
    missing = np.abs(equations @ answer - right).max()
    moments = []
    for joint in range(6):
        turned = result[f"rod {joint}.rotation"][k] if joint < 5 else np.eye(3)
        normals = across(turned @ place.turned(AXES[joint]))
        moments.append(normals @ answer[15 + 2 * joint:17 + 2 * joint])
    return answer[:15].reshape(5, 3), np.array(moments), missing


@pytest.mark.parametrize("dense", [False, True])
@pytest.mark.parametrize("index", [2, 3])
@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_forces_of_a_redundant_loop(place, index, dense, monkeypatch):
    """Of six hinges one moment too many: in every state, so without jumps from step to step.

    Newton's tolerance of 1e-10 times the condition of the equations, about 100, is left.
    """
    if dense:
        monkeypatch.setattr(build, "DENSE_LIMIT", 100)
    result = simulate(bricard(place), H, T_END, generalized_alpha(0.9, 1e-10, index=index))
    weight = place.mass * place.length * GRAVITY
    for k in range(0, len(result.t), 7):
        forces, moments, missing = least(place, result, k)
        found = np.array([result[f"{joint}.force"][k] for joint in JOINTS[1:]])
        assert np.abs(found - forces).max() < 1e-7 * weight
        found = np.array([result[f"{joint}.moment"][k] for joint in JOINTS])
        assert np.abs(found - moments).max() < 1e-7 * weight * place.length
        assert missing < 1e-7 * weight * place.length
    jumps = np.abs(np.diff(result["revolute at end 2.moment"], 2, axis=0)).max()
    assert jumps < 0.02 * weight * place.length
