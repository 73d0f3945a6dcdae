"""``sebody inspect``: what is in a body file, what is wrong with it, and what to do.

    file -> numbers -> findings with remedies -> verdict, as text or JSON
"""

import json
from typing import NamedTuple

import numpy as np

from sebody.explore.inspection import measures
from sebody.explore.inspection.findings import Finding, findings_of, verdict
from sebody.explore.inspection.repair import free_rigid_motion
from sebody.io.body_file import BodyFile

__all__ = ["Inspection", "free_rigid_motion", "inspect", "report", "to_json"]

_ROUNDING = 1e-13       # of sums over an FE model, of their largest part


class Inspection(NamedTuple):
    """Numbers by name, findings and the verdict on a body."""

    file: BodyFile
    body: measures.Matrices
    numbers: dict
    findings: list[Finding]
    verdict: str

    @property
    def usable(self) -> bool:
        """Tell whether there is no defect."""
        return all(one.severity != "defect" for one in self.findings)


def inspect(file: BodyFile) -> Inspection:
    """Measure and judge what a body file holds.

    Raises
    ------
    InputError
        Parts of different sizes, for which no report is possible.
    """
    body = measures.matrices_of(file)
    numbers = measures.mass_properties(body)
    numbers["rigid_residuals"] = measures.rigid_residuals(body)
    numbers["asymmetry"] = body.asymmetry
    numbers["definiteness"] = measures.definiteness(body)
    numbers["frequencies"] = measures.frequencies(body)
    numbers["clamped"] = measures.clamped(body, file.parts.get("modes", 0), numbers["centre"])
    numbers["frame"] = measures.frame(body, numbers["centre"])
    numbers["stiffening"] = measures.stiffening(file, body)
    findings = findings_of(file, body, numbers)
    return Inspection(file, body, numbers, findings, verdict(findings))


def to_json(inspection: Inspection) -> str:
    """Everything, for programs."""
    file = inspection.file
    layout = {"names": file.names, "keeps": file.parts["keeps"],
              "modes": file.parts.get("modes", 0), "coordinates": file.parts["coordinates"],
              "outputs": {name: len(matrix) for name, matrix in
                          (file.parts.get("outputs") or {}).items()}}
    whole = {"layout": layout, "units": file.units, "provenance": dict(file.provenance),
             **inspection.numbers, "findings": [one._asdict() for one in inspection.findings],
             "usable": inspection.usable, "verdict": inspection.verdict}
    return json.dumps(_plain(whole), indent=1)


def report(inspection: Inspection) -> str:
    """The same in words."""
    file, numbers = inspection.file, inspection.numbers
    sections = [*_layout(file), *_inertia(numbers), *_motion(numbers), *_vibration(numbers),
                *_effective_masses(numbers["clamped"])]
    lines = [f"{name:24} {text}" for name, text in sections]
    for one in inspection.findings:
        lines += [f"{one.severity}: {one.text}", f"  remedy: {one.remedy}"]
    return "\n".join([*lines, f"verdict: {inspection.verdict}"])


def _layout(file: BodyFile) -> list[tuple[str, str]]:
    coordinates = file.parts["coordinates"]
    rows = list(file.provenance.items())
    rows.append(("units", file.units or "not said"))
    rows += [("interface", f"{name} keeps {keep}, at {_row(point)}") for name, keep, point
             in zip(file.names, file.parts["keeps"], coordinates, strict=True)]
    rows += [("output", f"{name}.values, {len(matrix)} numbers")
             for name, matrix in (file.parts.get("outputs") or {}).items()]
    return [*rows, ("internal modes", str(file.parts.get("modes", 0)))]


def _inertia(numbers: dict) -> list[tuple[str, str]]:
    rows = [("mass", _number(numbers["mass"])), ("centre of mass", _row(numbers["centre"]))]
    rows += [("inertia about it", _row(row)) for row in numbers["inertia"]]
    if len(numbers["principal_moments"]) == 3:
        rows += [("principal moment, axis", f"{_number(moment)},  {_row(axis)}") for moment, axis in
                 zip(numbers["principal_moments"], numbers["principal_axes"].T, strict=True)]
    return [*rows, ("R^T M R off geometry", f"{numbers['mass_geometry_defect']:.4e} of the mass")]


def _motion(numbers: dict) -> list[tuple[str, str]]:
    rows = [("|K R| of |K| |R|", f"{value:.4e}  {name}")
            for name, value in numbers["rigid_residuals"]["each"].items()]
    for name in ("stiffness", "mass"):
        one = numbers["definiteness"][name]
        rows.append((name, f"asymmetry {numbers['asymmetry'][name]:.4e}, lowest eigenvalue "
                     f"{one['lowest']:.4e} of the largest, condition {one['condition']:.4e}"))
    frame = numbers["frame"]
    rows += [("weights", _row(frame["weights"])),
             ("frame origin", f"{_row(frame['origin'])}, {_number(frame['off_centre'])} off the "
              "centre of mass")]
    if second := numbers["stiffening"]:
        rows.append(("of second order", f"{second['load_modes']} load modes, "
                     f"{second['resultants']} of {second['motions']} stress resultants"))
    return rows


def _vibration(numbers: dict) -> list[tuple[str, str]]:
    hertz = numbers["frequencies"]
    rows = [("rigid motion, Hz", _row(hertz["rigid"])),
            ("free vibration, Hz", _row(hertz["flexible"]))]
    if hertz["count"]:
        rows += [("highest of all, Hz", f"{_number(hertz['highest'])} ({hertz['count']} in all)"),
                 ("step, six a period", f"{_number(hertz['step_first'])} of the first, "
                  f"{_number(hertz['step_highest'])} of the highest")]
    return rows


def _effective_masses(clamped: dict) -> list[tuple[str, str]]:
    """Parts of the mass that vibrations with held interfaces move; of many the first."""
    if not len(clamped["frequencies"]):
        return []
    def row(parts: np.ndarray) -> str:
        return "".join(f"{part:9.4f}" for part in parts)
    heads = "".join(f"{one:>9}" for one in clamped["directions"])
    shown = zip(clamped["frequencies"][:measures.SHOWN], clamped["parts"], strict=False)
    return [("interfaces held, Hz", f"{'part of mass':12} {heads}"),
            *((f"  mode {k + 1}", f"{_number(hertz):12} {row(parts)}")
              for k, (hertz, parts) in enumerate(shown)),
            ("  all modes", f"{'':12} {row(clamped['parts'].sum(axis=0))}")]


def _number(value: float) -> str:
    return f"{value:.7g}"


def _row(values) -> str:
    """Numbers of one kind; what is rounding of the largest is shown as zero."""
    values = np.asarray(values, dtype=float)
    rounding = _ROUNDING * np.abs(values).max(initial=0.0)
    return "  ".join(map(_number, np.where(np.abs(values) > rounding, values, 0.0))) or "none"


def _plain(value):
    """Arrays as lists; numbers that JSON does not have as null."""
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(one) for one in value]
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return value.item() if isinstance(value, np.generic) else value
