"""Waiting for work of the extension module.

The work runs on a thread of its own, and the calling thread waits here, in Python: so an interrupt reaches it at once, and
`progress` is called from it and from no other thread.
"""

from __future__ import annotations

import atexit
import os
import select
import time
from typing import Any, Callable, Optional

from . import _core
from ._errors import Cancelled, UsageError
from ._values import shown

Progress = Callable[[str, float], Optional[bool]]

_POLL_MS = 50  # between calls of `progress`; interrupts do not wait for it
_STOP_SECONDS = 0.7  # after which cancelled work is left alone: it ends by itself, and its result is dropped
_CLOSE_MS = 30_000

os.register_at_fork(before=_core.before_fork, after_in_child=_core.after_fork_in_child)
atexit.register(_core.close_jobs, _CLOSE_MS)


def finish(job: _core.Job, progress: Progress | None = None) -> Any:
    """Waits for a job and returns its result.

    Parameters
    ----------
    progress : callable, optional
        Called as ``progress(stage, fraction)``; returning False cancels the work.

    Raises
    ------
    Cancelled
        `progress` returned False.
    KeyboardInterrupt
        The user interrupted; whatever `progress` raises.
    """
    waiting = select.poll()
    waiting.register(job.file, select.POLLIN)
    try:
        if progress is not None and not callable(progress):
            raise UsageError(f"progress: {shown(progress)} cannot be called; give a function of a stage and a fraction")
        while not waiting.poll(_POLL_MS):
            if progress is not None:
                _report(job, progress)
    except BaseException:
        job.cancel()
        _wait_for_end(waiting)
        raise
    return job.result()


def _report(job: _core.Job, progress: Progress) -> None:
    stage, fraction = job.progress
    if stage and progress(stage, fraction) is False:
        raise Cancelled("stopped by progress")


def _wait_for_end(waiting: select.poll) -> None:
    end = time.monotonic() + _STOP_SECONDS
    while time.monotonic() < end and not waiting.poll(_POLL_MS):
        pass
