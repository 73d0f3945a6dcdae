"""Wrong arguments of finite element models, sections and reduction."""

import numpy as np
from malformed.cases import (
    INF,
    NAN,
    NO_COUNT,
    NO_NUMBER,
    Right,
    Silent,
    are,
    have,
    not_negative,
    positive,
    vectors,
)
from scipy import sparse

from sebody.fem import (
    FEModel,
    Section,
    StiffnessSection,
    circle,
    frame,
    hexahedral_block,
    i_profile,
    planar_beam,
    rectangle,
    straight_beam,
    tube,
)
from sebody.reduction import (
    ReducedBody,
    RigidFace,
    body_weights,
    component_modes,
    craig_bampton,
    frame_weights,
)

SECTION = Section(1.0, 1e-2, 1e-2, 1e-2, 1e6, 0.3, 1.0)
BEAM = straight_beam((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), SECTION, 4)
BODY = craig_bampton(BEAM, {0: "full", 4: "full"}, 2)
K, M = BEAM.stiffness.toarray(), BEAM.mass.toarray()
ENDS = [*range(6), *range(24, 30)]


def changed(matrix, value, at=(3, 4)):
    """The matrix with one entry replaced."""
    matrix = np.array(matrix, dtype=np.result_type(matrix, type(value)))
    matrix[at] = value
    return matrix


def matrices(name: str, matrix) -> list:
    """What is no FE matrix of the size of `matrix`."""
    return [*are(name, None, 3j, "abc", {}), *have(name, [[1, 2], [3]]),
            (changed(matrix, 1j), f"{name} is "), (changed(matrix, NAN), f"{name}[3, 4] is nan"),
            (changed(matrix, INF), f"{name}[3, 4] is inf"),
            (sparse.csc_array(matrix.astype(complex)), f"{name} has numbers of type complex128"),
            (sparse.csr_array(changed(matrix, NAN)), f"{name}[3, 4] is nan"),
            (changed(matrix, 1e3, (0, 9)), f"{name} is not symmetric: {name}["),
            (matrix[:5], f"(5, {len(matrix)})"),
            (matrix.ravel(), f"{name} has shape ({matrix.size},)"), (matrix > 0, f"{name} is ")]


def reduced(name: str, matrix) -> list:
    """What is no reduced matrix of the body."""
    return [*are(name, None, "abc"), (changed(matrix, 1j), f"{name} is "),
            (changed(matrix, NAN), f"{name}[3, 4] is nan"),
            (matrix[:5], f"{name} has shape (5, 14)"),
            (changed(matrix, 1e9, (0, 9)), f"{name} is not symmetric")]


def face(nodes: list, point: tuple = (0.0, 0.0, 0.0), keeps: str = "full") -> list:
    """A boundary of one rigid face."""
    return [(RigidFace(point, nodes), keeps)]


MATERIAL = {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1.0}


def material(shape: str) -> dict:
    """Wrong constants of a material."""
    return {"poisson_ratio": are(f"{shape}poisson_ratio", *NO_NUMBER, -1.0, 0.6)}


