"""Tapes in compiled code: evaluated, and followed forth and back for derivatives.

A tape is numbers that follow from one another. The first is one; then some are read, of a state,
and others computed by steps. `steps` begins with their count; then each has STEP numbers. Products
are FACTORS places of `factors` and one of `weights`. All are arrays or pointers.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.read_numbers import (
    ANGLE,
    CHOICE,
    COSINE,
    FACTORS,
    INVERSE,
    POSITIVE,
    ROOT,
    SINE,
    STEP,
    SUM,
)


@compiled
def _step(steps, s):
    """Function, place, first product and end of the products of a step."""
    k = 1 + STEP * s
    return steps[k], steps[k + 1], steps[k + 2], steps[k + 3]


@compiled
def play(steps, factors, weights, numbers):
    """Compute the numbers of a tape from those that are read."""
    for s in range(steps[0]):
        function, place, first, end = _step(steps, s)
        if function == ANGLE:
            y, x = factors[FACTORS * first], factors[FACTORS * (first + 1)]
            found = np.arctan2(numbers[y], numbers[x])
            turns = np.floor((numbers[place] - found) / (2.0 * np.pi) + 0.5)
            numbers[place] = found + 2.0 * np.pi * turns
            continue
        if function == CHOICE:
            best = chosen(factors, first, end, numbers)
            numbers[place] = numbers[factors[FACTORS * best + 1]]
            continue
        x = 0.0
        for i in range(first, end):
            product = weights[i]
            for j in range(FACTORS):
                product *= numbers[factors[FACTORS * i + j]]
            x += product
        if function == SUM:
            numbers[place] = x
        elif function == ROOT:
            numbers[place] = np.sqrt(max(x, 0.0))
        elif function == INVERSE:
            numbers[place] = 1.0 / x
        elif function == COSINE:
            numbers[place] = np.cos(x)
        elif function == SINE:
            numbers[place] = np.sin(x)
        elif function == POSITIVE:
            numbers[place] = 1.0 if x > 0.0 else 0.0


@compiled
def chosen(factors, first, end, numbers):
    """The product of a CHOICE with the largest comparison, the first such."""
    best = first
    for i in range(first + 1, end):
        if numbers[factors[FACTORS * i]] > numbers[factors[FACTORS * best]]:
            best = i
    return best


@compiled
def play_back(steps, factors, weights, numbers, bars):
    """Give bars of the numbers of a tape to those that they follow from, last ones first."""
    for s in range(steps[0] - 1, -1, -1):
        function, place, first, end = _step(steps, s)
        bar = bars[place]
        if bar == 0.0 or function == POSITIVE:
            continue
        if function == ANGLE:
            y, x = factors[FACTORS * first], factors[FACTORS * (first + 1)]
            square = numbers[x] * numbers[x] + numbers[y] * numbers[y]
            bars[y] += bar * numbers[x] / square
            bars[x] -= bar * numbers[y] / square
            continue
        if function == CHOICE:
            bars[factors[FACTORS * chosen(factors, first, end, numbers) + 1]] += bar
            continue
        bar *= _rate(function, numbers[place], factors, weights, numbers, first, end)
        for i in range(first, end):
            for j in range(FACTORS):
                if factors[FACTORS * i + j] > 0:
                    product = bar * weights[i]
                    for m in range(FACTORS):
                        if m != j:
                            product *= numbers[factors[FACTORS * i + m]]
                    bars[factors[FACTORS * i + j]] += product


@compiled
def play_along(steps, factors, weights, numbers, rates):
    """Rates of the numbers of a tape from those of the numbers that are read."""
    for s in range(steps[0]):
        function, place, first, end = _step(steps, s)
        rate = 0.0
        if function == ANGLE:
            y, x = factors[FACTORS * first], factors[FACTORS * (first + 1)]
            square = numbers[x] * numbers[x] + numbers[y] * numbers[y]
            rate = (numbers[x] * rates[y] - numbers[y] * rates[x]) / square
        elif function == CHOICE:
            rate = rates[factors[FACTORS * chosen(factors, first, end, numbers) + 1]]
        elif function != POSITIVE:
            for i in range(first, end):
                for j in range(FACTORS):
                    product = weights[i] * rates[factors[FACTORS * i + j]]
                    for m in range(FACTORS):
                        if m != j:
                            product *= numbers[factors[FACTORS * i + m]]
                    rate += product
            rate *= _rate(function, numbers[place], factors, weights, numbers, first, end)
        rates[place] = rate


@compiled
def _rate(function, value, factors, weights, numbers, first, end):
    """Derivative of the function of a step by its sum of products."""
    if function == ROOT:
        return 0.5 / value
    if function == INVERSE:
        return -value * value
    if function == COSINE or function == SINE:
        x = 0.0
        for i in range(first, end):
            product = weights[i]
            for j in range(FACTORS):
                product *= numbers[factors[FACTORS * i + j]]
            x += product
        return -np.sin(x) if function == COSINE else np.cos(x)
    return 1.0
