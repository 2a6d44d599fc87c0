"""What studies took is kept in the ledger and scales the prices of later ones of their kind."""

from pathlib import Path

import pytest

from vibrafeed.app.jobs import learned
from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.entries import Work
from vibrafeed.app.jobs.priority_classes import PriorityClasses
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import prepare_content

HOP = {"frequency": 50, "amplitude": "2.1 mm", "beta": 41, "friction": 0.4, "restitution": 0.6}
FORMULA = 2.0  # s


@pytest.fixture
def database(tmp_path: Path):
    found = Database(tmp_path / "ledger.sqlite")
    yield found
    found.close()


def test_a_factor_is_the_median_of_what_ran(database):
    for n, took in enumerate([4.0, 5.0, 6.0, 4.5]):
        learned.learn(database, "simulate reference", FORMULA, took)
        assert learned.factor(database, "simulate reference") == 1.0, n  # too few
    learned.learn(database, "simulate reference", FORMULA, 4000.0)  # one that was held up
    assert learned.factor(database, "simulate reference") == pytest.approx(2.5)
    assert learned.factor(database, "simulate events") == 1.0


def test_the_latest_count_and_a_factor_is_bounded(database):
    for _ in range(learned.KEPT):
        learned.learn(database, "sweep derived", FORMULA, 2.0 * FORMULA)
    for _ in range(learned.KEPT // 2 + 1):
        learned.learn(database, "sweep derived", FORMULA, 100.0 * FORMULA)
    assert learned.factor(database, "sweep derived") == learned.LARGEST
    for _ in range(learned.KEPT):
        learned.learn(database, "sweep derived", 1e9, learned.TELLING)
    assert learned.factor(database, "sweep derived") == 1.0 / learned.LARGEST


def test_what_took_no_time_tells_nothing(database):
    for _ in range(10):
        learned.learn(database, "sweep thesis", 1e-6, 0.9 * learned.TELLING)
    assert learned.factor(database, "sweep thesis") == 1.0


def test_the_queue_prices_by_what_it_has_seen(tmp_path, database):
    store, settings = Store(tmp_path), Settings(data_directory=tmp_path)

    def posted(frequency: float) -> Work:
        study = {"kind": "simulate", "scene": "rectangle-on-plane", "method": "reference"}
        study["parameters"] = HOP | {"frequency": frequency}
        key, _ = store.add(prepare_content(study).study)
        return Work(key, "simulate", 1, 2, 0.0, "")

    queue = PriorityClasses(store, settings, database)
    items = [posted(50.0 + n) for n in range(6)]
    by_formula = queue.price(items[0])
    for item in items:
        queue.learn(item, 3.0 * queue.price(item))
    assert queue.price(items[0]) == by_formula  # an item is priced once
    later = PriorityClasses(store, settings, database)  # another server, on the same ledger
    assert later.price(items[0]) == pytest.approx(3.0 * by_formula)
    assert later.block_price(items[0]) == pytest.approx(1.5 * by_formula)
