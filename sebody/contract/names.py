"""Names of kernels, which are the names of their modules."""

SUPERELEMENT, ELEMENT, MOTION = PREFIXES = "superelement_", "element_", "motion_"
PRODUCTS = "products_"      # before the name of a kernel: products with its derivatives
PLANAR = "planar-"  # begins names of layouts in a plane
IN_PLANE = "planar_"     # begins names of kernels of elements in a plane
ANY = "any"         # layout of the general kernels, which read the counts of nodes at run time


def superelement_name(layout: str, frame: str, inertia: str) -> str:
    """The kernel of a superelement's layout, frame and inertia option."""
    return f"{SUPERELEMENT}{layout}_{frame}_{inertia}".replace("-", "_")


def element_name(kind: str) -> str:
    """The kernel of a kind of joint, load or rigid body."""
    return ELEMENT + kind


def body_load_kind(frame: str, planar: bool) -> str:
    """Kind of a load on a body with this frame: the name of its kernel without the prefix."""
    return IN_PLANE * planar + f"body_load_{frame}"


def body_contact_kind(frame: str, planar: bool) -> str:
    """Kind of a contact of a point inside a body with this frame."""
    return IN_PLANE * planar + f"body_contact_{frame}"


def path_kind(frame: str, planar: bool) -> str:
    """Kind of a point on a path of a body with this frame."""
    return IN_PLANE * planar + f"body_path_{frame}"


def path_turn_kind(frame: str, planar: bool) -> str:
    """Kind of a node that turns with a path of a body with this frame."""
    return IN_PLANE * planar + f"path_turn_{frame}"


def path_across_kind(frame: str) -> str:
    """Kind of a point that a path of a body with this frame holds in one direction, in space."""
    return f"path_across_{frame}"


def path_load_kind(frame: str, planar: bool) -> str:
    """Kind of forces that move along a path of a body with this frame."""
    return IN_PLANE * planar + f"path_load_{frame}"


def motion_name(frame: str, planar: bool) -> str:
    """The kernel of the motion of bodies with a frame: its place, local coordinates, rates."""
    return MOTION + IN_PLANE * planar + frame


def products_name(kernel: str) -> str:
    """The kernel of products with the derivatives of the forces of another kernel."""
    return PRODUCTS + kernel


def general_layout(layout: str) -> str:
    """Layout of the general kernels that serve a layout, too."""
    return PLANAR * layout.startswith(PLANAR) + ANY


def layout_variant(layout: str, modes: int | None = None, damped: bool = False,
                   second_order: tuple[int, int] | None = None) -> str:
    """A layout with its number of internal modes pinned (``f2m4``) or with damping (``f2d``).

    With the modes also numbers of slaved coordinates and of stress resultants (``f2m4s2e1``).
    """
    pinned = "" if modes is None else f"m{modes}"
    if second_order is not None:
        pinned += "s{}e{}".format(*second_order)
    return layout + pinned + "d" * damped
