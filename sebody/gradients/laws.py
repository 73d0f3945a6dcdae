"""Laws of friction, contacts and stops, which keep numbers from step to step, along a run.

What they keep is carried by the recursions as the motion is: a step takes the numbers m of the one
before to m', and the residual depends on m. Kernels of products (`derive/kernels/law_products.py`)
give both with the motion; here is where the numbers of all laws stand, one after the other.

Derivatives by parameters are those of the branch that a law has taken. Differences of its force
would be none, where a step is so near to the end of its branch that another value leads to the
next. So in a model with another value of a parameter, laws have the forces that their products
give for the change of constants, and of motion that follows the parameter.
"""

from collections.abc import Iterable
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.compiler.decorators import compiled
from sebody.contract.layout import (
    ALONG,
    AT_CONSTANTS,
    AT_FRAME,
    OK,
    PREPARE,
    RECORD_T,
    RESIDUAL,
    Row,
)
from sebody.engine.evaluate import run_kernels, sum_forces
from sebody.engine.system import System
from sebody.gradients.element_products import ROWS, run_element
from sebody.gradients.history import History
from sebody.gradients.recorded_states import put_state
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.loader import element_kernel
from sebody.model.parts import Element
from sebody.runs.simulation import Simulation

EQUAL = 1e-9                # of coefficients that are the same
COUNTED = "angle"           # what is kept to count turns, no force depends on it else
# of a law: where its scratch memory begins, and its numbers in `State.frames`; how many it keeps,
# and which of all laws' numbers is its first; increments of rotations it reads, and where the first
# of these is among `System.g_unknown`; number of its constants, and the first of them; its first
# force, how many it has, and its batch
(WORK, PLACE, COUNT, FIRST, TURNS, AT_TURNS, CONSTANTS, CONSTANT, FORCE, WIDTH,
 BATCH) = range(11)


def keeps(kind: str) -> bool:
    """Tell whether forces of a kind of element depend on numbers that it keeps."""
    return _are_of_a_law(element_kernel(kind).MEMORY)


def _are_of_a_law(memory: Iterable[str]) -> bool:
    return not all(name.startswith(COUNTED) for name in memory)


def remembering(run: Simulation) -> list[Element]:
    """Elements of laws."""
    return [one for one in run.numbering.memories if one.law is None and keeps(one.kind)]


def refuse_break_away(run: Simulation, history: History) -> None:
    """Refuse runs in which friction breaks away from a static limit above that of sliding.

    Its force jumps then, in a step whose number does not change with a parameter, while the time of
    the jump does.

    Raises
    ------
    InputError
    """
    rows = history.rows[2 if history.past is None else 1:]      # the first step begins from rest
    parts = run.state.recorded_parts
    for one in remembering(run):
        names = element_kernel(one.kind).MEMORY
        if "slid" not in names or one.number("speed") > 0.0 or not (
                one.number("static") > (1.0 + EQUAL) * one.number("coefficient")):
            continue
        place = run.numbering.memories[one][names.index("slid")]
        old, new = (rows[:, parts[name].start + place] for name in ("frames_old", "frames"))
        for row in rows[(old < 0.5) & (new > 0.5)]:
            raise InputError(
                f"{one.name!r} breaks away at t = {row[RECORD_T]:.6g} from its static coefficient "
                f"{one.number('static'):g} to {one.number('coefficient'):g}: the force jumps at a "
                "time that depends on the parameters, which steps do not show: give both the same "
                "value, or speed= for the smooth law, or use an Ensemble with values on both sides")


def places_of(system: System, modules: list[ModuleType | None], at_work: NDArray) -> NDArray:
    """Rows of all laws, (laws, 11); modules of products are those of the batches."""
    found, element, first = [], 0, 0
    for b, module in enumerate(modules):
        memory = getattr(module, "MEMORY", ())
        for k in range(int(system.count[b])):
            if module is not None and _are_of_a_law(memory):
                width, turns = int(system.width[b]), 3 * module.N_ROTATIONS
                index = int(system.at_index[b]) + k * int(system.stride[b])
                force = int(system.at_g[b]) + k * width
                numbers = Row("law", module.CONSTANTS).size({})
                found.append([at_work[element], system.index[index + AT_FRAME], len(memory), first,
                              turns, force + module.ROTATIONS, numbers,
                              system.index[index + AT_CONSTANTS], force, width, b])
                first += len(memory)
            element += 1
    return np.array(found, dtype=np.int64).reshape(-1, 11)


@compiled
def give(system, products, back):
    """Changes of kept numbers and increments to the laws, or weights of the new numbers."""
    work, laws = products.work, products.laws
    for j in range(laws.shape[0]):
        at, count, first = laws[j, WORK], laws[j, COUNT], laws[j, FIRST]
        for i in range(count):
            work[at + i] = products.kept[0, first + i]
            work[at + count + i] = products.kept[1, first + i]
        if not back:
            for i in range(laws[j, TURNS]):
                work[at + 2 * count + i] = products.motion[3, system.g_unknown[
                    laws[j, AT_TURNS] + i]]


