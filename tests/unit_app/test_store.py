"""What the service keeps on the disk, and how it keeps it within limits."""

import json
import os
import time

import numpy as np
import pytest

from app.exceptions import NoRoomError, NotFoundError, TornBlockError
from app.jobs import work
from app.jobs.desk import Desk
from app.jobs.ledger import Ledger
from app.settings import Settings
from app.store import NETCDF, Store, identifier
from core.dataset.netcdf import write_netcdf
from core.kinds import prepare_content, tabulate
from core.sweep.pieces import Computed, Cut

SWEEP = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["acceleration_x"],
    "parameters": {
        "frequency": {"start": 20, "stop": 60, "num": 5},
        "amplitude": "0.5 mm",
        "beta": {"start": 5, "stop": 60, "num": 7},
        "friction": 0.4,
    },
}
SIMULATION = {**SWEEP, "kind": "simulate", "outputs": ["conveying_velocity"]}


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path)


def carried_out(store, content, *, cells=10):
    """Carry a study out as workers do; return its identifier."""
    prepared = prepare_content(content)
    key, _ = store.add(prepared.study)
    directory = str(store.directory.parent)
    for index in reversed(range(len(Cut(prepared, cells)))):
        work.compute_block(directory, key, cells, index)
    work.write_result(directory, key, cells, content["kind"], 1.0)
    return key


@pytest.mark.parametrize("content", [SWEEP, SIMULATION])
@pytest.mark.parametrize("cells", [3, 10, 1000])
def test_the_file_of_a_job_is_that_of_the_command_line_but_for_its_history(
    store, content, cells, tmp_path
):
    key = carried_out(store, content, cells=cells)
    write_netcdf(tabulate(prepare_content(content)), tmp_path / "whole.nc")
    assert (store.folder(key) / NETCDF).read_bytes() == (tmp_path / "whole.nc").read_bytes()
    manifest = store.manifest(key)
    assert manifest.files[NETCDF]["bytes"] == (tmp_path / "whole.nc").stat().st_size
    assert sorted(path.name for path in store.folder(key).iterdir()) == [
        "manifest.json", "result.json", NETCDF, "study.json"
    ]  # fmt: skip
    document = json.loads((store.folder(key) / "result.json").read_bytes())
    assert "elapsed_seconds" not in document["attributes"]


def test_identifiers_tell_studies_and_processes_apart():
    study, other = prepare_content(SWEEP).study, prepare_content(SIMULATION).study
    keys = {identifier(study), identifier(other), identifier(study, "accuracy")}
    assert len(keys) == 3
    assert identifier(study, "sweep") == identifier(study)


def test_only_identifiers_reach_the_disk(store):
    for name in ("../studies", "a" * 63, "g" * 64, "", "A" * 64, "a" * 64 + "\n"):
        for look in (store.get, store.folder, store.sweep, store.manifest):
            with pytest.raises(NotFoundError):
                look(name)
    with pytest.raises(NotFoundError):
        store.get("a" * 64)


def test_a_simulation_is_no_sweep(store):
    key, _ = store.add(prepare_content(SIMULATION).study)
    assert store.get(key).cells == 35
    with pytest.raises(NotFoundError):
        store.sweep(key)
    other, _ = store.add(prepare_content(SWEEP).study, "accuracy")
    with pytest.raises(NotFoundError):
        store.sweep(other)


@pytest.mark.parametrize("torn", [b"", b"PK\x03\x04", b"nonsense" * 100, None])
def test_a_torn_block_is_found_and_removed(store, torn):
    key, _ = store.add(prepare_content(SWEEP).study)
    computed = Computed({"x": np.arange(1000.0)}, {"note": "a"})
    store.write_block(key, 5, 0, computed)
    read = store.read_block(key, 5, 0)
    np.testing.assert_array_equal(read.arrays["x"], computed.arrays["x"])
    assert read.notes == computed.notes
    path = next((store.folder(key) / "blocks").rglob("*.npz"))
    content = path.read_bytes()
    # A single bit is found too: the format holds a sum of each array.
    path.write_bytes(
        content[:900] + bytes([content[900] ^ 1]) + content[901:] if torn is None else torn
    )
    with pytest.raises(TornBlockError):
        store.read_block(key, 5, 0)
    assert not store.has_block(key, 5, 0)


