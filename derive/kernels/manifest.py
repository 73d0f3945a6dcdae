"""The kernels that are shipped: one table of superelements, and all others.

A kernel fuses one frame and one inertia option, so the loop makes one call an element and the
compiler sees all of its arithmetic. The formulas are derived once for each and only combined here:
sources add, and files multiply no further than this table; any other combination is made on demand.
"""

from sebody.derive.kernels.body_contact import BODY_CONTACTS
from sebody.derive.kernels.body_load import BODY_LOADS
from sebody.derive.kernels.catalogue import (
    ELEMENTS as CATALOGUE,
    LAWS,
    LAWS_ALONG_PATHS,
    LAWS_OF_SLIP,
    SMOOTH,
    SMOOTH_ALONG_PATHS,
)
from sebody.derive.kernels.motion import MOTIONS
from sebody.derive.kernels.options import frame_traits
from sebody.derive.kernels.path import PATH_ACROSS, PATH_LOADS, PATH_TURNS, PATHS


def _lasts(frame: str) -> bool:
    return not frame_traits()[frame].incremental


SUPERELEMENTS = (
    # layout, frame, inertia option; pinned numbers of modes where beams mostly need no others
    ("f2", "converged_mean", "material"),
    ("f2d", "converged_mean", "material"),
    ("f2m4", "converged_mean", "material"),
    ("f2m8", "converged_mean", "material"),
    ("f2", "mean", "material"),
    ("f2", "mean_small", "material"),
    ("f2", "converged_mean", "frame_axes"),
    ("f2t1", "converged_mean", "material"),
    ("f2t1", "positions", "material"),
    ("planar-f2", "converged_mean", "material"),
    ("planar-f2d", "converged_mean", "material"),
    ("planar-f2m2", "converged_mean", "material"),
    ("planar-f2m4", "converged_mean", "material"),
    ("planar-f2", "converged_mean", "frame_axes"),
    ("planar-f2", "positions", "material"),
    ("f2", "converged_mean", "floating_field"),
    ("planar-f2", "converged_mean", "floating_field"),
    # and numbers of slaved coordinates and stress resultants, which straight beams have
    ("f2m4s2e1", "converged_mean", "floating_field"),
    ("f2m8s2e1", "converged_mean", "floating_field"),
    ("planar-f2m0s2e1", "converged_mean", "floating_field"),
    ("planar-f2m2s2e1", "converged_mean", "floating_field"),
    # for all other layouts: counts of nodes are read at run time
    ("any", "converged_mean", "material"),
    ("any", "positions", "material"),
    ("any", "mean", "material"),
    ("any", "mean_small", "material"),
    ("anyd", "converged_mean", "material"),
    ("anyd", "positions", "material"),
    ("planar-any", "converged_mean", "material"),
    ("planar-any", "positions", "material"),
    ("planar-anyd", "converged_mean", "material"),
    ("planar-anyd", "positions", "material"),
    ("any", "converged_mean", "floating_field"),
    ("any", "positions", "floating_field"),
    ("planar-any", "converged_mean", "floating_field"),
    ("planar-any", "positions", "floating_field"),
    ("any", "mean_axes", "floating_field"),
    ("planar-any", "mean_axes", "floating_field"),
    ("any", "converged_mean", "rigid_part"),
    ("any", "positions", "rigid_part"),
    ("planar-any", "converged_mean", "rigid_part"),
    ("planar-any", "positions", "rigid_part"),
)
ELEMENTS = (*CATALOGUE, *BODY_LOADS, *BODY_CONTACTS, *PATHS, *PATH_TURNS, *PATH_ACROSS,
            *PATH_LOADS, *MOTIONS)

# long kernels of rare elements: gradients of runs with these take matrices in place of products
UNSHIPPED = "bearing", "planar_bearing"
# with products of their derivatives, of which gradients of runs are made: general superelements and
# the layouts of beams, others take these; no frames that depend on the steps before
LAYOUTS = "f2", "planar-f2", "any", "anyd", "planar-any", "planar-anyd"
PRODUCTS = (
    *(row for row in SUPERELEMENTS if _lasts(row[1])
      and (row[0] in LAYOUTS or row[2] == "frame_axes")),
    # none of what acts along paths, or slips without mass: such runs have no gradients
    *(name for name in SMOOTH if name not in (*UNSHIPPED, *SMOOTH_ALONG_PATHS)),
    *(name for name in LAWS if name not in (*LAWS_ALONG_PATHS, *LAWS_OF_SLIP)),
    *(name for name, (frame, _) in BODY_LOADS.items() if _lasts(frame)))
