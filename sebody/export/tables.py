"""The numbers of a model in C: what runtime.h reads from model.h."""

from collections.abc import Iterable
from hashlib import sha256

import numpy as np

from sebody.contract.layout import RECORD
from sebody.engine import control_data, kept_factors, sparse_lu
from sebody.engine.clock import CLOCK, CONTROL
from sebody.engine.state import ASKED, EVALUATED, REASONS, Record
from sebody.export.prepared import Prepared


def model_h(model: Prepared) -> str:
    """The header model.h."""
    facts = repr((model.inputs, model.image.size)).encode()
    hash_of_all = sha256(model.image.stored + facts).hexdigest()[:16]
    record = Record.of(model.run.state, 0, 1)
    return "\n".join([
        "/* Numbers of a model, made by sebody: see runtime.h. */", "#include <stdint.h>",
        f"#define MODEL_NAME {quoted(model.name)}", f"#define MODEL_HASH 0x{hash_of_all}ull",
        f"#define NAMED(function) {model.identifier}_##function",
        *(f"#define {name} {value}" for name, value in _numbers(model, record).items()),
        *_arrays(model, record), ""])


def _numbers(model: Prepared, record: Record) -> dict[str, int]:
    """Sizes, and places in the image and in groups of numbers, by their names in C."""
    run, image, outputs = model.run, model.image, model.outputs
    system, state = model.system, run.state
    return {
        "IMAGE_SIZE": image.size, "IMAGE_STORED": len(image.stored), "IMAGE_MUTABLE": image.mutable,
        "IMAGE_SAVED": image.saved,
        "AT_CONTROL": image.at(state.control), "AT_CLOCK": image.at(state.clock),
        "AT_MEMORY": image.at(state.memory), "AT_NOW": image.at(state.now),
        "AT_VALUES": image.at(outputs.values), "AT_CORNERS": image.at(system.corners),
        "AT_JUMPS": image.at(system.jumps), "AT_AID": image.at(system.aid),
        "COLUMNS": state.now.size,
        "AT_A": image.at(state.a), "AT_Q": image.at(state.q), "AT_WEIGHT": image.at(state.weight),
        "AT_MULTIPLIERS": image.at(system.is_multiplier), "UNKNOWNS": system.diagonal.size,
        "AT_FACTORS_VALID": image.at(state.spare, kept_factors.VALID), "KEEPS": state.spare.size,
        "DERIVATIVES": int(model.differentiable), "RECORD_PARTS": record.at.size,
        "DENSE": int(run.dense), "ASKED": ASKED, "EVALUATED": EVALUATED, "ROOM": sparse_lu.ROOM,
        "AT_SETTINGS": image.at(model.settings.values.values),
        "SETTINGS": len(model.settings.places), "AT_KIND": image.at(model.exchanges.kind),
        "ADAPTIVE": int(state.control.adaptive),
        "CORNERS": system.corners.size - 1, "TASKS": system.control.periods.size,
        "SENSORS": len(model.sensors), "VARIABLES": len(model.names), "INPUTS": len(model.inputs),
        "REASONS": max(REASONS) + 1, "CALLED": len(model.calls),
        **{f"MEMORY_{name}": getattr(control_data, name) for name in (
            "STOP", "NEXT", "COUNTS")},
        **{f"CONTROL_{name.upper()}": _number(CONTROL, name) for name in (
            "grid", "recorded", "reason", "restart", "corner", "wanted")},
        **{f"CLOCK_{name.upper()}": _number(CLOCK, name) for name in ("time", "step")}}


def _arrays(model: Prepared, record: Record) -> list[str]:
    """Declarations of the constant arrays."""
    system, own = model.system, model.system.control
    first = own.periods.size + control_data.COUNTS
    return [
        *(_words(name, model.image.words(group)) for name, group in (
            ("SYSTEM", system), ("STATE", model.run.state), ("OUTPUTS", model.outputs),
            ("EXCHANGES", model.exchanges))),
        _array("int64_t", "RECORD_AT", record.at.tolist()),
        _array("double", "SCHEME", [_float(x) for x in model.run.scheme]),
        _array("double", "CORNER", [_float(x) for x in system.corners[:-1]]),
        _array("int64_t", "CORNER_JUMPS", system.jumps[:-1].tolist()),
        _array("double", "PERIOD", [_float(x) for x in own.periods]),
        _array("int64_t", "SENSOR_PLACE", [first + k for k, _ in model.sensors]),
        _array("int64_t", "SENSOR_OUTPUT", [
            len(model.names) + k for k in range(len(model.sensors))]),
        _array("int64_t", "CALLED_AT", [at for at, _ in model.calls]),
        _array("int64_t", "CALLED_FUNCTION", [
            model.called.index(name) for _, name in model.calls]),
        _array("int", "INPUT_KIND", [one.kind for one in model.inputs]),
        _array("int64_t", "INPUT_NUMBER", [one.number for one in model.inputs]),
        _array("int64_t", "INPUT_AT", [one.at for one in model.inputs]),
        _array("double", "INPUT_FACTOR", [_float(one.factor) for one in model.inputs]),
        _array("double", "INPUT_LEAST", [_float(one.least) for one in model.inputs]),
        _array("double", "INPUT_MOST", [_float(one.most) for one in model.inputs]),
        _array("char *const", "INPUT_NAME", [quoted(one.name) for one in model.inputs]),
        _array("int64_t", "SETTING_AT", [model.image.at(*one) for one in model.settings.places]),
        _array("double", "SETTING_OFFSET", [_float(x) for x in model.settings.offsets]),
        _array("int64_t", "SETTING_BEGINS", model.settings.slopes.indptr.tolist()),
        _array("int64_t", "SETTING_BY", model.settings.slopes.indices.tolist()),
        _array("double", "SETTING_SLOPE", [_float(x) for x in model.settings.slopes.data]),
        _array("char *const", "REASON", [quoted(REASONS.get(k, "a step failed"))
                                         for k in range(max(REASONS) + 1)])]


def quoted(text: str) -> str:
    """A text as a constant in C; bytes beyond ASCII in octal."""
    return '"' + "".join(chr(b) if 32 <= b < 127 and chr(b) not in '"\\?' else f"\\{b:03o}"
                         for b in text.encode()) + '"'


def _number(fields: np.dtype, name: str) -> int:
    """The number of a field among those of a record."""
    return list(fields.fields or ()).index(name)


def _float(value: float) -> str:
    return float(value).hex() if np.isfinite(value) else "INFINITY" if value > 0 else "-INFINITY"


def _words(name: str, words: list[int]) -> str:
    return f"#define {name}_WORDS {len(words)}\n" + _array("int64_t", name, words)


def _array(kind: str, name: str, values: Iterable[object]) -> str:
    """A constant array, with an entry to spare: C knows no empty ones."""
    return f"static const {kind} {name}[] = {{{', '.join([*map(str, values), '0'])}}};"


def recorded_parts(model: Prepared) -> str:
    """The places of the parts of a row, for the header of a library."""
    slices = model.run.state.recorded_parts
    meanings = {part.name: part.meaning for part in RECORD.parts}
    return "\n".join(f"     {part.start:5d} to {part.stop - 1:5d}  {name}: {meanings[name]}"
                     for name, part in slices.items() if part.stop > part.start)