def test_blocks_of_another_size_are_not_taken(store):
    key, _ = store.add(prepare_content(SWEEP).study)
    store.write_block(key, 5, 0, Computed({"x": np.zeros(5)}))
    assert not store.has_block(key, 6, 0)


def test_what_killed_writers_left_is_swept_up_and_nothing_else(store):
    key = carried_out(store, SWEEP)
    folder = store.folder(key)
    for name in (".result.nc.123.part", ".study.json.1.2.part"):
        (folder / name).write_bytes(b"torn")
    before = sorted(p.name for p in folder.iterdir() if not p.name.startswith("."))
    assert store.sweep_up() == 2
    assert sorted(p.name for p in folder.iterdir()) == before


def test_a_write_that_fails_leaves_nothing(store, monkeypatch):
    study = prepare_content(SWEEP).study

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        store.add(study)
    assert [path for path in store.directory.rglob("*") if path.is_file()] == []


class TestDesk:
    @pytest.fixture
    def desk(self, store, tmp_path):
        ledger = Ledger(tmp_path / "jobs.sqlite3")
        yield lambda **values: Desk(
            ledger, store, Settings(data_directory=tmp_path, **values), lambda: None
        )
        ledger.close()

    def test_a_study_that_is_there_is_successful_at_once(self, desk, store):
        carried_out(store, SWEEP)
        assert desk().post(prepare_content(SWEEP), "sweep").state == "successful"
        assert desk().post(prepare_content(SIMULATION), "simulate").state == "accepted"

    def test_results_used_longest_ago_make_room(self, desk, store):
        old, new = carried_out(store, SWEEP), carried_out(store, SIMULATION)
        os.utime(store.folder(old) / "study.json", (1, 1))
        taken = store.bytes()
        desk(disk_quota_bytes=taken + 10).make_room(100)
        assert store.manifest(old) is None
        assert store.manifest(new) is not None
        with pytest.raises(NoRoomError, match="quota"):
            desk(disk_quota_bytes=50).make_room(100)

    def test_what_is_worked_on_stays(self, desk, store):
        key = identifier(prepare_content(SWEEP).study)
        desk().post(prepare_content(SWEEP), "sweep")
        with pytest.raises(NoRoomError):
            desk(disk_quota_bytes=50).make_room(100)
        assert store.get(key).cells == 35

    def test_a_disk_without_room_is_told_before_anything_is_written(self, desk, store):
        with pytest.raises(NoRoomError, match="the disk has"):
            desk(disk_quota_bytes=10**30).make_room(10**29)

    def test_what_nobody_has_used_is_removed(self, desk, store):
        old, new = carried_out(store, SWEEP), carried_out(store, SIMULATION)
        job = desk().post(prepare_content(SWEEP), "sweep")
        year_ago = time.time() - 365 * 86_400
        os.utime(store.folder(old) / "study.json", (year_ago, year_ago))
        desk().tidy()
        assert not store.folder(old).exists()
        assert store.manifest(new) is not None
        assert desk().ledger.job(job.id) is not None  # it is young
        desk(retention_days=1e-9).tidy()
        assert desk().ledger.job(job.id) is None

    def test_use_is_noted(self, store):
        key = carried_out(store, SWEEP)
        year_ago = time.time() - 365 * 86_400
        os.utime(store.folder(key) / "study.json", (year_ago, year_ago))
        store.get(key)
        assert time.time() - store.used(key) < 60

    def test_what_is_just_being_added_is_in_use(self, desk, store):
        """Its folder is made before its file: tidying at that moment took it from the writer."""
        folder = store.directory / ("0" * 64)
        folder.mkdir(parents=True)
        desk().tidy()
        assert folder.exists()
