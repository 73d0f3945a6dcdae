"""Files of kernels in C99: numbers of the layout, functions they call, and the kernels."""

from collections.abc import Iterable, Iterator

from sebody.derive.form.arrays import array_of
from sebody.derive.form.functions import TABLE_LAW, Gives, Use
from sebody.derive.form.kernel import Kernel
from sebody.derive.form.statements import For, If, Invoke, Operand, Statement
from sebody.derive.kernels.arguments import ARGUMENTS, SIZES
from sebody.derive.passes.fold import folded
from sebody.derive.passes.uses import uses
from sebody.derive.printing.c import tables
from sebody.derive.printing.c.statements import REAL, WHOLE, Block, pointer
from sebody.derive.printing.lines import INDENT, filled, listed

HEAD = ("// Kernels of sebody as C99; sebody/contract/layout.py describes their arguments", "",
        "#include <math.h>", "#include <stdint.h>", "")


def file_text(kernels: Iterable[Kernel]) -> str:
    """A file of some kernels, each a function by its name.

    Counts that are known are numbers in it. Of functions of the runtime the law by a table, which
    springs call, is defined; others are declared: joints, rigid bodies and forces call none.
    """
    bodies = {kernel.name: folded(kernel.body, kernel.known) for kernel in kernels}
    numbers = {agreed.name: agreed.value for body in bodies.values()
               for agreed in uses(body).agreed}
    values = [f"{name} = {value}" for name, value in sorted(numbers.items())]
    lines = [*HEAD, *filled("enum {", listed(values), "};", INDENT), *_declared(bodies.values())]
    for name, body in bodies.items():
        lines += ["", *_signature(name), *Block(_names(), 1).lines(body), "}"]
    return "\n".join([*lines, ""])


def _names() -> list[str]:
    return [*(size.name for size in SIZES), *ARGUMENTS]


def _signature(name: str) -> list[str]:
    arguments = [WHOLE + size.name for size in SIZES]
    arguments += [pointer(array) + array.name for array in ARGUMENTS.values()]
    head = f"{WHOLE}{name}("
    return filled(head, listed(arguments), ") {", " " * len(head))


def _declared(bodies: Iterable[tuple[Statement, ...]]) -> Iterator[str]:
    """Functions of the runtime, with the types of the operands they are called with."""
    bodies = list(bodies)
    calls = {call.function: call for body in bodies for call in _calls(body)}
    for function in dict.fromkeys(f for body in bodies for f in uses(body).functions):
        if function == TABLE_LAW:
            yield tables.TABLE_LAW
            continue
        kinds = [WHOLE + name for name, _ in function.operands]
        if function in calls:
            given = zip(function.operands, calls[function].operands, strict=True)
            kinds = [_type(use, operand) + name for (name, use), operand in given]
        if function.gives is Gives.REALS:
            kinds += [f"{REAL}*out_{k}" for k in range(len(calls[function].outputs))]
        returned = WHOLE if function.gives in (Gives.STATUS, Gives.WHOLE) else "void "
        yield from filled(f"{returned}{function.name}(", listed(kinds), ");", INDENT)


def _type(use: Use, operand: Operand) -> str:
    """The C type of an operand of a call."""
    if use.of_array:
        return pointer(array_of(operand))
    return WHOLE if use is Use.WHOLE else REAL


def _calls(statements: Iterable[Statement]) -> Iterator[Invoke]:
    for statement in statements:
        match statement:
            case Invoke():
                yield statement
            case For(body=body):
                yield from _calls(body)
            case If(body=body, otherwise=otherwise):
                yield from _calls((*body, *otherwise))
