"""Object files: LLVM code of the loop, kernels and users' functions, without Python.

Compiled functions have Numba's calling convention: a place for the result, one for an exception,
then the arguments; they return a status. Every function that is called by address, or from C, gets
a wrapper with the convention of C.
"""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

from llvmlite import binding

from sebody.basics.errors import InputError
from sebody.compiler.code import Code
from sebody.engine.state import NOT_FINITE
from sebody.export.platforms import PLATFORMS, target_processor

OPAQUE = 17             # version of LLVM from which on pointers are opaque, as the wrappers write
RAISED = 6              # what the loop returns if compiled code raised, see runtime.h


class Convention(NamedTuple):
    """The C call of a function."""

    returns: str            # LLVM type
    arguments: tuple[str, ...]
    failed: str             # returned after an exception


_KERNEL = Convention("i64", ("i64",) * 4 + ("ptr",) * 15, str(NOT_FINITE))
CONVENTIONS = {
    "refactorize": Convention("i1", ("ptr", "ptr", "i64", "i1"), "false"),
    "restart": Convention("i64", ("ptr", "ptr", "double", "i1"), str(RAISED)),
    "sample": Convention("i64", ("ptr", "ptr"), str(RAISED)),
    "set_input": Convention("i64", ("ptr", "ptr", "i64", "double"), "0"),
    "evaluate": Convention("i64", ("ptr",) * 3, "1"),
    "exchange": Convention("i64", ("ptr", "ptr", "ptr", "i64"), "1"),
    "history": Convention("double", ("double",), "0x7FF8000000000000"),
    "force": Convention("void", ("i64", "double", "ptr", "ptr", "ptr"), ""),
    "controller": Convention("i64", ("double",) + ("ptr",) * 4, "1"),
}


class Part(NamedTuple):
    """A function of a library."""

    name: str           # of its wrapper, without the prefix
    convention: str     # one of `CONVENTIONS`, "kernel" or "advance"
    code: Code


def functions_object(parts: Sequence[Part], platform: str, processor: str) -> bytes:
    """The object file of some functions, which has their wrappers for C alone."""
    return _object(_wrappers(parts), parts, [f"sb_{part.name}" for part in parts], platform,
                   processor)


def model_object(called: Sequence[str], image: bytes, platform: str, processor: str) -> bytes:
    """The object file of a model's data.

    Parameters
    ----------
    called : sequence of str
        Names of the functions that are called by address, in the order of the table.
    image : bytes
        Memory of an instance at the start, compressed.
    """
    kind = f"[{max(1, len(called))} x ptr]"
    table = ", ".join(f"ptr @sb_{name}" for name in called) or "ptr null"
    declared = "\n".join(f"declare hidden void @sb_{name}()" for name in called)
    text = (f"{declared}\n@sb_functions = hidden constant {kind} [{table}]\n"
            + _bytes("sb_image", image))
    return _object(text, (), ["sb_functions", "sb_image"], platform, processor)


def _object(text: str, parts: Sequence[Part], kept: Sequence[str], platform: str,
            processor: str) -> bytes:
    """Object file of a module and of parts that are linked to it."""
    _prepare()
    own = PLATFORMS[platform]
    heading = f'target datalayout = "{own.layout}"\ntarget triple = "{own.triple}"\n'
    main = binding.parse_assembly(heading + text)
    for part in parts:
        main.link_in(_alone(part, own.layout, own.triple))
    _make_internal(main, kept)
    for function in main.functions:
        function.add_function_attribute("nounwind")     # no tables for exceptions of C++
    main.verify()
    machine = binding.Target.from_triple(own.triple).create_target_machine(
        *target_processor(platform, processor), opt=3, reloc="pic", codemodel="default")
    builder = binding.create_pass_builder(
        machine, binding.create_pipeline_tuning_options(speed_level=2))
    passes = binding.create_new_module_pass_manager()
    passes.add_merge_functions_pass()       # parts bring their own copies of what they call
    passes.add_global_dead_code_eliminate_pass()
    passes.run(main, builder)
    return machine.emit_object(main)


@cache
def _prepare() -> None:
    """Let LLVM know all targets.

    Raises
    ------
    InputError
        An old version of LLVM.
    """
    if binding.llvm_version_info[0] < OPAQUE:
        raise InputError(f"export needs LLVM {OPAQUE} or later, this is "
                         f"{'.'.join(map(str, binding.llvm_version_info))}: update Numba to 0.62 "
                         "or later")
    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()


