"""Laws of the ledger: what several servers and threads see of it.

Tests of `fast` hold them for SQLite, tests of `service` for PostgreSQL: each gives `ledgers`, two
servers' views of one ledger.
"""

import sqlite3
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
from sqlalchemy.exc import ProgrammingError

from vibrafeed.app.jobs.errors import NoRoomError, QueueFullError
from vibrafeed.app.jobs.keys import Key
from vibrafeed.app.jobs.ledger import ACTIVE, Ledger, Wanted
from vibrafeed.app.jobs.quota import Quota
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.work import Task
from vibrafeed.app.settings import Settings
from waiting import PATIENCE

LEASE = 60.0
PROBLEM = {"status": 507, "kind": "storage", "title": "No", "detail": "Full."}


def post(ledger, key="k", *, seconds=None, owner=""):
    return ledger.post(task(key), finished_seconds=seconds, owner=owner)


def task(key):
    return Task(key, "simulate", "", cells=100, block_cells=10, blocks=10, bytes=1000, price=0.0)


def test_servers_count_the_bytes_of_an_owner_alike(ledgers, tmp_path):
    """What is promised, then what the files of a result take."""
    settings = Settings(data_directory=tmp_path)
    here, there = (Quota(ledger, Store(tmp_path), settings) for ledger in ledgers)
    who = Key("lab", "run", bytes=2500)
    for server in (here, there):
        server.measure_if_short("k", 1000, who)  # nothing is there
    for key in ("k", "l"):
        here.make_room(key, 1000, who)
        post(ledgers[0], key, owner="lab")
        here.ownership.hold("lab", key, 10, result=True)
    assert there.used() == 2000
    with pytest.raises(NoRoomError, match="your key may store"):
        there.make_room("m", 1000, who)
    ledgers[1].end(ledgers[1].claim("b", LEASE, "k"), None, 300)
    assert here.used() == 1300
    there.make_room("m", 1000, who)
    there.ownership.hold("lab", "m", 10, result=True)
    assert here.ownership.of("lab", "k") is not None  # it has made no room


def test_a_job_goes_its_way(ledgers):
    here, there = ledgers
    job = post(here)
    assert there.job(job.id) == job
    assert (job.state, job.done, job.started, job.problem) == ("accepted", 0, None, None)
    work = there.claim("b", LEASE)
    assert (work.key, work.block_cells, work.blocks) == ("k", 10, 10)
    assert here.claim("a", LEASE) is None
    there.advance(work, done=4, seconds=1.5)
    there.advance(work, done=5, seconds=0.5)
    running = here.job(job.id)
    assert (running.state, running.done, running.seconds) == ("running", 5, 2.0)
    there.end(work, None, 1)
    done = here.job(job.id)
    assert (done.state, done.done, done.seconds) == ("successful", 10, 2.0)
    assert done.created <= done.started <= done.finished
    assert here.promised() == {}


def test_the_pace_is_that_of_the_claim_and_outlives_a_clock_that_is_set(ledgers, monkeypatch):
    """What was there when a server took work up says nothing of how fast it goes now."""
    here, there = ledgers
    job = post(here)
    first = here.claim("a", LEASE)
    here.advance(first, done=0, seconds=0.0)
    here.advance(first, done=7, seconds=0.0)
    here.release(first.owner)
    second = there.claim("b", LEASE)
    assert here.job(job.id).began is None
    there.advance(second, done=6, seconds=0.0)
    there.advance(second, done=8, seconds=0.0)
    found = here.job(job.id)
    assert (found.done_then, found.done) == (6, 8)
    assert found.began is not None
    now = time.time() + 86_400
    monkeypatch.setattr("vibrafeed.app.jobs.ledger.time.time", lambda: now)
    there.advance(second, done=9, seconds=10.0, elapsed=10.0)
    assert here.job(job.id).began == pytest.approx(now - 10)
    there.end(second, None, 1)
    assert here.job(job.id).began is None


