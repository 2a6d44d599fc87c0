"""Looking through the results of a data directory."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.ledger import Ledger
from vibrafeed.app.jobs.manifest import MANIFEST, NETCDF
from vibrafeed.app.jobs.scrub import BROKEN, ORPHANED, WAITING, WHOLE, damages
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

SWEEP = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["acceleration_x"],
    "parameters": {
        "frequency": {"start": 20, "stop": 60, "num": 5},
        "amplitude": "0.5 mm",
        "beta": 30,
        "friction": 0.4,
    },
}


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path)


def finished(store: Store, friction: float) -> str:
    study = {**SWEEP, "parameters": {**SWEEP["parameters"], "friction": friction}}
    prepared = prepare_content(study)
    key, _ = store.add(prepared.study)
    store.finish(key, tabulate(prepared), process="sweep", cells=5, blocks=1, seconds=1.0)
    return key


def flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def states(store: Store) -> dict[str, str]:
    return {found.name: found.state for found in damages(store)}


def test_each_folder_is_told_as_it_is(store):
    whole, flipped, short, lost, torn, orphaned = (finished(store, 0.1 * k) for k in range(1, 7))
    waiting, _ = store.add(prepare_content(SWEEP | {"outputs": ["regime"]}).study, "accuracy")
    flip(store.folder(flipped) / NETCDF)
    os.truncate(store.folder(short) / NETCDF, 10)
    (store.folder(lost) / NETCDF).unlink()
    (store.folder(torn) / MANIFEST).write_text("{")
    (store.folder(orphaned) / MANIFEST).unlink()
    (store.directory / "other").mkdir()
    assert states(store) == {
        whole: WHOLE, flipped: BROKEN, short: BROKEN, lost: BROKEN, torn: BROKEN,
        orphaned: ORPHANED, waiting: WAITING, "other": ORPHANED,
    }  # fmt: skip


def test_a_service_looks_at_some_each_turn_and_at_all_in_the_end(store, tmp_path, monkeypatch):
    keys = sorted(finished(store, 0.1 * k) for k in range(1, 5))
    monkeypatch.setattr("vibrafeed.app.jobs.admission.SCRUBBED", 1)
    ledger = Ledger(tmp_path / "jobs.sqlite3")
    admission = Admission(ledger, store, Settings(data_directory=tmp_path), lambda: None)
    for key in keys:
        flip(store.folder(key) / NETCDF)
    seen = []
    for _ in keys:
        admission.scrub(lambda: False)
        seen.append([key for key in keys if store.manifest(key) is None])
    assert seen[-1] == keys
    assert seen[0] != keys or len(keys) == 1
    admission.scrub(lambda: False)
    again = finished(store, 0.1)  # it is computed again, and whole
    assert states(store)[again] == WHOLE
    ledger.close()
