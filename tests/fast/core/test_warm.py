"""Processes that compile end with the one that started them."""

from __future__ import annotations

import subprocess
import sys

import psutil

from waiting import wait_for

STARTED = """
import multiprocessing, os, time
from concurrent.futures import ProcessPoolExecutor
from vibrafeed.core.system import end_with_parent
pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), end_with_parent)
print(pool.submit(os.getpid).result(), flush=True)
time.sleep(600)
"""


def test_a_process_of_the_pool_ends_with_a_parent_that_is_killed():
    with subprocess.Popen([sys.executable, "-c", STARTED], stdout=subprocess.PIPE) as parent:
        child = psutil.Process(int(parent.stdout.readline()))
        parent.kill()
    wait_for(lambda: not child.is_running() or child.status() == psutil.STATUS_ZOMBIE)
