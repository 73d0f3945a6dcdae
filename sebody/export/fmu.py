"""FMUs: archives of a model description and a library for each platform."""

import math
from hashlib import sha256
from pathlib import Path
from typing import BinaryIO, NamedTuple
from xml.sax.saxutils import quoteattr
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from sebody.basics.version import __version__
from sebody.export.interface import PARAMETER
from sebody.export.library import linked
from sebody.export.platforms import PLATFORMS
from sebody.export.prepared import Prepared
from sebody.model.summary import summary

VERSIONS = ("3.0", "2.0")
_DATE = 1980, 1, 1, 0, 0, 0     # of all members: the same model gives the same file


def write_fmu(model: Prepared, file: BinaryIO, work: Path, platforms: list[str], processor: str,
              fmi: str, t_end: float | None) -> None:
    """Write an FMU with a library for each platform.

    Parameters
    ----------
    work : Path
        Folder for intermediate files.
    """
    token = _token(model, fmi)
    (work / "token.h").write_text(f'#define TOKEN "{token}"\n', encoding="utf-8")
    libraries = linked(model, work, platforms, processor, [f"fmi{fmi[0]}.c"])
    with ZipFile(file, "w", ZIP_DEFLATED) as archive:
        def add(name: str, content: bytes) -> None:
            info = ZipInfo(name, _DATE)
            info.compress_type, info.external_attr = ZIP_DEFLATED, 0o644 << 16
            archive.writestr(info, content)
        add("modelDescription.xml", description(model, token, fmi, t_end).encode())
        for platform, library in libraries.items():
            own = PLATFORMS[platform]
            folder = own.fmi2 if fmi == "2.0" else own.fmi3
            add(f"binaries/{folder}/{model.identifier}{own.suffix}", library.read_bytes())


def _token(model: Prepared, fmi: str) -> str:
    """A text that is the same for the same model and interface."""
    digits = sha256(repr((model.image.stored, variables(model), fmi)).encode()).hexdigest()
    return "{" + "-".join(digits[a:b] for a, b in ((0, 8), (8, 12), (12, 16), (16, 20), (20, 32))
                          ) + "}"


class Variable(NamedTuple):
    """A variable of a description."""

    name: str
    reference: int
    causality: str
    variability: str
    unit: str
    start: float | None
    least: float = -math.inf
    most: float = math.inf


def variables(model: Prepared) -> list[Variable]:
    """The time, inputs and parameters, outputs: in the order of their value references.

    Without units of the model there are none: words such as length are no units.
    """
    named = bool(model.model.units)
    listed = [Variable("time", 0, "independent", "continuous", "", None)]
    for one in model.inputs:
        kind = ("parameter", "tunable") if one.kind == PARAMETER else ("input", "continuous")
        listed.append(Variable(one.name, len(listed), *kind, one.unit * named, one.start,
                               one.least, one.most))
    for name, unit in zip(model.names, model.units, strict=True):
        listed.append(Variable(name, len(listed), "output", "continuous", unit * named, None))
    return listed


def description(model: Prepared, token: str, fmi: str, t_end: float | None) -> str:
    """The file modelDescription.xml."""
    return (_fmi2 if fmi == "2.0" else _fmi3)(model, token, variables(model), t_end)


def _fmi3(model: Prepared, token: str, found: list[Variable], t_end: float | None) -> str:
    outputs = [one for one in found if one.causality == "output"]
    structure = [f'<{kind} valueReference="{one.reference}"/>'
                 for kind in ("Output", "InitialUnknown") for one in outputs]
    return _file(_tag(
        "fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": token}
        | _about(model), [
            _tag("CoSimulation", {
                "modelIdentifier": model.identifier, "canGetAndSetFMUState": "true",
                "canSerializeFMUState": "true", "canHandleVariableCommunicationStepSize": "true",
                "canBeInstantiatedOnlyOncePerProcess": "false",
                "providesDirectionalDerivatives": _flag(model.differentiable),
                **({} if model.run.tolerance else {"fixedInternalStepSize": _number(model.run.h)}),
            }), *_units(found), *_categories(), _experiment(model, t_end),
            _tag("ModelVariables", {}, [_variable3(one) for one in found]),
            _tag("ModelStructure", {}, structure)]))


def _fmi2(model: Prepared, token: str, found: list[Variable], t_end: float | None) -> str:
    unknowns = [f'<Unknown index="{one.reference + 1}"/>' for one in found
                if one.causality == "output"]
    structure = [_tag(kind, {}, unknowns) for kind in ("Outputs", "InitialUnknowns") if unknowns]
    return _file(_tag(
        "fmiModelDescription", {"fmiVersion": "2.0", "guid": token}
        | _about(model) | {"numberOfEventIndicators": "0"}, [
            _tag("CoSimulation", {
                "modelIdentifier": model.identifier, "canGetAndSetFMUstate": "true",
                "canSerializeFMUstate": "true", "canHandleVariableCommunicationStepSize": "true",
                "canBeInstantiatedOnlyOncePerProcess": "false",
                "providesDirectionalDerivative": _flag(model.differentiable)}),
            *_units(found), *_categories(), _experiment(model, t_end),
            _tag("ModelVariables", {}, [_variable2(one) for one in found]),
            _tag("ModelStructure", {}, structure)]))


def _about(model: Prepared) -> dict[str, str]:
    return {"modelName": model.name, "description": summary(model.model),
            "generationTool": f"sebody {__version__}", "variableNamingConvention": "flat"}


def _units(found: list[Variable]) -> list[str]:
    units = dict.fromkeys(one.unit for one in found if one.unit)
    return [_tag("UnitDefinitions", {}, [_tag("Unit", {"name": unit}) for unit in units])] * bool(
        units)


def _categories() -> list[str]:
    return [_tag("LogCategories", {}, [_tag("Category", {"name": "logStatusError"})])]


def _experiment(model: Prepared, t_end: float | None) -> str:
    ends = {} if t_end is None else {"stopTime": _number(t_end)}
    return _tag("DefaultExperiment", {"startTime": "0", **ends, "stepSize": _number(model.run.h)})


def _variable3(one: Variable) -> str:
    return _tag("Float64", {"name": one.name, "valueReference": str(one.reference),
                            "causality": one.causality, "variability": one.variability,
                            **_initial(one), **_start(one)})


def _variable2(one: Variable) -> str:
    return _tag("ScalarVariable", {
        "name": one.name, "valueReference": str(one.reference), "causality": one.causality,
        "variability": one.variability, **_initial(one)}, [_tag("Real", _start(one))])


def _initial(one: Variable) -> dict[str, str]:
    initial = {"parameter": "exact", "output": "calculated"}.get(one.causality)
    return {"initial": initial} if initial else {}


def _start(one: Variable) -> dict[str, str]:
    unit = {"unit": one.unit} if one.unit else {}
    bounds = {key: _number(value) for key, value in (("min", one.least), ("max", one.most))
              if math.isfinite(value)}
    return unit | bounds | ({} if one.start is None else {"start": _number(one.start)})


def _flag(value: bool) -> str:
    return "true" if value else "false"


def _number(value: float) -> str:
    return repr(float(value))


def _tag(name: str, attributes: dict[str, str], inside: list[str] | None = None) -> str:
    text = "".join(f" {key}={quoteattr(value)}" for key, value in attributes.items())
    if not inside:
        return f"<{name}{text}/>"
    lines = "\n".join(inside).replace("\n", "\n  ")
    return f"<{name}{text}>\n  {lines}\n</{name}>"


def _file(text: str) -> str:
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'
