"""Executors of the tasks of a sweep: threads here, processes here, the workers of a cluster."""

import re
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, ThreadPoolExecutor, wait
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from logging import CRITICAL, getLogger
from pathlib import Path
from typing import Any

from sebody.basics import inputs
from sebody.basics.errors import InputError, SebodyError
from sebody.explore.sweep.batches import Answer, Batch, run_task

AHEAD = 4               # tasks that wait for each worker: more would only fill the scheduler
RETRIES = 5             # of a task whose worker is lost
MOST_WORKERS = 1024     # processes of one machine
PATIENCE = 10           # seconds to find a scheduler, and its workers
LOGS = "distributed", "distributed.client"

Task = list[Batch]
Run = Callable[[Iterator[Task]], Iterator[Answer]]


@contextmanager
def threads(count: int) -> Iterator[Run]:
    """Threads of this process."""
    with ThreadPoolExecutor(count) as pool:
        def run(tasks: Iterator[Task]) -> Iterator[Answer]:
            waiting = set()
            try:
                for task in tasks:
                    waiting.add(pool.submit(run_task, task))
                    while len(waiting) >= AHEAD * count:
                        done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                        for one in done:
                            yield from one.result()
                while waiting:
                    done, waiting = wait(waiting, timeout=0.1, return_when=FIRST_COMPLETED)
                    for one in done:
                        yield from one.result()
            finally:
                for one in waiting:
                    one.cancel()
        yield run


@contextmanager
def cluster(address: str | None, workers: int | None) -> Iterator[Run]:
    """The workers of a scheduler of Dask, or new ones in processes of this machine.

    Parameters
    ----------
    address : str, optional
        Of the scheduler.
    workers : int, optional
        Number of processes, without an address.

    Raises
    ------
    InputError
        No Dask, no scheduler at the address, or workers with another version of this package.
    """
    if workers is not None:
        workers = inputs.integer(workers, "workers", least=1, most=MOST_WORKERS)
    if address is not None:
        if not re.search(r":\d{1,5}$", inputs.name(address, "address of a scheduler")):
            raise inputs.refusal("address of a scheduler", address, "give host and port, such as "
                                 "tcp://10.0.0.1:8786")
        if workers is not None:
            raise InputError("--cluster has workers of its own: leave out --workers")
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise InputError('--cluster and --workers need Dask: pip install "sebody[cluster]"'
                         ) from error
    own, levels = None, {log: log.level for log in map(getLogger, LOGS)}
    for log in levels:
        log.setLevel(CRITICAL + 1)  # Dask's own account of a scheduler that is not there is long
    try:
        if address is None:
            own = LocalCluster(n_workers=workers, threads_per_worker=1, processes=True,
                               dashboard_address=None)
        try:
            client = Client(own or address, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InputError(f"there is no scheduler at {address} ({error}): start one with "
                             "'dask scheduler', and workers with 'dask worker ADDRESS'") from error
        with client:
            _check_versions(client, address)
            yield lambda tasks: _on_workers(client, tasks)
    finally:
        if own is not None:
            own.close()
        for log, level in levels.items():
            log.setLevel(level)


def _check_versions(client: Any, address: str | None) -> None:
    if not client.scheduler_info(n_workers=-1)["workers"]:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            raise InputError(f"the scheduler at {address} has no workers after {PATIENCE} s: start "
                             "some with 'dask worker ADDRESS'") from error
    own = _version()
    for worker, version in client.run(_version).items():
        if version != own:
            raise InputError(f"worker {worker} of {address} has sebody {version}, this is {own}: "
                             "install one version everywhere")


@cache
def _version() -> str:
    """Version of the package and a hash of its files, also of a worker."""
    from sebody.basics.version import __version__

    package, content = Path(__file__).parents[2], sha256()
    for path in sorted(package.rglob("*.py")):
        content.update(str(path.relative_to(package)).encode() + path.read_bytes())
    return f"{__version__} (files {content.hexdigest()[:8]})"


def _on_workers(client: Any, tasks: Iterator[Task]) -> Iterator[Answer]:
    """Answers in the order in which they come; so many tasks are out at a time."""
    from distributed import as_completed
    from distributed.comm import CommClosedError

    def submit(task: Task) -> Any:
        return client.submit(run_task, task, pure=False, retries=RETRIES)

    most = AHEAD * max(1, len(client.scheduler_info(n_workers=-1)["workers"]))
    coming = as_completed([], loop=client.loop)
    out = 0
    try:
        for task in tasks:
            coming.add(submit(task))
            out += 1
            if out >= most:
                yield from next(coming).result()
                out -= 1
        for _ in range(out):
            yield from next(coming).result()
    except (CancelledError, CommClosedError, StopIteration) as error:
        raise SebodyError("the scheduler of the cluster was lost: runs that were done are kept in "
                          "the table; start it again and repeat the command to continue") from error
