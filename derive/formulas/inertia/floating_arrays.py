"""The arrays of option C: coordinates in axes of the body, their products, and constants."""

from sebody.contract.counts import MARGIN, MOST_SLAVED, axes_of
from sebody.contract.layout import Part
from sebody.derive.form import counts
from sebody.derive.form.arrays import Array, constant, scratch
from sebody.derive.form.counts import padded
from sebody.derive.form.statements import Let
from sebody.derive.form.whole import Truncated

PARTS = (
    Part("sizes", (3,), "slaved coordinates, resultants of second order, damped or not"),
    Part("turn", ("entries",), "axes of the body in the frame: columns of a rotation"),
    Part("axes", ("bound_free", "bound"), "boundary coordinates that determine the others",
         columns=True),
    Part("axes_back", ("bound", "bound_free"), "its transpose", columns=True),
    Part("order", ("free",), "where these and the modes are among themselves"),
    Part("c0", ("D",), "first moment of mass at rest, about the origin of the frame"),
    Part("J0", ("pairs",), "moments of inertia at rest"),
    Part("moment_columns", ("N", "lines"), "S1, g_k, h_kl + h_lk", columns=True),
    Part("moment_rows", ("lines", "N"), "its transpose", columns=True),
    Part("couplings", ("coupled", "N", "N"), "J2_kl, K_k^T; K_k^T and K_k of rates", packed=True),
    Part("Mz", (1, "N", "N"), "reduced mass with slaved coordinates", packed=True),
    Part("Cz", ("damped", "free", "free"), "reduced damping", packed=True),
    Part("followers", ("slaved", "free", "free"), "Q_b", packed=True),
    Part("lam", ("resultants",), "eigenvalues of the resultants"),
    Part("E", ("free", "resultants"), "their eigenvectors", columns=True),
    Part("stretched", ("stretching", "free", "free"), "Ghat_e, reduced stiffness",
         packed=True))
(sizes, turn, axes, axes_back, order, c0, J0, moment_columns, moment_rows, couplings, Mz, Cz,
 followers, lam, E, stretched) = map(constant, PARTS)
TRANSPOSES = (axes, axes_back), (axes_back, axes)

z, zd, zdd = map(scratch, ("z", "zd", "zdd"))       # that determine the others, and followers
unordered = scratch("unordered", 3)                 # the same before they are put in order
Zq, Zd, Za = (scratch(name, MOST_SLAVED) for name in ("Zq", "Zd", "Za"))    # Q_b times z, zd, zdd
PRODUCTS = 18       # with quadratic constants: those asked for, and what some are made from
products, more = scratch("products", PRODUCTS), scratch("more", PRODUCTS)
lines = tuple(map(scratch, ("line0", "line1", "line2")))            # integrals: linear parts
quadratic = tuple(map(scratch, ("product0", "product1", "product2")))   # and quadratic ones
by_moment_columns, by_products = map(scratch, ("by_moment_columns", "by_products"))
local, moved, squares = map(scratch, ("local", "moved", "squares"))

# stress resultants, and their forces
Gy = scratch("Gy", counts.n + MARGIN)
along, twice, by_E, by_Gy, of_E, of_Gy = map(scratch, (
    "along", "twice", "by_E", "by_Gy", "of_E", "of_Gy"))

# local tangents, and the factors they are made with
Lz, Lv, La = (scratch(name, counts.n + MARGIN) for name in ("Lz", "Lv", "La"))
ones, by_couplings, by_followers = map(scratch, ("ones", "by_couplings", "by_followers"))
scales = scratch("scales", PRODUCTS)        # the factors of each row


def counts_of_body(planar: bool) -> dict[Array, tuple[Let, ...]]:
    """Sizes that a body tells, and what follows from them: for the constants behind them."""
    motions = axes_of(planar)["motions"]
    free, N = counts.free, counts.N
    return {sizes: (
        Let((counts.slaved, counts.resultants, counts.damped),
            tuple(Truncated(sizes[k]) for k in range(3))),
        Let((free, counts.bound, counts.bound_free),
            (counts.n - motions, counts.FIRST_MODE, counts.FIRST_MODE - motions)),
        Let((N, counts.stretching), (free + counts.slaved, counts.resultants + 1)),
        Let((counts.hn, counts.hN, counts.deep), (padded(free), padded(N), padded(N + motions))))}
