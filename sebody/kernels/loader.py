"""Find and load generated kernels by name: the shipped ones, then the user's directory."""

import os
import re
import sys
from functools import cache
from importlib import import_module
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from sebody.basics.collector import without_collector
from sebody.basics.errors import InputError
from sebody.compiler.sources import TEXT, folder_hash
from sebody.contract.names import (
    ELEMENT,
    IN_PLANE,
    SUPERELEMENT,
    element_name,
    general_layout,
    layout_variant,
    products_name,
    superelement_name,
)

DERIVE = "python -m sebody.derive"
# written by hand, in this folder
BY_HAND = {element_name("user_force"): "sebody.kernels.user_force",
           element_name("continuous"): "sebody.kernels.continuous"}


def user_directory() -> Path:
    """The folder of kernels of other layouts where the package's own cannot be written.

    ``SEBODY_KERNELS``, or ``~/.sebody/kernels``.
    """
    return Path(os.environ.get("SEBODY_KERNELS") or os.path.expanduser("~/.sebody/kernels"))


def find(name: str) -> Path | None:
    """The file of a kernel, shipped or in the user's directory; None if there is none.

    Raises
    ------
    InputError
        The kernel in the user's directory was made by another version of ``kernels/``.
    """
    for folder in find_spec("sebody.generated").submodule_search_locations:
        if (path := Path(folder) / f"{name}.py").exists():
            return path
    path = user_directory() / f"{name}.py"
    if not path.exists():
        return None
    lines = re.findall(r'^([A-Z]+) = "([^"]*)"', path.read_text(encoding="utf-8"), re.MULTILINE)
    facts = dict(lines)
    if facts.get("SOURCES") != folder_hash(*TEXT):
        asked = [name.removeprefix(ELEMENT)]
        if name.startswith(SUPERELEMENT):
            asked = [facts.get(fact, "") for fact in ("LAYOUT", "FRAME", "INERTIA")]
        raise InputError(f"kernel {path} was made by another version of sebody: make it again with"
                         f"\n    {derive_command(*asked)}")
    return path


@cache
def load(name: str) -> ModuleType | None:
    """The module of a kernel, compiled (or read from the cache) on import; None if absent.

    Raises
    ------
    InputError
        A kernel of another version of sebody: see `find`.
    """
    if name in BY_HAND:
        return import_module(BY_HAND[name])
    path = find(name)
    if path is None:
        return None
    with without_collector():
        if path.parent != user_directory():
            return import_module(f"sebody.generated.{name}")
        spec = spec_from_file_location(f"sebody_user_kernels.{name}", path)
        module = module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
        return module


def takes_one_member(name: str) -> bool:
    """Tell if lanes evaluate a kernel member by member: one that keeps numbers, or is by hand.

    Those that choose by their numbers all keep some.
    """
    return name in BY_HAND or bool(getattr(load(name), "MEMORY", ()))


def superelement_kernel_name(layout: str, frame: str, inertia: str, modes: int,
                             damped: bool = False,
                             second_order: tuple[int, int] | None = None) -> str:
    """Name of the fastest kernel there is for a layout, frame and inertia option.

    The one for this number of modes comes first, with the numbers of slaved coordinates and stress
    resultants if they are given and then for any; then that for any number of modes, and last the
    general one, for any numbers of nodes. Structural damping has kernels of its own. Nothing is
    imported or compiled.

    Raises
    ------
    InputError
        If it has not been generated; the message gives the command that makes it.
    """
    variants = [layout_variant(nodes, pinned, damped) for nodes, pinned in (
        (layout, modes), (layout, None), (general_layout(layout), None))]
    for variant in (layout_variant(layout, modes, damped, second_order), *variants):
        name = superelement_name(variant, frame, inertia)
        if find(name):
            return name
    raise InputError(f"there is no kernel for layout {variants[1]!r}, frame {frame!r}, inertia "
                     f"{inertia!r}: make it with\n    "
                     f"{derive_command(variants[1], frame, inertia)}")


def products_kernel_name(kernel: str) -> str | None:
    """Name of the kernel of products with a kernel's derivatives; None if there is none.

    Superelements with as many nodes or modes as their kernel is made for take the general products.
    """
    if find(products_name(kernel)) or not kernel.startswith(SUPERELEMENT):
        own = products_name(kernel)
        return own if find(own) else None
    module = load(kernel)
    layout = re.sub(r"m\d+(s\d+e\d+)?", "", module.LAYOUT).removesuffix("d")
    damped = module.DAMPED is True
    for variant in (layout, general_layout(layout)):
        name = products_name(superelement_name(layout_variant(variant, None, damped), module.FRAME,
                                               module.INERTIA))
        if find(name):
            return name
    return None


def derive_command(*name: str) -> str:
    """A kernel's making: by its name, or a superelement's by layout, frame and inertia option."""
    return f"{DERIVE} {':'.join(name)}"


@cache
def element_kernel_name(kind: str) -> str:
    """Name of the kernel of a kind of joint, load or rigid body.

    Raises
    ------
    InputError
        If it has not been generated.
    """
    name, planar = element_name(kind), kind.startswith(IN_PLANE)
    other = kind.removeprefix(IN_PLANE) if planar else IN_PLANE + kind
    if name not in BY_HAND and not find(name):
        if find(element_name(other)):
            spaces = ("a plane", "space") if planar else ("space", "a plane")
            raise InputError(f"element {kind!r} does not exist for motion in {spaces[0]}, only "
                             f"{other!r} for motion in {spaces[1]}")
        raise InputError(f"there is no kernel for element {kind!r}: reinstall sebody or make it "
                         f"with\n    {derive_command(kind)}")
    return name


def element_kernel(kind: str) -> ModuleType:
    """The kernel `element_kernel_name` names, compiled."""
    return load(element_kernel_name(kind))
