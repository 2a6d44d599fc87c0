"""Models of studies are built when they are first used: by one thread or by many at once."""

import subprocess
import sys

AT_ONCE = """
import sys
import threading
from vibrafeed.core.intake import parse_study

sys.setswitchinterval(1e-6)
point = {"frequency": 50, "amplitude": 1e-4, "friction": 0.3}
plane = {"scene": "rectangle-on-plane", "parameters": {**point, "beta": [10, 20, 30]}}
studies = [
    {"kind": "simulate", **plane},
    {"kind": "sweep", "outputs": ["throw_number"], **plane},
    {"kind": "sweep", "outputs": ["acceleration_x"], **plane,
     "reduce": {"over": ["beta"], "statistics": ["max"]}},
    {"kind": "optimise", "scene": "rectangle-on-track", "parameters": point,
     "criterion": {"kind": "maximise", "output": "acceleration_x"}},
]
barrier, read = threading.Barrier(12), []

def go(content):
    barrier.wait()
    read.append(parse_study(content).kind)

threads = [threading.Thread(target=go, args=(studies[k % 4],)) for k in range(12)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(*sorted(read))
"""


def test_threads_may_read_their_first_studies_at_once():
    done = subprocess.run([sys.executable, "-c", AT_ONCE], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == 3 * ["optimise"] + 3 * ["simulate"] + 6 * ["sweep"]
