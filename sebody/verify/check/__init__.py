"""Consistency of generated kernels and of quantities: forces against energies, tangents, rates of
tapes against differences.

Every criterion compares a kernel with derivatives taken numerically, in seeded generic states:
rotations of the order of one radian, elastic rotations to 0.3, moving and accelerating.
"""

from collections.abc import Iterable

from sebody.catalogue import kernel_files, product_files
from sebody.contract.names import ELEMENT, MOTION, PRODUCTS, SUPERELEMENT
from sebody.kernels.loader import load
from sebody.runs.first_run import compile_missing
from sebody.verify.check.body_contacts import check_body_contact
from sebody.verify.check.body_loads import check_body_load
from sebody.verify.check.chosen import chosen_kernels
from sebody.verify.check.elements import check_element
from sebody.verify.check.law_products import check_law_products
from sebody.verify.check.laws import follows
from sebody.verify.check.motions import check_motion
from sebody.verify.check.paths import check_body_path, check_path_load
from sebody.verify.check.products import check_products
from sebody.verify.check.quantities import QUANTITIES, check_quantities
from sebody.verify.check.report import summary, table, verdict
from sebody.verify.check.states import CheckRow
from sebody.verify.check.superelements import check_superelement

__all__ = ["CheckRow", "check_kernels", "summary", "table", "verdict"]


def check_kernels(names: Iterable[str] | None = None) -> list[CheckRow]:
    """Check kernels by name, and ``quantities``, all by default; see `chosen.chosen_kernels`.

    Raises
    ------
    InputError
        An unknown name.
    """
    known, rows = [*kernel_files(), *product_files()], []
    asked = None if names is None else list(names)
    of_kernels = [name for name in asked or () if name != QUANTITIES]
    chosen = chosen_kernels(of_kernels, known) if asked else known
    of_products = [name.removeprefix(PRODUCTS) for name in chosen]
    compile_missing(dict.fromkeys((*chosen, *of_products)))
    for name in chosen:
        module = load(name)
        check = (check_superelement if name.startswith(SUPERELEMENT) else
                 check_law_products if _of_laws(name) else
                 check_products if name.startswith(PRODUCTS) else
                 check_motion if name.startswith(MOTION) else
                 check_body_path if hasattr(module, "WAY") else
                 check_body_contact if hasattr(module, "CARRIERS") else
                 check_path_load if hasattr(module, "MOVING") else
                 check_body_load if hasattr(module, "FRAME") else check_element)
        rows += check(name, module)
    if not asked or QUANTITIES in asked:
        rows += check_quantities()
    return rows


def _of_laws(name: str) -> bool:
    """Tell whether a kernel has products with the derivatives of a law."""
    return name.startswith(PRODUCTS + ELEMENT) and follows(load(name))
