"""Meaning of the numbers of a body: findings with remedies, and a verdict."""

from typing import NamedTuple

import numpy as np

from sebody.basics.errors import InputError
from sebody.basics.tabular import counted
from sebody.explore.inspection.measures import Matrices
from sebody.io.body_file import BodyFile
from sebody.reduction.checks import (
    NEGATIVE_MASS_LIMIT,
    NEGATIVE_STIFFNESS_LIMIT,
    RIGID_LIMIT,
    SYMMETRY_LIMIT,
)
from sebody.runs.limits.thresholds import FLAT

# Residuals below the limit of use that still tell of few printed digits: fourteen leave 1e-9.
_DIGITS = 1e-8
_GEOMETRY = 1e-6    # of R^T M R, relative to the mass: of files with eight digits or more
_LUMPED = 1e-3      # distance of the frame from the centre of mass, relative to the body's size
_MASSLESS = 1e-12   # lowest eigenvalue of the unit-free mass, relative to the largest
_STIFF = 1e4        # highest over lowest flexible frequency


class Finding(NamedTuple):
    """Something that a user should know.

    Parameters
    ----------
    severity : str
        'defect' where the body cannot be used, 'caution' where it can.
    text, remedy : str
    """

    severity: str
    text: str
    remedy: str


def findings_of(file: BodyFile, body: Matrices, numbers: dict) -> list[Finding]:
    """All findings, defects first."""
    findings = [*_symmetry(body), *_mass(numbers), *_rigid(numbers), *_stiffness(body, numbers),
                *_frame(body, numbers), *_steps(numbers), *_cautions(file)]
    if all(one.severity != "defect" for one in findings):
        findings += _refused(file)
    return sorted(findings, key=lambda one: one.severity != "defect")


def verdict(findings: list[Finding]) -> str:
    """One line in plain words."""
    defects = sum(one.severity == "defect" for one in findings)
    if defects:
        return f"the body cannot be used: {defects} defect{'s' * (defects > 1)}, see above"
    if findings:
        return "the body can be used; note the cautions above"
    return "the body can be used"


def _refused(file: BodyFile) -> list[Finding]:
    """Other reasons why a model cannot take the body, such as constants of another body."""
    try:
        file.body()
    except InputError as error:
        text, colon, remedy = str(error).partition("; ")
        return [Finding("defect", text, remedy if colon else "import the body again")]
    return []


def _symmetry(body: Matrices) -> list[Finding]:
    return [Finding("defect", f"{name} is not symmetric: {defect:.3e} of its entries (limit "
                    f"{SYMMETRY_LIMIT:.0e})", "export both triangles of the matrix or mirror one")
            for name, defect in body.asymmetry.items() if defect > SYMMETRY_LIMIT]


def _mass(numbers: dict) -> list[Finding]:
    listed, lowest = [], numbers["definiteness"]["mass"]
    if numbers["mass"] <= 0:
        return [Finding("defect", f"the mass is {numbers['mass']:.6g}",
                        "give the FE model a density, and check the sign of the matrix")]
    if lowest["lowest"] < -NEGATIVE_MASS_LIMIT:
        listed.append(Finding("defect", f"the mass matrix is indefinite: {lowest['lowest']:.3e} of "
                              f"its largest eigenvalue, mostly in {lowest['worst']}",
                              "check the order of its rows and the digits of the file"))
    elif lowest["lowest"] < _MASSLESS:
        following = numbers["frequencies"]["following"]
        listed.append(Finding("caution", "the mass matrix is singular, mostly in "
                              f"{lowest['worst']}: some motion has no inertia"
                              + f"; {counted(following, 'motion')} without mass follow the others "
                              "statically, in these frequencies and in models" * bool(following),
                              "give mass to what has no stiffness either, or hold it by joints; "
                              "SID files need inertia of every coordinate"))
    if numbers["mass_geometry_defect"] > _GEOMETRY:
        listed.append(Finding(
            "defect", "the inertia of rigid motion is not that of a body: R^T M R is off by "
            f"{numbers['mass_geometry_defect']:.3e} of the mass",
            "check coordinates, axes and the order of rows; lumped masses of one direction alone "
            "have this defect, too"))
    moments = np.asarray(numbers["principal_moments"])
    if len(moments) == 3 and moments[0] + moments[1] < moments[2] * (1 - _GEOMETRY):
        listed.append(Finding(
            "caution", f"the principal moments of inertia {moments[0]:.6g}, {moments[1]:.6g}, "
            f"{moments[2]:.6g} break the triangle inequality",
            "check coordinates and units, and negative masses in the FE model"))
    return listed


