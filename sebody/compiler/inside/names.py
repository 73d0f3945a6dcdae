"""Everything that is used of Numba beyond its public interface: names and attributes.

Importing this module raises an `ImportError` where a version of Numba lacks one of them. Attributes
that instances get as they are made are not seen here: see `sebody.compiler.inside.trial`.
"""

from numba.core.caching import NullCache
from numba.core.ccallback import CFunc
from numba.core.cgutils import get_or_insert_function
from numba.core.codegen import CPUCodegen, JITCodeLibrary
from numba.core.compiler import CompilerBase, CompileResult
from numba.core.compiler_machinery import FunctionPass, PassManager, register_pass
from numba.core.datamodel.models import RecordModel
from numba.core.imputils import lower_constant
from numba.core.ir import UNDEFINED, Jump
from numba.core.lowering import Lower
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.runtime import rtsys as runtime
from numba.core.serialize import dumps
from numba.core.sigutils import normalize_signature
from numba.core.transforms import canonicalize_cfg
from numba.core.typeconv import Conversion
from numba.core.typed_passes import (
    AnnotateTypes,
    BaseNativeLowering,
    IRLegalization,
    NoPythonBackend,
    NopythonTypeInference,
    PreLowerStripPhis,
)
from numba.core.typing.context import BaseContext
from numba.core.typing.templates import (
    AbstractTemplate,
    AttributeTemplate,
    Signature,
    infer_global,
    signature,
)
from numba.core.untyped_passes import (
    FixupArgs,
    GenericRewrites,
    IRProcessing,
    ReconstructSSA,
    TranslateByteCode,
)

__all__ = [
    "AbstractTemplate", "AnnotateTypes", "AttributeTemplate", "BaseContext", "BaseNativeLowering",
    "CFunc", "CPUCodegen", "CPUDispatcher", "CompileResult", "CompilerBase", "Conversion",
    "FixupArgs", "FunctionPass", "GenericRewrites", "IRLegalization", "IRProcessing",
    "JITCodeLibrary", "Jump", "Lower", "NoPythonBackend", "NopythonTypeInference", "NullCache",
    "PassManager", "PreLowerStripPhis", "ReconstructSSA", "RecordModel", "Signature",
    "TranslateByteCode", "UNDEFINED", "canonicalize_cfg", "cpu_target", "dumps",
    "get_or_insert_function", "infer_global", "lower_constant", "normalize_signature",
    "register_pass", "runtime", "signature", "take_reloads"]

ATTRIBUTES = {
    CFunc: ("compile", "address"),
    CPUCodegen: ("magic_tuple",),
    CPUDispatcher: ("add_overload", "compile", "get_call_template", "get_overload"),
    CompileResult: ("_reduce",),
    JITCodeLibrary: ("_ensure_finalized", "_finalize_dynamic_globals", "_finalize_final_module",
                     "_get_compiled_object", "_get_module_for_linking", "_optimize_final_module",
                     "_set_compiled_object", "add_ir_module", "create_ir_module",
                     "enable_object_caching", "finalize", "get_pointer_to_function",
                     "serialize_using_object_code"),
    Lower: ("_cast_var", "create_cfunc_wrapper", "lower_binop", "lower_getitem", "lower_inst"),
    BaseContext: ("resolve_function_type", "resolve_setitem", "resolve_value_type"),
    NullCache: ("load_overload", "save_overload"),
}

for _owner, _attributes in ATTRIBUTES.items():
    for _name in _attributes:
        if not hasattr(_owner, _name):
            raise ImportError(f"{_owner.__module__}.{_owner.__name__} has no attribute {_name!r}")


def take_reloads(library: JITCodeLibrary, other: JITCodeLibrary) -> None:
    """Take over what is called where code is read from a file; not in all versions of Numba."""
    if hasattr(library, "_reload_init"):
        library._reload_init.update(other._reload_init)
