"""Runs a program for so many seconds of its own processor time: a busy machine that keeps it waiting is no reason to give up."""

import signal
import subprocess

_WAITS = 20  # times the limit, by the wall clock: then it waits for something that never comes


def run(command, seconds, **options):
    """subprocess.run of a command (list of texts). subprocess.TimeoutExpired after `seconds` (whole) of its processor time."""
    done = subprocess.run(["sh", "-c", f'ulimit -t {seconds}; exec "$@"', "sh", *command], timeout=_WAITS * seconds, **options)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise subprocess.TimeoutExpired(command, seconds, done.stdout, done.stderr)
    return done
