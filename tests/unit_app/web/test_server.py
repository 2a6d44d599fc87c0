"""How the server's process is set up."""

import subprocess
import sys

import pytest

# Threads of the pool make and free arrays, as replies do; a page that is taken anew is a fault.
FAULTS = """
import resource, threading
import numpy as np
from app.web.server import keep_memory

keep_memory()

def work(times):
    for _ in range(times):
        [np.ones(100_000) for _ in range(20)]

def faults(times):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    thread = threading.Thread(target=work, args=(times,))
    thread.start()
    thread.join()
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

faults(100)
print(sum(faults(100) for _ in range(3)))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the allocator of glibc")
def test_memory_of_one_reply_serves_the_next():
    done = subprocess.run(
        [sys.executable, "-c", FAULTS], capture_output=True, text=True, check=True
    )
    pages = 3 * 100 * 20 * 100_000 * 8 // 4096
    # Without it a quarter of them, on glibc 2.36.
    assert int(done.stdout) < pages / 100