SECTIONS = {
    "Section": Right(Section, {
        "area": 1.0, "inertia_y": 1.0, "inertia_z": 1.0, "torsion": 1.0, **MATERIAL}, {
            **{name: positive(f"Section.{name}") for name in (
                "area", "inertia_y", "inertia_z", "torsion", "youngs_modulus", "density")},
            "poisson_ratio": are("Section.poisson_ratio", *NO_NUMBER, -1.0, 0.6),
            "shear_factor": [*are("Section.shear_factor", "1", 1j, NAN, 0.0, True),
                             ((1.0, 1.0, 1.0), "Section.shear_factor is")]}),
    "StiffnessSection": Right(StiffnessSection, {
        "axial": 1.0, "bending_y": 1.0, "bending_z": 1.0, "torsion": 1.0, "mass": 1.0,
        "inertia_x": 0.0, "inertia_y": 0.0, "inertia_z": 0.0}, {
            "axial": [pair for pair in positive("StiffnessSection.axial") if pair[0] is not None],
            "inertia_x": [pair for pair in not_negative("StiffnessSection.inertia_x")
                          if pair[0] is not None]}),
    "rectangle": Right(rectangle, {"height": 1.0, "width": 2.0, **MATERIAL}, {
        "height": positive("rectangle: height"), "width": positive("rectangle: width"),
        **material("rectangle: ")}),
    "circle": Right(circle, {"radius": 1.0, **MATERIAL}, {"radius": positive("circle: radius")}),
    "tube": Right(tube, {"radius": 1.0, "thickness": 0.1, **MATERIAL}, {
        "radius": positive("tube: radius"),
        "thickness": [*positive("tube: thickness"), (2.0, "tube: thickness is 2.0, more than")]}),
    "i_profile": Right(i_profile, {
        "height": 1.0, "width": 1.0, "web": 0.1, "flange": 0.1, **MATERIAL}, {
            "web": positive("i_profile: web"), "flange": have("do not fit into", 0.5)}),
}
BEAMS = {
    "straight_beam": Right(straight_beam, {
        "start": (0.0, 0.0, 0.0), "end": (1.0, 0.0, 0.0), "section": SECTION, "elements": 2}, {
            "start": have("points", None, "abc", (0, 0), (0, 0, NAN), (0, 0, 1j)),
            "end": [*have("points", None, 1.0, ("1", "0", "0")),
                    ((0.0, 0.0, 0.0), "both ends at the same point")],
            "section": have("is none: give a Section", None, 3, "IPE", Silent()),
            "elements": are("elements", *NO_COUNT, 0, -1, also=": give a whole number >= 1"),
            "up": [*[pair for pair in vectors("up", 3) if pair[0] is not None],
                   *have("lies along a beam", (0.0, 0.0, 0.0), (2.0, 0.0, 0.0))]}),
    "planar_beam": Right(planar_beam, {
        "start": (0.0, 0.0), "end": (1.0, 0.0), "section": SECTION, "elements": 2}, {
            "end": have("points", (1.0, 0.0, 0.0), None), "elements": are("elements", *NO_COUNT)}),
    "frame": Right(frame, {
        "points": [(0, 0, 0), (1, 0, 0), (1, 1, 0)], "members": [(0, 1), (1, 2)],
        "section": SECTION, "elements": 2}, {
            "points": have("points", None, "abc", 1.0, [(0, 0, 0), (1, 0)],
                           [(0, 0, 0), (1, 0, NAN)], [(0, 0, 0), (1, 0, "1")]),
            "members": [*are("members", None, 3, "01"), ([], "members is empty"),
                        *have("a member is", [0, 1], [(0, 1, 2)], [(0,)], ["01"]),
                        *have("a point of member", [(0, 1.5)], [(0, "1")], [(0, None)]),
                        *have("names an unknown point", [(0, 3)], [(-1, 0)]),
                        *have("is given twice: leave one out", [(0, 1), (0, 1)], [(0, 1), (1, 0)]),
                        ([(0, 0)], "both ends at the same point")],
            "elements": are("elements", *NO_COUNT, 0),
            "up": [((0, 0, NAN), "up is (0, 0, nan)"), ((1, 0, 0), "lies along a beam")]}),
    "planar frame": Right(frame, {
        "points": [(0, 0), (1, 0)], "members": [(0, 1)], "section": SECTION, "elements": 1}, {
            "up": have("up is for beams in space", (0.0, 1.0), (0.0, 1.0, 0.0))}),
    "hexahedral_block": Right(hexahedral_block, {
        "corner": (0, 0, 0), "size": (1, 1, 1), "divisions": (1, 2, 1), **MATERIAL}, {
            "corner": vectors("block corner", 3),
            "size": [*vectors("block size", 3), *have("block size", (1, 0, 1), (1, -1, 1))],
            "divisions": have("block divisions", None, 2, "111", (1, 1), (1, 1.5, 1), (1, 0, 1),
                              (1, NAN, 1), (1, True, 1), ("1", "1", "1")),
            "youngs_modulus": positive("block youngs_modulus"),
            "poisson_ratio": are("block poisson_ratio", *NO_NUMBER, 0.5, -1.0),
            "density": positive("block density")}),
}
FE_MODELS = {
    "FEModel": Right(FEModel, {
        "stiffness": K, "mass": M, "coordinates": BEAM.coordinates}, {
            "stiffness": matrices("stiffness", K), "mass": matrices("mass", M),
            "coordinates": [*have("coordinates", None, "abc", 3, [(0, 0)], [(0, 0, "1")], []),
                            (changed(BEAM.coordinates, NAN, (3, 1)), "coordinates of node 3 are"),
                            (BEAM.coordinates[:3], "3 nodes with 6 DOFs each need (18, 18)")],
            "node_dofs": have("node_dofs", None, "xyz", ("x",), 3, ("x", "y", "y"))}),
    "dofs": Right(BEAM.dofs, {"node": 2, "kind": "full"}, {
        "node": are("node", *NO_COUNT, 99, -1, 5, also=": the model has nodes 0 to 4"),
        "kind": have("kind of DOFs", "all", None, 3, [])}),
    "node_at": Right(BEAM.node_at, {"point": (1.0, 0.0, 0.0)}, {
        "point": [*vectors("point", 3), ((9.0, 9.0, 9.0), "no node at")]}),
    "craig_bampton": Right(craig_bampton, {
        "fe_model": BEAM, "boundary": {0: "full", 4: "full"}, "modes": 3, "select": [0, 2]}, {
            "fe_model": are("fe_model", None, 3, "beam", also=": give an FEModel"),
            "boundary": [*are("boundary", None, 3, "full"),
                         *have("a boundary node is", [0, 4], [(0,)], [(0, "full", 1)]),
                         *have("boundary node", {"0": "full"}, {0.5: "full"}, {99: "full"},
                               {-1: "full"}, [(0, "full"), (0, "full")], {0: "all"}, {0: None},
                               {0: ["full"]}, {None: "full"}),
                         *have("boundary is empty", [], {})],
            "modes": [*are("modes", *NO_COUNT), *have("modes is", -1, 19)],
            "select": have("select", 1, "01", [0, 0], [3], [-1], [0.5], [None])}),
    "RigidFace": Right(RigidFace, {"point": (0.0, 0.0, 0.0), "nodes": [0, 1]}, {
        "point": have("point of a rigid face is", None, "abc", 3.0, (0, 0, NAN), (0, 0, 1j)),
        "nodes": [*have("nodes of a rigid face", None, 3, "01"), ([], "a rigid face has no nodes"),
                  *have("node of a rigid face is", [0.5], ["0"], [None], [NAN])]}),
    "faces of a body": Right(craig_bampton, {
        "fe_model": BEAM, "boundary": [(RigidFace((0.0, 0.0, 0.0), [0]), "full"), (4, "full")],
        "modes": 1}, {
            "boundary": [(face([99]), "node 99 of a rigid face unknown: the model has nodes 0"),
                         (face([-1]), "node -1 of a rigid face unknown: the model has nodes 0"),
                         (face([0, 0]), "boundary node 0 appears more than once"),
                         (face([0], point=(0.0, 0.0)), "point of a rigid face is [0. 0.]"),
                         (face([0], keeps="all"), "a rigid face keeps 'all'"),
                         ([*face([0]), (0, "full")], "boundary node 0 appears more than once")]}),
    "component_modes": Right(component_modes, {
        "stiffness": K, "mass": M, "boundary_dofs": ENDS, "modes": 2}, {
            "stiffness": matrices("stiffness", K), "mass": [*matrices("mass", M),
                                                            (M[:6, :6], "mass (6, 6)")],
            "boundary_dofs": have("boundary_dofs", None, 3, "012", [0.5], [-1], [30], [0, 0]),
            "modes": are("modes", *NO_COUNT, -1, 99)}),
    "ReducedBody": Right(ReducedBody, {
        "stiffness": BODY.stiffness, "mass": BODY.mass, "coordinates": BODY.coordinates,
        "keeps": BODY.keeps, "modes": 2}, {
            "stiffness": reduced("stiffness", BODY.stiffness), "mass": reduced("mass", BODY.mass),
            "damping": reduced("damping", BODY.mass)[1:],
            "coordinates": have("coordinates", None, "abc", [(0, 0, NAN), (1, 0, 0)], 3, []),
            "keeps": have("keeps", None, 3, "full", ("full", "all"), ("full",), ("full", None)),
            "modes": are("modes", *NO_COUNT, -1)}),
    "damped": Right(BODY.damped, {"ratio": 0.1}, {
        **{name: not_negative(f"damping: {name}") for name in ("mass", "stiffness")},
        "ratio": [*(case for case in not_negative("damping: ratio") if np.ndim(case[0]) == 0),
                  ([0.1, -0.1], "damping: a ratio is -0.1"),
                  ([], "damping: 0 ratios, but the body"),
                  (["0.1"], "damping: a ratio is '0.1'"), ([NAN], "damping: a ratio is nan"),
                  ([0.1] * 99, "damping: 99 ratios, but the body has ")]}),
    "rotated": Right(BODY.rotated, {"rotation": np.eye(3)}, {
        "rotation": have("rotation", None, "abc", np.eye(2), 2 * np.eye(3), -np.eye(3),
                         NAN * np.eye(3), 1j * np.eye(3), 1.0)}),
    "frame_weights": Right(frame_weights, {
        "coordinates": [(0, 0, 0), (1, 0, 0)], "centre_of_mass": (0.5, 0, 0)}, {
            "coordinates": have("coordinates", None, "abc", 3, [], [(0, 0), (1, 0)],
                                [(0, 0, NAN), (1, 0, 0)]),
            "centre_of_mass": have("centre_of_mass", None, "abc", 3, (0, 0), (0, NAN, 0))}),
    "body_weights": Right(body_weights, {"body": BODY}, {"body": are("body", None, 3, "beam")}),
}
