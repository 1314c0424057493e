"""Runs what is missing, on all cores or on a cluster."""

import multiprocessing
import os
import signal
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from functools import partial

from tqdm import tqdm

from .execute import execute

PATIENCE_S = 10  # for the scheduler's answer


class ClusterMissing(Exception):
    """No cluster can be had; the message says what to do."""


def complete(runs, sources, store, executor, quiet=False, work=execute):
    """Execute the runs that are not in the store, by `work`; returns {run: entry} of all. Those whose worker failed raise, after the rest is stored."""
    waiting = {}
    for run in runs:
        if run.key(sources) not in store.done:
            waiting[executor.submit(partial(_execute, work=work), run, sources)] = run
    failed = None
    with tqdm(total=len(runs), initial=len(runs) - len(waiting), desc="runs", unit="run", disable=quiet or None) as bar:
        for future in as_completed(waiting):
            try:
                store.add(future.result())
            except Exception as error:  # the rest of the campaign is not to be lost
                failed = failed or error
            bar.update()
    if failed:
        raise failed
    return {run: store.done[run.key(sources)] for run in runs}


_over = False  # in a worker: what still waits for it is not begun


def _begin():
    """In a new worker: Ctrl-C is for the process that hands out the runs; its SIGTERM ends a run, which clears up behind itself."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)


def _end(*_):
    global _over
    _over = True
    raise KeyboardInterrupt


def _execute(run, sources, work=execute):
    entry = None if _over else work(run, sources)
    if _over:  # a run that was broken off is no result
        raise KeyboardInterrupt
    return entry


def _break_off():
    """End the runs that are being driven; a second Ctrl-C does not wait for them."""
    print("\nending the runs that are at work; Ctrl-C once more leaves at once", file=sys.stderr, flush=True)
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    for worker in multiprocessing.active_children():
        worker.terminate()


@contextmanager
def executor(cluster=None, workers=None):
    """An executor of concurrent.futures: processes of this machine, or with the address of its scheduler a Dask cluster."""
    if cluster is None:
        with ProcessPoolExecutor(workers or os.cpu_count(), initializer=_begin) as pool:
            try:
                yield pool
            except BaseException as error:
                if isinstance(error, KeyboardInterrupt):
                    _break_off()
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        return
    try:
        from distributed import Client
    except ImportError:
        raise ClusterMissing("--cluster needs dask.distributed, which is not installed: pip install -e '.[cluster]'") from None
    try:
        client = Client(cluster, timeout=PATIENCE_S)
    except (OSError, ValueError) as error:
        raise ClusterMissing(
            f"no Dask scheduler answers at {cluster} ({type(error).__name__}): start one with `dask scheduler`, workers with `dask worker {cluster}`"
        ) from None
    with client, client.get_executor(pure=False) as pool:
        yield pool