@compiled
def take(system, products, back):
    """Changes of the new numbers, or bars of the old ones and of increments."""
    work, laws = products.work, products.laws
    for j in range(laws.shape[0]):
        at, count, first = laws[j, WORK], laws[j, COUNT], laws[j, FIRST]
        for i in range(count):
            if back:
                products.kept[0, first + i] = work[at + i]
            else:
                products.kept[1, first + i] = work[at + count + i]
        if back:
            for i in range(laws[j, TURNS]):
                products.motion[3, system.g_unknown[laws[j, AT_TURNS] + i]] += work[
                    at + 2 * count + i]


@compiled
def _run(task, j, system, state, products):
    """One law."""
    laws = products.laws
    b = laws[j, BATCH]
    k = (laws[j, FORCE] - system.at_g[b]) // laws[j, WIDTH]
    return run_element(task, b, k, laws[j, WORK], system, state, products)


@compiled
def _change(j, system, state, made, other, products):
    """Give a law what another model changes: of its motion, constants and kept numbers."""
    laws, work, vectors = products.laws, products.work, products.vectors
    first, width, at_work, count = (laws[j, FORCE], laws[j, WIDTH], laws[j, WORK], laws[j, COUNT])
    for i in range(width):
        x = system.g_unknown[first + i]
        vectors[ROWS * first + width + i] = other.q[x] - state.q[x]
        vectors[ROWS * first + 2 * width + i] = other.v[x] - state.v[x]
        vectors[ROWS * first + 3 * width + i] = other.a[x] - state.a[x]
    for i in range(count):
        work[at_work + i] = (other.frames_old[laws[j, PLACE] + i]
                             - state.frames_old[laws[j, PLACE] + i])
    for i in range(0, laws[j, TURNS], 3):
        at_turn = laws[j, AT_TURNS] + i
        x = system.g_unknown[at_turn]
        for r in range(system.rotation_at.size):
            if system.rotation_at[r] != x:
                continue
            R, S = at(pointer_to(state.R), 9 * r), at(pointer_to(other.R), 9 * r)
            for c in range(3):          # of R^T S the part that is a rotation vector, if small
                p, o = (c + 1) % 3, (c + 2) % 3
                turn = 0.0
                for k in range(3):
                    turn += 0.5 * (R[3 * k + o] * S[3 * k + p] - R[3 * k + p] * S[3 * k + o])
                vectors[ROWS * first + width + at_turn - first + c] = turn
                work[at_work + 2 * count + i + c] = other.q[x + c] - state.q[x + c]
    constants = at_work + 2 * count + laws[j, TURNS]
    for i in range(laws[j, CONSTANTS]):
        place = laws[j, CONSTANT] + i
        work[constants + i] = made.constants[place] - system.constants[place]


@compiled
def in_changed(system, state, products, made, other, rows, now, ends, besides, found):
    """Let laws of another model have the forces that its change gives them in held states.

    `rows` are states of the run, `now` those of the other model, (events, size); `found`
    (events, n + k) are its residuals, and what its laws keep.
    """
    laws = products.laws
    free = found.shape[1] - products.kept.shape[1]
    for e in range(rows.shape[0]):
        for i in range(state.now.size):
            other.now[i] = now[e, i]
        put_state(system, state, rows[e], ends[e], besides[e])
        before = -1
        for j in range(laws.shape[0]):
            if laws[j, BATCH] != before:
                before = laws[j, BATCH]
                status = run_kernels(RESIDUAL, before, before + 1, made, other)
                if status != OK:
                    return status
        for j in range(laws.shape[0]):
            status = _run(PREPARE, j, system, state, products)
            if status != OK:
                return status
            _change(j, system, state, made, other, products)
            status = _run(ALONG, j, system, state, products)
            for i in range(laws[j, CONSTANTS]):
                products.work[laws[j, WORK] + 2 * laws[j, COUNT] + laws[j, TURNS] + i] = 0.0
            for i in range(laws[j, COUNT]):
                found[e, free + laws[j, FIRST] + i] = (
                    state.frames[laws[j, PLACE] + i]
                    + products.work[laws[j, WORK] + laws[j, COUNT] + i])
            for i in range(laws[j, WIDTH]):
                k = laws[j, FORCE] + i
                state.g[k] += products.vectors[ROWS * laws[j, FORCE] + i] - other.g[k]
        for i in range(other.g.size):
            other.g[i] = 0.0
        for j in range(laws.shape[0]):
            for k in range(laws[j, FORCE], laws[j, FORCE] + laws[j, WIDTH]):
                other.g[k] = state.g[k]
        sum_forces(made, other, other.residual)
        for i in range(free):
            found[e, i] += other.residual[i]
    return OK
