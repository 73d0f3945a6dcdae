"""Scalar laws of friction and contact: forces along measures, of these and of kept numbers.

A measure has a rate w and an increment of the step; a law gives the force along it. Laws are
chains of stages, each of which reads earlier ones only, so that their derivatives are short.
"""

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp

from sebody.derive.formulas.elements import Stage, choose, kept

TINY = sp.Float(1e-300)     # under roots and powers, whose derivatives must exist at zero
ROUND = sp.Float(1e-6)      # of the reference speed: where a smooth law is rounded off


class Law(NamedTuple):
    """Forces as stages of symbols; what is kept of them."""

    forces: tuple[sp.Symbol, ...]       # against the measures: residuals
    stages: tuple[Stage, ...]
    memory: tuple[tuple[str, sp.Expr], ...]
    stored: sp.Expr = sp.S.Zero         # energy that comes back
    elastic: sp.Expr = sp.S.Zero        # force of this energy, of the only measure


class Bristle(NamedTuple):
    """Constants of dry friction."""

    stiffness: sp.Symbol
    damping: sp.Symbol
    dynamic: sp.Symbol      # coefficient of sliding
    static: sp.Symbol       # coefficient of break-away
    speed: sp.Symbol        # of the smooth law; 0 for bristles


def length(vector: Sequence[sp.Expr]) -> sp.Expr:
    """Length of a vector, with a derivative at zero."""
    return sp.sqrt(sum(entry**2 for entry in vector) + TINY)


def friction(increments: Sequence[sp.Expr], rates: Sequence[sp.Expr],
             normal: sp.Expr | tuple[sp.Expr, sp.Expr], b: Bristle,
             along: Sequence[Sequence[sp.Expr]] | None = None) -> Law:
    """Bristles with a return map: the stop operator, with memory of break-away.

    ::

        z~ = z_old + increment,  t = k z~ + c w
        sticks, F = t, where |t| <= mu N, with the static mu unless it slid in the last step
        slides otherwise: F = mu_d N t/|t|, and z is shortened to mu_d N/k

    So a cycle of N makes no energy, and a load below the limit never drifts. With a reference speed
    v the law is a smooth function of ``x = |w|/v`` instead (Brown and McPhee 2016, eq. 4):
    ``F = N w/|w| (mu_d tanh(4 x) + (mu_s - mu_d) x/(x^2/4 + 3/4)^2)``.

    Parameters
    ----------
    normal : expression
        Normal force N, times the radius where measures are angles. Of one measure it may be a pair,
        of positive and of negative forces.
    along : (n, n), optional
        Projection to the tangent plane, in which z must lie.
    """
    n = len(rates)
    names = [f"_{k + 1}" for k in range(n)] if n > 1 else [""]
    begun, slid = kept("begun"), kept("slid")
    bent = [kept("bent" + k) + begun * d for k, d in zip(names, increments, strict=True)]
    if along is not None:
        bent = [sum(row[j] * bent[j] for j in range(n)) for row in along]
    z, trial, force = (sp.symbols([f"{word}{k}" for k in names])
                       for word in ("z", "trial", "friction"))
    size, dynamic, static = sp.symbols("trial_size dynamic_limit static_limit")
    bent_size, slips, speed, drag = sp.symbols("bent_size slips slip_speed drag")
    held = normal
    if isinstance(normal, tuple):
        held, normal = (choose(one, *normal) for one in (trial[0], rates[0]))
    limits = ((dynamic, b.dynamic * held),
              (static, choose(slid - sp.Rational(1, 2), b.dynamic, b.static) * held))
    early, late = ((), (limits,)) if held is not normal else (limits, ())
    x = speed / b.speed
    smooth = normal * (b.dynamic * sp.tanh(4 * x) + (b.static - b.dynamic) * x
                       / (x**2 / 4 + sp.Rational(3, 4))**2) / speed
    stages = (
        (*zip(z, bent, strict=True), *early),
        (*((t, b.stiffness * zk + b.damping * w) for t, zk, w in zip(trial, z, rates, strict=True)),
         (bent_size, length(z)),
         (speed, sp.sqrt(sum(w**2 for w in rates) + (ROUND * b.speed)**2 + TINY))),
        *late,
        ((size, length(trial)), (drag, choose(b.speed, smooth, sp.Float(0.0)))),
        ((slips, choose(b.speed, sp.Float(1.0), choose(size - static, sp.Float(1.0),
                                                      sp.Float(0.0)))),),
        tuple((f, choose(b.speed, drag * w, choose(size - static, dynamic / size * t, t)))
              for f, t, w in zip(force, trial, rates, strict=True)))
    # what a slipping bristle keeps; a smooth law has none
    kept_share = choose(b.speed, sp.Float(0.0), choose(
        slips - sp.Rational(1, 2), choose(b.stiffness * bent_size - dynamic,
                                          dynamic / (b.stiffness * bent_size), sp.Float(1.0)),
        sp.Float(1.0)))
    memory = [("bent" + k, kept_share * zk) for k, zk in zip(names, z, strict=True)]
    return Law(tuple(force), stages, (*memory, ("slid", slips), ("begun", sp.Float(1.0))))


def impact(depth: sp.Expr, rate: sp.Expr, stiffness: sp.Symbol, exponent: sp.Symbol,
           damping: sp.Symbol, slow: sp.Symbol, play: sp.Expr | None = None) -> Law:
    """Hunt and Crossley's contact law, ``F = k d^n (1 + c d')`` where d > 0, and never a pull.

    It keeps the rate and the speed of the impact, by which the time loop judges the length of a
    step: with longer steps the scheme makes energy (restitution 1.90 where 0.748 is right). Speeds
    up to `slow` are none.

    Parameters
    ----------
    play : expression, optional
        Of what presses on either side of it. Where it is zero the depth never is below zero, and at
        a depth of zero there is the stiffness of both sides.
    """
    inside, touches = sp.symbols("depth touches")
    pressed = choose(depth, depth, TINY)
    if play is not None:
        pressed = choose(play, pressed, depth + TINY)
    elastic, factor, push = sp.symbols("elastic factor push")
    stages = (((touches, choose(depth, sp.Float(1.0), sp.Float(0.0))),
               (inside, pressed)),
              ((elastic, stiffness * inside**exponent), (factor, 1 + damping * rate)),
              ((push, choose(factor, elastic * factor, sp.Float(0.0))),))
    largest = _largest(_largest(_size(rate), _size(kept("rate"))), kept("impact"))
    speed = choose(touches - sp.Rational(1, 2), choose(largest - slow, largest, sp.Float(0.0)),
                   sp.Float(0.0))
    return Law((push,), stages, (("rate", rate), ("impact", speed), ("depth", depth)),
               stiffness * inside**(exponent + 1) / (exponent + 1), elastic)


def _size(x: sp.Expr) -> sp.Expr:
    return choose(x, x, -x)


def _largest(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return choose(a - b, a, b)
