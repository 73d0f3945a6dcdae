"""Numba's type inference and lowering, with a memory for what operations on numbers are.

Numba looks for the function of an operation and the types of its arguments anew for every sum and
every product, among all overloads, once to infer types and once to lower. With thousands of them in
a kernel that takes a third of its compilation.
"""

import operator

from numba import types

from sebody.compiler.inside.names import (
    UNDEFINED,
    BaseContext,
    Lower,
    NopythonTypeInference,
    Signature,
    register_pass,
)
from sebody.compiler.inside.remembered import plain

_signatures: dict[tuple, Signature] = {}        # by operation and types of arguments


def _remembered(operation: object, arguments: tuple[types.Type, ...], find) -> Signature:
    """The signature of an operation on numbers and pointers, found once in a process."""
    key = operation, arguments
    signature = _signatures.get(key)
    if signature is None and (signature := find()) is not None:
        _signatures[key] = signature
    return signature


class _Remembering:
    """A typing context that resolves a function of given numbers and pointers only once."""

    def __init__(self, context: BaseContext):
        self._context = context

    def __getattr__(self, name):
        return getattr(self._context, name)

    def resolve_function_type(self, function, arguments, keywords):
        def find():
            return self._context.resolve_function_type(function, arguments, keywords)
        if keywords or not plain(arguments):
            return find()
        return _remembered(function, arguments, find)

    def resolve_setitem(self, target, index, value):
        def find():
            return self._context.resolve_setitem(target, index, value)
        arguments = target, index, value
        return _remembered(operator.setitem, arguments, find) if plain(arguments) else find()


@register_pass(mutates_CFG=True, analysis_only=False)
class TypeInference(NopythonTypeInference):
    """Numba's inference of types with a memory."""

    def run_pass(self, state):
        """Infer types."""
        # Kept code may have signatures of lanes, and reading it imports them. Their operators must
        # be there before: those that are lowered have to be those that were inferred. Runs that
        # compile nothing do not need the 10 ms
        import sebody.compiler.inside.lanes  # noqa: F401

        context = state.typingctx
        context.refresh()
        state.typingctx = _Remembering(context)
        try:
            return super().run_pass(state)
        finally:
            state.typingctx = context


class Lowering(Lower):
    """Numba's lowering with a memory."""

    def lower_binop(self, resty, expr, op):
        """Lower an operation with two operands."""
        signature = self.fndesc.calltypes[expr]
        if not plain(signature.args) or expr.static_lhs is not UNDEFINED or (
                expr.static_rhs is not UNDEFINED):
            return super().lower_binop(resty, expr, op)
        return self._lower(op, (expr.lhs, expr.rhs), signature, resty)

    def lower_getitem(self, resty, expr, value, index, signature):
        """Lower the reading of an element."""
        if not plain(signature.args):
            return super().lower_getitem(resty, expr, value, index, signature)
        return self._lower(operator.getitem, (value, index), signature, resty)

    def _lower(self, operation, operands, signature, wanted):
        values = [self._cast_var(operand, kind)
                  for operand, kind in zip(operands, signature.args, strict=True)]
        result = self._implementation(operation, signature.args)(self.builder, values)
        return self.context.cast(self.builder, result, signature.return_type, wanted)

    def _implementation(self, operation, arguments):
        typing = self.context.typing_context
        function = typing.resolve_value_type(operation)
        return self.context.get_function(function, _remembered(
            operation, arguments, lambda: function.get_call_type(typing, arguments, {})))