def _alone(part: Part, layout: str, triple: str) -> binding.ModuleRef:
    """The module of a part, of which others see one function."""
    module = binding.parse_bitcode(part.code.bitcode)
    module.data_layout, module.triple = layout, triple
    _make_internal(module, (part.code.symbol,))
    module.get_function(part.code.symbol).name = f"nb_{part.name}"
    return module


def _make_internal(module: binding.ModuleRef, kept: Sequence[str]) -> None:
    for one in (*module.functions, *module.global_variables):
        if not one.is_declaration and one.name not in kept:
            one.linkage = "internal"


def _wrappers(parts: Sequence[Part]) -> str:
    return "\n".join(_advance() if part.convention == "advance" else
                     _wrapper(part.name, CONVENTIONS.get(part.convention, _KERNEL))
                     for part in parts) + "\n"


def _native(kind: str) -> str:
    """The type by which Numba passes a value: flags as bytes."""
    return "i8" if kind == "i1" else kind


def _wrapper(name: str, own: Convention) -> str:
    """A function with the convention of C that calls one with Numba's."""
    natives = [_native(kind) for kind in own.arguments]
    place = "ptr" if own.returns == "void" else _native(own.returns)
    zero = {"ptr": "null", "double": "0.0"}.get(place, "0")
    lines = [f"declare i32 @nb_{name}({', '.join(['ptr', 'ptr', *natives])})",
             f"define hidden {own.returns} @sb_{name}("
             + ", ".join(f"{kind} %a{k}" for k, kind in enumerate(own.arguments)) + ") {",
             f" %result = alloca {place}", " %exception = alloca ptr",
             f" store {place} {zero}, ptr %result"]
    given = []
    for k, kind in enumerate(own.arguments):
        if kind == "i1":
            lines.append(f" %n{k} = zext i1 %a{k} to i8")
        given.append(f"i8 %n{k}" if kind == "i1" else f"{kind} %a{k}")
    call = ", ".join(["ptr %result", "ptr %exception", *given])
    lines.append(f" %status = call i32 @nb_{name}({call})")
    if own.returns == "void":
        return "\n".join([*lines, " ret void", "}"])
    lines += [" %failed = icmp ne i32 %status, 0", f" %value = load {place}, ptr %result"]
    value = "%value"
    if own.returns == "i1":
        lines.append(" %flag = trunc i8 %value to i1")
        value = "%flag"
    return "\n".join([*lines,
                      f" %out = select i1 %failed, {own.returns} {own.failed}, "
                      f"{own.returns} {value}", f" ret {own.returns} %out", "}"])


def _advance() -> str:
    """`advance` with the scheme as an array, and with whole numbers for flags."""
    numbers = [f" %p{k} = getelementptr double, ptr %scheme, i64 {k}\n"
               f" %s{k} = load double, ptr %p{k}\n" for k in range(7)]
    scheme = "".join(f"double %s{k}, " for k in range(6))
    return f"""declare i32 @nb_advance(ptr, ptr, ptr, ptr, ptr, {"double, " * 6}i8, i64, i64, i8)
define hidden i64 @sb_advance(ptr %system, ptr %state, ptr %record, ptr %scheme, i64 %last,
                              i64 %chunk, i64 %dense) {{
 %result = alloca i64
 %exception = alloca ptr
 store i64 0, ptr %result
{"".join(numbers)} %set = fcmp one double %s6, 0.0
 %stabilized = zext i1 %set to i8
 %small = trunc i64 %dense to i8
 %status = call i32 @nb_advance(ptr %result, ptr %exception, ptr %system, ptr %state, ptr %record,
                                {scheme}i8 %stabilized, i64 %last, i64 %chunk, i8 %small)
 %failed = icmp ne i32 %status, 0
 %value = load i64, ptr %result
 %out = select i1 %failed, i64 {RAISED}, i64 %value
 ret i64 %out
}}"""


def _bytes(name: str, content: bytes) -> str:
    """A constant of bytes, aligned as the arrays in it are."""
    text = "".join(chr(b) if 32 <= b < 127 and b not in (34, 92) else f"\\{b:02X}"
                   for b in content)
    return f'@{name} = hidden constant [{len(content)} x i8] c"{text}", align 64\n'
