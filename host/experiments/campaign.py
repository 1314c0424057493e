"""Runs what is missing, on all cores or on a cluster."""

import os
import signal
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager

from tqdm import tqdm

from .execute import execute

PATIENCE_S = 10  # for the scheduler's answer


class ClusterMissing(Exception):
    """No cluster can be had; the message says what to do."""


def complete(runs, sources, store, executor, quiet=False):
    """Execute the runs that are not in the store; returns {run: entry} of all. Those whose worker failed raise, after the rest is stored."""
    waiting = {}
    for run in runs:
        if run.key(sources) not in store.done:
            waiting[executor.submit(execute, run, sources)] = run
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


@contextmanager
def executor(cluster=None, workers=None):
    """An executor of concurrent.futures: processes of this machine, or with the address of its scheduler a Dask cluster."""
    if cluster is None:
        # Ctrl-C is for this process; the workers end the runs they are at.
        with ProcessPoolExecutor(workers or os.cpu_count(), initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN)) as pool:
            try:
                yield pool
            except BaseException:
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
