"""Order of the bodies in the elimination: minimum degree, so that the factors fill in little.

DOF blocks that bodies share, or that joints and springs couple, are the items of a graph; those of
one body alone are left out. The elimination of an item couples all its neighbours; the next one is
always an item with the fewest unknowns around it (Tinney and Walker, Proc. IEEE 55: 1801-1809,
1967). The bodies it belongs to come next in the order, for an item is eliminated with the last of
its bodies.

Of several such items the first is next; in large models the one whose surroundings have not changed
for longest. So a long chain is eliminated from both ends to its middle, which costs the same, in
two parts that do not wait for each other (`independent_parts`).
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from functools import lru_cache
from heapq import heapify, heappop, heappush
from typing import NamedTuple

REMEMBERED = 32         # orders
LARGE = 64              # bodies from which on threads may share an elimination


class Coupling(NamedTuple):
    """Couplings of DOF blocks: the equations of a joint, a spring."""

    keys: Iterable[Hashable]        # of the DOF blocks
    multipliers: int = 0
    awaited: Iterable[Hashable] = ()    # DOF blocks that are eliminated before the multipliers


def order_of_least_fill(bodies: Sequence[Mapping[Hashable, int]],
                        couplings: Iterable[Coupling]) -> list[int]:
    """Bodies in an order of little fill; of equally good ones the first comes first.

    Parameters
    ----------
    bodies : sequence of mappings
        Keys of the unknown DOF blocks of every body, and their numbers of coordinates.
    couplings : iterable of Coupling
        Of the same keys.

    Returns
    -------
    list of int
        A postorder of the elimination tree: bodies that are coupled are close to each other.
    """
    number: dict[Hashable, int] = {}    # keys differ from model to model, their numbers do not
    for body in bodies:
        for key in body:
            number.setdefault(key, len(number))
    return list(_order(
        tuple([tuple([(number[key], size) for key, size in body.items()]) for body in bodies]),
        tuple([(tuple([number[key] for key in one.keys]), one.multipliers,
                tuple([number[key] for key in one.awaited])) for one in couplings])))


@lru_cache(maxsize=REMEMBERED)
def _order(bodies: tuple, couplings: tuple) -> tuple[int, ...]:
    """The same of hashable bodies and couplings: many runs are of the same few models."""
    graph = _Graph(len(bodies))
    _fill(graph, [dict(body) for body in bodies], [Coupling(*one) for one in couplings])
    current = [graph.degree(item) for item in graph.choices]
    queue = [(degree, 0, item) for item, degree in enumerate(current)]
    in_turn = len(bodies) >= LARGE
    heapify(queue)
    while queue:
        degree, _, item = heappop(queue)
        if current[item] == degree and graph.owners[item]:
            for other in graph.eliminate(item):
                if other < len(current):
                    current[other] = graph.degree(other)
                    heappush(queue, (current[other], in_turn * len(graph.steps), other))
    return tuple(graph.postorder())


class _Graph:
    """The items that are left, what surrounds them, and the elimination so far."""

    def __init__(self, bodies: int) -> None:
        self.size: list[int] = []           # unknowns of every item
        self.owners: list[set[int]] = []    # bodies of every item that are not in the order yet
        self.around: list[set[int]] = []    # items next to every item, itself included
        self.items_of: list[list[int]] = [[] for _ in range(bodies)]
        self.choices = range(0)             # items that may be chosen, multipliers may not
        self.steps: list[tuple[list[int], set[int]]] = []       # bodies, and items left around them
        self.step_of: dict[int, int] = {}   # item -> step in which it is eliminated

    def add(self, size: int, owners: Iterable[int]) -> int:
        """Add an item; returns its number."""
        self.size.append(size)
        self.owners.append(set(owners))
        self.around.append(set())
        for body in self.owners[-1]:
            self.items_of[body].append(len(self.size) - 1)
        return len(self.size) - 1

    def degree(self, item: int) -> int:
        """Unknowns around an item and all items that are eliminated with it."""
        owners, around = self.owners, self.around
        bodies = owners[item]
        gone = [other for other in around[item] if owners[other] <= bodies]
        left = set().union(*[around[other] for other in gone]).difference(gone)
        return sum(map(self.size.__getitem__, left))

    def eliminate(self, item: int) -> set[int]:
        """Put the bodies of an item next in the order; returns the items left around them."""
        bodies, around = sorted(self.owners[item]), self.around
        gone = []
        for body in bodies:
            for other in self.items_of[body]:
                self.owners[other].discard(body)
                if not self.owners[other]:
                    gone.append(other)
                    self.step_of[other] = len(self.steps)
        rest = set().union(*[around[other] for other in gone]).difference(gone)
        for other in rest:
            around[other] |= rest
            around[other].difference_update(gone)
        self.steps.append((bodies, rest))
        return rest

    def postorder(self) -> list[int]:
        """The bodies, those of every branch of the elimination tree in one piece."""
        children: list[list[int]] = [[] for _ in range(len(self.steps) + 1)]
        for step, (_, rest) in enumerate(self.steps):
            children[min((self.step_of[item] for item in rest), default=-1)].append(step)
        order, stack = [], children[-1]
        while stack:            # backwards: parents before children
            step = stack.pop()
            order.extend(self.steps[step][0][::-1])
            stack.extend(children[step])
        return order[::-1] + [body for body, items in enumerate(self.items_of) if not items]


def _fill(graph: _Graph, bodies: Sequence[Mapping[int, int]],
          couplings: Iterable[Coupling]) -> None:
    """Add the items: DOF blocks in the same bodies and couplings are one, as are multipliers."""
    sizes: dict[int, int] = {}
    member: dict[int, list[int]] = {}       # numbers of bodies, then of couplings, of a DOF block
    for number, body in enumerate(bodies):
        sizes.update(body)
        for key in body:
            member.setdefault(key, []).append(number)
    constraints = []
    number = count = len(bodies)
    for coupling in couplings:
        if coupling.multipliers:
            constraints.append((number, coupling))
        for key in coupling.keys:
            member[key].append(number)
        number += 1
    inside: list[list[int]] = [[] for _ in range(number)]
    alike: dict[tuple[int, ...], int] = {}
    for key, numbers in member.items():
        if len(numbers) == 1:
            continue
        item = alike.get(tuple(numbers))
        if item is not None:
            graph.size[item] += sizes[key]
            continue
        item = alike[tuple(numbers)] = graph.add(sizes[key], [k for k in numbers if k < count])
        for number in numbers:
            inside[number].append(item)
    graph.choices = range(len(graph.size))
    for number, coupling in constraints:
        owners = [k for key in coupling.awaited for k in member[key] if k < count]
        inside[number].append(graph.add(coupling.multipliers, owners))
    for items in inside:
        for item in items:
            graph.around[item].update(items)
