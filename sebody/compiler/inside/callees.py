"""Functions as parts of the compiled functions that call them.

Numba optimizes every function and makes machine code of it before a caller takes a copy, which is
optimized once more with the caller: what is called four calls deep is compiled five times, and most
of that never runs. Here a caller gets the LLVM code as it was lowered. It is optimized and becomes
machine code as a part of what Python or the time loop calls, and nowhere else.
"""

from collections.abc import Callable
from functools import cached_property

from llvmlite import binding
from numba import types

from sebody.compiler.inside.cache import FunctionCache
from sebody.compiler.inside.lookups import Lowering, TypeInference
from sebody.compiler.inside.names import (
    AnnotateTypes,
    BaseNativeLowering,
    CompilerBase,
    CompileResult,
    CPUCodegen,
    CPUDispatcher,
    FixupArgs,
    GenericRewrites,
    IRLegalization,
    IRProcessing,
    JITCodeLibrary,
    NoPythonBackend,
    PassManager,
    PreLowerStripPhis,
    ReconstructSSA,
    TranslateByteCode,
    register_pass,
    take_reloads,
)
from sebody.compiler.sources import KERNELS, in_folder


class _Library(JITCodeLibrary):
    """LLVM code that is linked to that of callers, and no more."""

    optimized = False

    def finalize(self) -> None:
        """Take in what the function calls."""
        for library in dict.fromkeys(self._linking_libraries):
            take_reloads(self, library)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        if self.optimized:
            self._optimize_final_module()
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "external":
                function.linkage = "linkonce_odr"       # callers of a caller may have a copy, too
        self._take(self._final_module)

    def _take(self, module: binding.ModuleRef) -> None:
        self._final_module = self._shared_module = module
        self._finalize_dynamic_globals()
        self._finalized = True

    def serialize_using_object_code(self) -> tuple[str, bytes]:
        """The code as it is kept."""
        self._ensure_finalized()
        return self.name, self._final_module.as_bitcode()

    @classmethod
    def of(cls, codegen: CPUCodegen, kept: tuple[str, bytes]) -> "_Library":
        """The code that was kept."""
        name, code = kept
        library = cls(codegen, name)
        library._take(binding.parse_bitcode(code))
        return library


@register_pass(mutates_CFG=True, analysis_only=False)
class _EntryLowering(BaseNativeLowering):
    _name = "entry_lowering"

    @property
    def lowering_class(self):
        return Lowering


@register_pass(mutates_CFG=True, analysis_only=False)
class _CalleeLowering(_EntryLowering):
    _name = "callee_lowering"

    def run_pass(self, state):
        library = _Library(state.targetctx.codegen(), state.func_id.func_qualname)
        # kernels are slower by a twentieth where their products are not optimized on their own
        library.optimized = in_folder(state.func_id.func, KERNELS)
        state.library, flags = library, state.flags
        flags.noalias = getattr(state.func_id.func, "apart", False)
        flags.no_cpython_wrapper = flags.no_cfunc_wrapper = flags.no_compile = True
        super().run_pass(state)
        lowered, key = state["cr"], object()
        state.targetctx.insert_user_function(key, lowered.fndesc, [library])
        state["cr"] = lowered._replace(cfunc=key)
        return True


class _EntryPasses(CompilerBase):
    """Numba's pipeline for functions that Python calls, without passes that find nothing to do."""

    lowering = _EntryLowering

    def define_pipelines(self) -> list[PassManager]:
        """The one pipeline."""
        manager = PassManager("function")
        for one in (TranslateByteCode, FixupArgs, IRProcessing, GenericRewrites, ReconstructSSA,
                    TypeInference, PreLowerStripPhis, IRLegalization, AnnotateTypes,
                    self.lowering, NoPythonBackend):
            manager.add_pass(one, one.__name__)
        manager.finalize()
        return [manager]


class _CalleePasses(_EntryPasses):
    """The same as far as LLVM code."""

    lowering = _CalleeLowering


class _CalleeCache(FunctionCache):
    """LLVM code that is kept."""

    kind = "callee"
    _reduced = staticmethod(CompileResult._reduce)

    @staticmethod
    def _rebuilt(context, library, fndesc, env, signature, objectmode, lifted, typeann, reload_init,
                 envs) -> CompileResult:
        return CompileResult(
            target_context=context, typing_context=context.typing_context,
            library=_Library.of(context.codegen(), library), environment=env, entry_point=object(),
            fndesc=fndesc, type_annotation=typeann, signature=signature, objectmode=objectmode,
            lifted=lifted, typing_error=None, call_helper=None, metadata=None,
            reload_init=reload_init, referenced_envs=envs)


class Callee(CPUDispatcher):
    """A function as a part of others, for every signature; Python cannot call it."""

    def __init__(self, function: Callable, options: dict, made_from: str):
        super().__init__(function, targetoptions=options, pipeline_class=_CalleePasses)
        self._cache = _CalleeCache(function, made_from)

    def add_overload(self, cres: CompileResult) -> None:
        """Remember what is compiled."""
        self.overloads[tuple(cres.signature.args)] = cres


class Function(CPUDispatcher):
    """A compiled function: what Python calls, and what other compiled functions take in."""

    def __init__(self, function: Callable, options: dict, made_from: str):
        super().__init__(function, targetoptions=options, pipeline_class=_EntryPasses)
        self._cache = FunctionCache(function, made_from)
        self._made_from = made_from
        # constants make kernels faster; elsewhere they come with the code that callers take in
        self._specialized = in_folder(function, KERNELS)
        self.in_lanes: Function | None = None       # what is called with lanes in its place

    @cached_property        # most runs compile nothing
    def callee(self) -> Callee:
        """The code that compiled functions take in."""
        return Callee(self.py_func, self.targetoptions, self._made_from)

    def get_call_template(self, args, kws):
        """For Numba: the signature of a call in a compiled function."""
        if self.in_lanes is not None and _takes_lanes(args):
            return self.in_lanes.get_call_template(args, kws)
        if not self._specialized:
            args = [types.unliteral(kind) for kind in args]
        return self.callee.get_call_template(args, kws)

    def get_overload(self, sig):
        """For Numba: the function of a signature, for its callers."""
        if self.in_lanes is not None and _takes_lanes(sig):
            return self.in_lanes.get_overload(sig)
        return self.callee.get_overload(sig)


def _takes_lanes(kinds):
    from sebody.compiler.inside.lanes import takes_lanes  # 5 ms that most runs do not need

    return takes_lanes(kinds)
