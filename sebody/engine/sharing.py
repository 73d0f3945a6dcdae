"""The parts of a step that threads share: forces, matrices, factors, solutions.

Every number is computed from the same numbers in the same order as by one thread, so results do not
depend on threads at all: elements are evaluated in the same groups, and unknowns belong to parts of
the elimination that do not wait for each other (`assembly.independent_parts`), or to the rest,
which the thread of the loop does on its own.
"""

from sebody.compiler.decorators import compiled
from sebody.contract.layout import OK, RESIDUAL, TANGENT
from sebody.engine import elimination
from sebody.engine.evaluate import (
    SHARE,
    find_moved,
    limit_of_moved,
    run_found,
    run_part,
    set_gravity,
)
from sebody.engine.mailbox import (
    CALL,
    TASK,
    address_of,
    finish,
    load,
    post,
    take,
    wait_a_little,
    wait_for_all,
)
from sebody.engine.matrix import sum_columns
from sebody.engine.state import (
    EVALUATED,
    HELP,
    KEPT,
    RENEWED,
    SHARE_BACK,
    SHARE_FACTORS,
    SHARE_MOVED,
    SHARE_SOLUTION,
    SHARE_SUM,
)
from sebody.kernels.abi import at, pointer_to

LAST_TRIES = 20000      # looks for work before a helper leaves


@compiled
def share(system, state, task, thread):
    """Do a task together with the helpers: thread 0 is that of the loop.

    Or help, with the task HELP plus the number of the call that the helper belongs to.

    Returns the status of kernels; of SHARE_FACTORS not OK at a small pivot; of helpers, whether
    their call has ended. A helper returns if there was no work for long.
    """
    if task >= HELP:
        return _serve(system, state, task - HELP, thread)
    status = _do_together(system, state, task)
    rest, across = system.part_blocks[system.part_blocks.size - 1], system.block_diagonal.size
    condensed = state.control.condensed == 1
    if task == SHARE_SUM:
        sum_columns(system, state, rest, across, system.part_blocks.size - 1, condensed,
                    pointer_to(state.rotated_matrix))
    elif task == SHARE_FACTORS and status == OK:
        return 0 if elimination.eliminate_columns(rest, across, system, state, condensed,
                                                  pointer_to(state.column)) else 1
    elif task == SHARE_SOLUTION:
        elimination.solve_rest(system, state)
        _do_together(system, state, SHARE_BACK)
    return status


@compiled
def _do_together(system, state, task):
    """Post the pieces of a task, do as many as are left, and wait for the others."""
    mail = pointer_to(system.shared.mail)
    count = system.part_blocks.size - 1
    if task <= SHARE_MOVED:
        set_gravity(system, state)
        count = 0
        for b in range(system.first_joint[0] if task == RENEWED else system.address.size):
            count += (system.count[b] + SHARE - 1) // SHARE
    owner = address_of(pointer_to(state.matrix))
    call = load(at(mail, CALL))
    post(mail, owner, task, count)
    piece = take(mail, owner, call)
    while piece >= 0:
        finish(mail, piece, _do(system, state, task, piece, 0))
        piece = take(mail, owner, call)
    return wait_for_all(mail)


@compiled
def _serve(system, state, call, thread):
    """Do pieces of what the loop posts, not of what is posted on another state meanwhile."""
    mail, owner = pointer_to(system.shared.mail), address_of(pointer_to(state.matrix))
    tries = 0
    while tries < LAST_TRIES and load(at(mail, CALL)) == call:
        piece = take(mail, owner, call)
        if piece >= 0:
            finish(mail, piece, _do(system, state, mail[TASK], piece, thread))
            tries = 0
        else:
            wait_a_little(mail, tries)
            tries += 1
    return 0 if load(at(mail, CALL)) == call else 1


@compiled
def _do(system, state, task, piece, thread):
    """One piece of a task; returns its status."""
    if task <= SHARE_MOVED:
        return _evaluate(system, state, task, piece, thread)
    first, end = system.part_blocks[piece], system.part_blocks[piece + 1]
    condensed = state.control.condensed == 1
    if task == SHARE_SUM:
        sum_columns(system, state, first, end, piece, condensed, at(
            pointer_to(system.shared.rotated), thread * system.shared.rotated.shape[1]))
    elif task == SHARE_FACTORS:
        column = at(pointer_to(system.shared.columns),
                    thread * system.shared.columns.shape[1])
        if not elimination.eliminate_columns(first, end, system, state, condensed, column):
            return 1
    elif task == SHARE_SOLUTION:
        elimination.begin_part(system, state, first, end)
    else:
        elimination.end_part(system, state, first, end)
    return 0


@compiled
def _evaluate(system, state, task, piece, thread):
    """Evaluate a share of a batch of elements."""
    b = before = 0
    shares = (system.count[0] + SHARE - 1) // SHARE
    while piece >= shares:
        piece -= shares
        before += system.count[b]
        b += 1
        shares = (system.count[b] + SHARE - 1) // SHARE
    first = SHARE * piece
    count = min(SHARE, system.count[b] - first)
    work = at(pointer_to(system.shared.work), thread * system.shared.work.shape[1])
    if task == SHARE_MOVED:
        find_moved(system, state, b, first, count, before, limit_of_moved(state))
        return run_found(system, state, b, first, count, before, work)
    matrices = task >= EVALUATED or (task != KEPT and b >= system.first_joint[0])
    return run_part(TANGENT if matrices else RESIDUAL, b, first, count, system, state, work)