def test_what_waits_is_told_in_order_can_be_chosen_and_is_given_up(ledgers):
    here, there = ledgers
    for key in "klm":
        post(here, key)
    assert [item.key for item in there.waiting()] == ["k", "l", "m"]
    chosen = there.claim("b", LEASE, "l")
    assert chosen.key == "l"
    assert here.claim("a", LEASE, "l") is None
    assert [item.key for item in here.waiting()] == ["k", "m"]
    there.release(chosen.owner)
    assert [here.claim("a", LEASE).key for _ in range(3)] == ["k", "l", "m"]
    for gone in (("a",), ()):
        here.release(*gone)
        assert {there.claim("a", LEASE).key for _ in range(3)} == {"k", "l", "m"}


def test_equal_studies_are_computed_once(ledgers):
    here, there = ledgers
    jobs = [post(here), post(there)]
    work = here.claim("a", LEASE)
    assert there.claim("b", LEASE) is None
    assert post(there).state == "accepted"  # nobody has begun
    here.advance(work, done=0, seconds=0.0)
    late = post(there)
    assert late.state == "running"
    here.end(work, None, 1)
    states = {there.job(job.id).state for job in (*jobs, late)}
    assert states == {"successful"}
    at_once = post(here, seconds=3.0)
    assert (at_once.state, at_once.seconds, at_once.done) == ("successful", 3.0, 10)
    assert here.promised() == {}


@pytest.mark.parametrize("late", ["b", "a"])
def test_a_lease_that_runs_out_is_taken_over_and_its_owner_has_no_say_any_more(ledgers, late):
    """Also not where the same server has claimed it again."""
    here, there = ledgers
    job = post(here)
    work = here.claim("a", 0.05)
    assert here.renew(work, 0.05)
    time.sleep(0.1)
    assert there.claim(late, LEASE).key == "k"
    assert not here.holds(work)
    assert not here.renew(work, LEASE)
    here.advance(work, done=9, seconds=9.0)
    here.end(work, PROBLEM, 1)
    assert (there.job(job.id).state, there.job(job.id).done) == ("accepted", 0)


def test_a_job_that_was_dismissed_or_failed_tells_how_far_it_came(ledgers):
    here, _ = ledgers
    waits = post(here)
    assert here.dismiss(waits.id).done == 0
    dismissed, failed = (post(here).id for _ in range(2))
    work = here.claim("a", LEASE)
    here.advance(work, done=1, seconds=2.5)
    found = here.dismiss(dismissed)
    assert (found.done, found.seconds) == (1, 2.5)
    here.advance(work, done=2, seconds=1.5)
    here.end(work, PROBLEM, 1)
    found = here.job(failed)
    assert (found.state, found.problem, found.done, found.seconds) == ("failed", PROBLEM, 2, 4.0)
    assert here.job(dismissed).done == 1  # what others did later is not its own
    assert post(here).state == "accepted"  # a new one tries again
    assert here.job(failed).state == "failed"


def test_work_is_given_up_when_its_last_job_is_dismissed(ledgers):
    here, there = ledgers
    one, other = post(here), post(there)
    work = here.claim("a", LEASE)
    assert there.dismiss(one.id).state == "dismissed"
    assert here.holds(work)
    assert here.renew(work, LEASE)
    there.dismiss(other.id)
    assert not here.holds(work)
    assert not here.renew(work, LEASE)
    assert here.counts()["dismissed"] == 2
    assert here.dismiss("nobody") is None
    assert here.job("nobody") is None
    here.reenter(task("k"))  # nobody waits for it
    assert here.promised() == {}


def test_the_queue_is_bounded_by_different_studies(ledgers):
    here, there = ledgers
    post(here, "k"), post(here, "l"), post(there, "k"), post(there, "m", seconds=1.0)
    here.check_queue(3)
    with pytest.raises(QueueFullError, match="2 studies"):
        there.check_queue(2)
    assert here.promised() == {"k": 1000, "l": 1000}


def test_an_owner_leaves_room_for_the_next_one(ledgers):
    here, there = ledgers
    for number in range(5):
        here.check_queue(10, "a")  # one owner has 10/2
        post(here, f"a{number}", owner="a")
    with pytest.raises(QueueFullError, match="5 of 10 places"):
        there.check_queue(10, "a")
    post(here, "a0", owner="a")  # the same study takes no other place
    for number in range(3):
        there.check_queue(10, "b")  # each of two has 10/3
        post(there, f"b{number}", owner="b")
    with pytest.raises(QueueFullError, match="its share is 3 of 10 places"):
        here.check_queue(10, "b")
    here.check_queue(10, "c")
    here.check_queue(10)  # where no keys are, all is one owner's


