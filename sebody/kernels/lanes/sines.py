"""Sine and cosine of eight angles at a time; with one angle they share most instructions.

The angle less the nearest multiple of pi/2, which is subtracted in three parts, by polynomials. So
numbers of a member are those of its own angle alone. They are within two units in the last place,
as those of the standard library, which makes one angle at a time, are within one.
"""

import math

from numba.extending import overload

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import (
    Lanes,
    chosen_in,
    every,
    number_of,
    rounded_up,
    where,
    with_number,
)
from sebody.contract.counts import MEMBERS

LARGEST = 1e6       # up to here multiples of the first two parts of pi/2 are exact
# pi/2 in parts of 33, 33 and 53 bits, and the coefficients of polynomials up to pi/4: those of
# fdlibm (Sun Microsystems, 1993)
PARTS = 1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624879595063154e-21
SINE = (-1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
        2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10)
COSINE = (4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
          -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11)


@compiled(forceinline=True)
def _sine_and_cosine(x):
    """Sine and cosine of the angle less a multiple of pi/2, and this multiple: 0, 1, 2 or 3."""
    n = rounded_up(x * (2.0 / math.pi) - 0.5)
    r = ((x - n * PARTS[0]) - n * PARTS[1]) - n * PARTS[2]
    z = r * r
    a, b, c, d, e, f = SINE
    sine = r + r * z * (a + z * (b + z * (c + z * (d + z * (e + z * f)))))
    a, b, c, d, e, f = COSINE
    half = 0.5 * z
    near = 1.0 - half
    cosine = near + (((1.0 - near) - half) + z * z * (
        a + z * (b + z * (c + z * (d + z * (e + z * f))))))
    return sine, cosine, n - 4.0 * rounded_up(0.25 * n - 0.75)


@compiled(forceinline=True)
def _sine(x):
    sine, cosine, multiple = _sine_and_cosine(x)
    found = where((multiple == 1.0) | (multiple == 3.0), cosine, sine)
    found = where(multiple >= 2.0, -found, found)
    small = abs(x) <= LARGEST
    return found if every(small) else _sine_of_large(x, found, small)


@compiled(forceinline=True)
def _cosine(x):
    sine, cosine, multiple = _sine_and_cosine(x)
    found = where((multiple == 1.0) | (multiple == 3.0), sine, cosine)
    found = where((multiple == 1.0) | (multiple == 2.0), -found, found)
    small = abs(x) <= LARGEST
    return found if every(small) else _cosine_of_large(x, found, small)


@compiled
def _sine_of_large(x, found, small):
    """The same with the standard library's numbers of large angles, and of what is no number."""
    for member in range(MEMBERS):
        if not chosen_in(small, member):
            found = with_number(found, member, math.sin(number_of(x, member)))
    return found


@compiled
def _cosine_of_large(x, found, small):
    """See `_sine_of_large`."""
    for member in range(MEMBERS):
        if not chosen_in(small, member):
            found = with_number(found, member, math.cos(number_of(x, member)))
    return found


@overload(math.sin, jit_options={"forceinline": True})
def _sin(x):
    return (lambda x: _sine(x)) if isinstance(x, Lanes) else None


@overload(math.cos, jit_options={"forceinline": True})
def _cos(x):
    return (lambda x: _cosine(x)) if isinstance(x, Lanes) else None