def _rigid(numbers: dict) -> list[Finding]:
    residual = numbers["rigid_residuals"]
    size = f"|K R| is {residual['largest']:.3e} of |K| |R|, worst in {residual['worst']}"
    if residual["largest"] > RIGID_LIMIT:
        return [Finding("defect", f"the stiffness resists rigid motion: {size} (limit "
                        f"{RIGID_LIMIT:.0e})",
                        "export the matrices with 14 digits before reducing; remove supports from "
                        "the FE model; check coordinates, axes and order; for a small residual "
                        "--repair rigid-modes")]
    if residual["largest"] > _DIGITS:
        return [Finding("caution", f"rigid motion causes small forces: {size}",
                        "export with 14 digits, or --repair rigid-modes")]
    return []


def _stiffness(body: Matrices, numbers: dict) -> list[Finding]:
    lowest = numbers["definiteness"]["stiffness"]
    if lowest["lowest"] < -NEGATIVE_STIFFNESS_LIMIT:
        return [Finding("defect", "the stiffness has the negative eigenvalue "
                        f"{lowest['lowest']:.3e} of the largest, mostly in {lowest['worst']}",
                        "check its sign and the digits it was exported with")]
    rigid = np.asarray(numbers["frequencies"]["rigid"])
    flexible = np.asarray(numbers["frequencies"]["flexible"])
    if len(flexible) and flexible[0] < 10 * rigid.max(initial=0.0):
        return [Finding("caution", f"the first flexible frequency, {flexible[0]:.6g} Hz, is hardly "
                        f"above those of rigid motion, up to {rigid.max():.3g} Hz",
                        f"more than {body.rigid.shape[1]} motions without strain indicate a "
                        "mechanism inside, or stiffness lost in printed digits")]
    return []


def _frame(body: Matrices, numbers: dict) -> list[Finding]:
    listed, frame = [], numbers["frame"]
    points = body.coordinates[[keep != "rotation" for keep in body.keeps]]
    if all(keep == "translation" for keep in body.keeps) and body.dimension == 3:
        spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
        if len(points) < 3 or spread[1] < FLAT * spread[0]:
            listed.append(Finding("defect", "boundary nodes without rotations lie on a line, so "
                                  "they do not determine the frame of the body",
                                  "add an interface beside the line, or one with rotations"))
    if frame["off_centre"] > _LUMPED * max(frame["size"], 1e-300) and len(points) > 1:
        listed.append(Finding("caution", "the origin of the mean frame is "
                              f"{frame['off_centre']:.6g} off the centre of mass",
                              "interfaces around the centre of mass couple translation and "
                              "rotation least; inertia option C is not affected"))
    return listed


def _steps(numbers: dict) -> list[Finding]:
    flexible = numbers["frequencies"]["flexible"]
    highest = numbers["frequencies"]["highest"]
    if len(flexible) and flexible[0] > 0 and highest > _STIFF * flexible[0]:
        return [Finding("caution", f"the highest frequency, {highest:.6g} Hz, is "
                        f"{highest / flexible[0]:.3g} times the first flexible one",
                        "choose numerical damping (spectral radius 0.9 or less), which takes care "
                        "of what steps do not resolve")]
    return []


def _cautions(file: BodyFile) -> list[Finding]:
    """Stresses, stiffening and exact inertia that the body lacks, and implausible materials."""
    return [Finding("caution", *text.split("; ", 1)) for text in file.cautions]