def test_inside_a_transaction_nobody_else_changes_anything(ledgers):
    here, there = ledgers
    with ThreadPoolExecutor() as pool:
        with here.transaction():
            late = pool.submit(post, there)
            assert here.promised() == {}
            time.sleep(0.2)
            assert here.promised() == {}
            post(here, "l")
            with pytest.raises(ZeroDivisionError), here.transaction():
                _ = 1 / 0  # inside the other: it is the outer one that decides
        assert late.result().state == "accepted"
    assert set(here.promised()) == {"k", "l"}


def test_lists(ledgers):
    here, there = ledgers
    jobs = [post(here, str(number)) for number in range(5)]
    assert [job.id for job in there.jobs(limit=3)] == [job.id for job in jobs[:1:-1]]
    after = jobs[2].created, jobs[2].id
    assert [job.id for job in here.jobs(limit=3, after=after)] == [jobs[1].id, jobs[0].id]
    here.dismiss(jobs[0].id)
    over = post(here, "over", seconds=1.0)
    at = over.created
    for wanted, count in (
        (Wanted(states=("dismissed",)), 1),
        (Wanted(processes=("sweep",)), 0),
        (Wanted(processes=("simulate", "sweep"), created=(None, int(at * 1000) / 1000)), 6),
        (Wanted(created=(at - 9, at + 9)), 6),
        (Wanted(created=(at + 9, None)), 0),
        (Wanted(seconds=(0, 5)), 1),
        (Wanted(seconds=(5, None)), 0),
    ):
        assert len(here.jobs(wanted, limit=9)) == count, wanted


def test_the_latest_stands_first_where_the_clock_has_been_set_back(ledgers, monkeypatch):
    here, there = ledgers
    first = post(here, "k")
    monkeypatch.setattr("vibrafeed.app.jobs.ledger.time.time", lambda: first.created - 86_400)
    last = post(there, "l")
    assert [job.id for job in here.jobs(limit=9)] == [last.id, first.id]


def test_of_jobs_that_are_over_so_many_of_each_owner_are_kept(ledgers):
    here, there = ledgers
    active = post(here)
    over = [post(here, f"{who}{n}", seconds=1.0, owner=who) for who in "ab" for n in range(4)]
    post(here, "c", seconds=1.0, owner="c")
    here.forget(0.0, 2)
    kept = [over[n].id for n in (2, 3, 6, 7)]
    assert {active.id, *kept} < {job.id for job in there.jobs(limit=9)}
    assert len(there.jobs(limit=9)) == 6
    here.forget(time.time() + 1, 9)
    assert [job.id for job in there.jobs(limit=9)] == [active.id]


def test_many_threads_of_two_servers_lose_nothing(ledgers):
    """With a plain BEGIN most of these would fail at once: a read that turns into a write."""
    taken, lock = [], threading.Lock()

    def work(number):
        ledger = ledgers[number % 2]
        job = post(ledger, str(number))
        item = ledger.claim(f"owner {number}", LEASE)
        with lock:
            taken.append(item.key)
        ledger.end(item, None, 1)
        return job.id

    with ThreadPoolExecutor(16) as pool:
        numbers = list(pool.map(work, range(32)))
    assert sorted(taken) == sorted(map(str, range(32)))
    assert {ledgers[0].job(number).state for number in numbers} == {"successful"}
    assert not any(ledgers[0].counts()[state] for state in ACTIVE)


def test_a_change_that_fails_changes_nothing(ledgers):
    here, there = ledgers
    job = post(here)

    def fail():
        with here.transaction() as database:
            here.dismiss(job.id)
            database.exec_driver_sql("nonsense")

    with pytest.raises((sqlite3.Error, ProgrammingError)):
        fail()
    assert there.job(job.id).state == "accepted"
    assert there.claim("b", LEASE).key == "k"


def made_at_once(where):
    """Have four servers make a ledger at the same moment; return what each counts."""
    barrier = threading.Barrier(4)

    def use(where):
        ledger = Ledger(where)
        barrier.wait(PATIENCE)
        try:
            return ledger.counts()
        finally:
            ledger.close()

    with ThreadPoolExecutor(4) as pool:
        return list(pool.map(use, [where] * 4))
