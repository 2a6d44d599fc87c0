"""What the service keeps on the disk, and how it keeps it within limits."""

import json
import os
import threading
import time
from collections import namedtuple
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from vibrafeed.app.jobs import studies, work
from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.errors import (
    NoRoomError,
    NotFoundError,
    OtherVersionError,
    QueueFullError,
    TornBlockError,
)
from vibrafeed.app.jobs.ledger import Ledger
from vibrafeed.app.jobs.manifest import NETCDF
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.studies import identifier
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.zarr_views import ZarrViews
from vibrafeed.core.code_version import code_version
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plan.pieces import Computed, Cut

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
OTHER = "0" * 64
BLOCK = Computed({"x": np.zeros(5)})
SIMULATION = {**SWEEP, "kind": "simulate", "outputs": ["conveying_velocity"]}


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path)


def changed(content, **parameters):
    return {**content, "parameters": {**content["parameters"], **parameters}}


def task(content):
    return work.task_of(prepare_content(content), content["kind"], Settings())


def added(store, content, *process):
    return store.add(prepare_content(content).study, *process)[0]


def carried_out(store, content, *, cells=10):
    """Carry a study out as workers do; return its identifier."""
    prepared = prepare_content(content)
    key, _ = store.add(prepared.study)
    directory = str(store.directory.parent)
    for index in reversed(range(len(Cut(prepared, cells)))):
        work.compute_block(directory, key, content["kind"], cells, index, code_version())
    work.write_result(directory, key, content["kind"], cells, 1.0)
    return key


def test_studies_asked_for_last_stay_prepared_unless_they_are_gone(store, monkeypatch):
    monkeypatch.setattr(studies, "MAX_CACHED", 2)
    short, other, third = (added(store, changed(SWEEP, friction=n)) for n in (0.1, 0.2, 0.3))
    first = store.get(short)
    for key in (short, other, short, other):
        store.get(key)
    assert store.get(short) is first
    for key in (other, third):
        store.get(key)
    assert store.get(short) is not first
    store.remove(short)
    with pytest.raises(NotFoundError):
        store.get(short)


def test_long_studies_stay_prepared_within_a_number_of_bytes(store, monkeypatch):
    long = ([shift / 1e6 + n / 1000 for n in range(500)] for shift in range(3))
    keys = [added(store, changed(SWEEP, friction=values)) for values in long]
    sizes = [(store.folder(key) / "study.json").stat().st_size for key in keys]
    monkeypatch.setattr(studies, "MAX_CACHED_BYTES", sizes[1] + sizes[2])
    first, second, third = (store.get(key) for key in keys)
    assert store.get(keys[1]) is second
    assert store.get(keys[2]) is third
    assert store.get(keys[0]) is not first
    monkeypatch.setattr(studies, "MAX_CACHED_BYTES", 0)
    assert store.get(keys[1]) is not store.get(keys[1])  # a study beyond the bound is not kept


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


def test_only_identifiers_reach_the_disk(store):
    for name in ("../studies", "a" * 63, "g" * 64, "", "A" * 64, "a" * 64 + "\n", "a" * 64):
        for look in (store.get, store.folder, store.sweep, store.manifest):
            if (name, look) not in (("a" * 64, store.folder), ("a" * 64, store.manifest)):
                with pytest.raises(NotFoundError):
                    look(name)


def test_a_simulation_and_a_report_of_accuracy_are_no_sweeps(store):
    sweep, simulation = added(store, SWEEP), added(store, SIMULATION)
    accuracy = added(store, SWEEP, "accuracy")
    assert len({sweep, simulation, accuracy}) == 3
    assert identifier(prepare_content(SWEEP).study, "sweep") == sweep
    assert store.get(simulation).cells == 35
    for key in (simulation, accuracy, accuracy):  # the second time it is known
        with pytest.raises(NotFoundError):
            store.sweep(key)
    assert store.get(accuracy).study.kind == "sweep"


BIT = "a bit"


@pytest.mark.parametrize(
    ("torn", "at"), [(b"", 0), (b"nonsense" * 100, 0), (BIT, 0), (BIT, 40), (BIT, 900), (BIT, -20)]
)
def test_a_damaged_block_is_found_and_removed(store, torn, at):
    """Wherever the damage is: the archive's own sums do not cover its headers."""
    key = added(store, SWEEP)
    computed = Computed({"x": np.arange(1000.0)}, {"note": "a"})
    store.write_block(key, 5, 0, computed)
    read = store.read_block(key, 5, 0)
    np.testing.assert_array_equal(read.arrays["x"], computed.arrays["x"])
    assert read.notes == computed.notes
    assert not store.has_block(key, 6, 0)  # of another size
    path = next((store.folder(key) / "blocks").rglob("*.block"))
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content if torn == BIT else torn)
    with pytest.raises(TornBlockError):
        store.read_block(key, 5, 0)
    assert not store.has_block(key, 5, 0)


def test_whoever_finishes_a_study_second_changes_nothing(store):
    """Two servers may both take a study for theirs when one was late with its lease."""
    key, table = added(store, SWEEP), tabulate(prepare_content(SWEEP))

    def finish(number):
        return store.finish(
            key, table, process="sweep", cells=35, blocks=number, seconds=1.0, write_more=pages
        )

    def pages(dataset, folder):
        assert dataset.exists()
        (folder / "page.md").write_text("page")
        return [folder / "page.md"]

    with ThreadPoolExecutor() as pool:
        manifests = list(pool.map(finish, range(4)))
    assert len({manifest.blocks for manifest in manifests}) == 1
    store.write_block(key, 5, 0, BLOCK)  # of a late worker
    assert finish(9) == manifests[0]
    assert {path.name for path in store.folder(key).iterdir()} == {
        "manifest.json", "page.md", "result.json", NETCDF, "study.json"
    }  # fmt: skip
    assert {name: file["bytes"] for name, file in manifests[0].files.items()} == {
        name: (store.folder(key) / name).stat().st_size for name in manifests[0].files
    }


def test_a_result_whose_manifest_is_damaged_is_made_again(store):
    key = carried_out(store, SWEEP)
    before = store.manifest(key)
    for content in ("", "{", "[]", '{"key": 1}'):
        (store.folder(key) / "manifest.json").write_text(content)
        assert store.manifest(key) is None
        store.write_block(key, 5, 0, BLOCK)
        store.drop_blocks(key)
        assert store.has_block(key, 5, 0)
    assert carried_out(store, SWEEP) == key
    assert store.manifest(key).files == before.files


def test_a_folder_that_was_removed_while_its_lock_was_waited_for_is_not_used(store):
    key = added(store, SWEEP)
    entered = threading.Event()

    def wait():
        with store._locked(key):
            entered.set()

    with ThreadPoolExecutor(1) as threads:
        with store._locked(key):
            waiting = threads.submit(wait)
            assert not entered.wait(0.1)
            store.remove(key)
        assert isinstance(waiting.exception(), FileNotFoundError)
    added(store, SWEEP)
    with store._locked(key) as folder:
        assert (folder / "study.json").exists()


def test_a_block_is_written_though_the_folder_goes_at_that_moment(store, monkeypatch):
    key = added(store, SWEEP)
    mkdir = Path.mkdir

    def removed_at_once(path, *arguments, **options):
        mkdir(path, *arguments, **options)
        if path.parent.name == "blocks":
            monkeypatch.undo()
            path.rmdir()

    monkeypatch.setattr(Path, "mkdir", removed_at_once)
    store.write_block(key, 5, 0, BLOCK)
    assert Path.mkdir is mkdir
    assert store.has_block(key, 5, 0)
    store.remove(key)
    with pytest.raises(FileNotFoundError):
        store.write_block(key, 5, 0, BLOCK)
    assert not store.folder(key).exists()


def test_a_study_under_way_at_an_upgrade_is_computed_by_the_new_code_alone(store, monkeypatch):
    key = added(store, SWEEP)
    about = str(store.directory.parent), key, "sweep"
    work.compute_block(*about, 10, 0, code_version())
    assert store.has_block(key, 10, 0)
    monkeypatch.setattr("vibrafeed.core.__version__", "99.0")
    assert not store.has_block(key, 10, 0)
    with pytest.raises(TornBlockError):
        work.write_result(*about, 10, 0.0)
    for index in work.missing_blocks(*about, 10, len(Cut(store.get(key), 10))):
        work.compute_block(*about, 10, index, code_version())
    work.write_result(*about, 10, 0.0)
    assert store.manifest(key).version.startswith("99.0+")


def test_what_another_version_runs_or_wrote_is_told_so(store, monkeypatch):
    key, directory = added(store, SWEEP), str(store.directory.parent)
    with pytest.raises(OtherVersionError, match=r"The server runs vibrafeed 99\.0"):
        work.compute_block(directory, key, "sweep", 10, 0, "99.0")
    other = Store(store.directory.parent)
    with monkeypatch.context() as later:
        later.setattr("vibrafeed.core.__version__", "99.0")
        with pytest.raises(OtherVersionError, match=r"99\.0.*POST the study to /sweeps again"):
            other.sweep(key)
    (store.directory / key / "study.json").write_text('{"kind": "sweep", "scene": "gone"}')
    with pytest.raises(OtherVersionError, match="cannot read this study"):
        work.compute_block(directory, key, "sweep", 10, 0, code_version())
    with pytest.raises(OtherVersionError):
        Store(store.directory.parent).sweep(key)


def test_a_write_that_fails_leaves_nothing(store, monkeypatch):
    study = prepare_content(SWEEP).study

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        store.add(study)
    assert [path for path in store.directory.rglob("*") if path.is_file()] == []


NEEDED = 2 * prepare_content(SIMULATION).bytes


class TestDesk:
    @pytest.fixture
    def admission(self, store, tmp_path):
        ledger = Ledger(tmp_path / "jobs.sqlite3")
        yield lambda **values: Admission(
            ledger, store, Settings(data_directory=tmp_path, **values), lambda: None
        )
        ledger.close()

    def test_a_study_that_is_there_is_successful_at_once(self, admission, store):
        carried_out(store, SWEEP)
        assert admission().post(task(SWEEP)).state == "successful"
        assert admission().post(task(SIMULATION)).state == "accepted"

    def test_results_used_longest_ago_make_room(self, admission, store):
        old, new = carried_out(store, SWEEP), carried_out(store, SIMULATION)
        os.utime(store.folder(old) / "study.json", (1, 1))
        taken = store.bytes(old) + store.bytes(new)
        admission(disk_quota_bytes=taken + 10).make_room(OTHER, 100)
        assert store.manifest(old) is None
        assert store.manifest(new) is not None

    def test_what_cannot_fit_removes_nothing(self, admission, store):
        kept = carried_out(store, SWEEP)
        with pytest.raises(NoRoomError, match="quota"):
            admission(disk_quota_bytes=50).make_room(OTHER, 100)
        with pytest.raises(NoRoomError, match="more than the disk of the service has free"):
            admission(disk_quota_bytes=10**29 + 10).make_room(OTHER, 10**29)
        assert store.manifest(kept) is not None

    def test_a_full_queue_removes_nothing(self, admission, store):
        kept = carried_out(store, SWEEP)
        full = admission(max_queue=1, disk_quota_bytes=store.bytes(kept) + NEEDED + 100)
        full.post(task(SIMULATION))
        other = changed(SIMULATION, friction=0.5)
        with pytest.raises(QueueFullError):
            full.post(task(other))
        assert store.manifest(kept) is not None
        assert len(store.studies()) == 2  # the refused one is not kept

    def test_the_study_that_is_posted_makes_no_room_for_itself(self, admission, store):
        """Its folder is the oldest one: it was given up half done."""
        key = added(store, SIMULATION)
        store.write_block(key, 5, 0, Computed({"x": np.zeros(2000)}))
        os.utime(store.folder(key) / "study.json", (1, 1))
        other = carried_out(store, SWEEP)
        admission(disk_quota_bytes=NEEDED + 100).post(task(SIMULATION))
        assert store.has_block(key, 5, 0)
        assert not store.folder(other).exists()

    def test_what_is_dismissed_makes_nothing_leave(self, admission, store):
        """What it was promised is on no disk, and no promise any more."""
        kept = carried_out(store, SWEEP)
        service = admission(disk_quota_bytes=store.bytes(kept) + 2 * NEEDED + 2000)
        for friction in (0.5, 0.6, 0.7, 0.8):
            service.dismiss(service.post(task(changed(SIMULATION, friction=friction))).id)
        assert store.manifest(kept) is not None

    def test_the_disk_is_promised_once(self, admission, store, monkeypatch):
        usage = namedtuple("usage", "total used free")
        free = [int(1.5 * NEEDED)]
        monkeypatch.setattr("shutil.disk_usage", lambda _: usage(0, 0, free[0]))
        service = admission()
        service.post(task(SIMULATION))
        other = changed(SIMULATION, friction=0.5)
        with pytest.raises(NoRoomError, match="more than the disk of the service has free"):
            service.post(task(other))
        # What has been written of a promise is owed no more.
        item = service.ledger.claim("server", 60.0)
        assert item is not None
        service.ledger.advance(item, done=item.blocks, seconds=1.0)
        assert service.post(task(other)).state == "accepted"

    def test_what_is_promised_to_work_is_not_promised_again(self, admission, store):
        """However many servers: it stands in the ledger."""
        tight, loose = ({"disk_quota_bytes": NEEDED + spare} for spare in (10, 1000))
        admission(**tight).post(task(SIMULATION))
        other = changed(SIMULATION, friction=0.5)
        with pytest.raises(NoRoomError, match="are reserved for running jobs"):
            admission(**tight).post(task(other))
        sweep = task(SWEEP)
        with pytest.raises(NoRoomError):
            admission(**tight).keep_sweep(sweep.key, sweep.text)
        assert admission(**loose).keep_sweep(sweep.key, sweep.text)
        assert store.get(identifier(prepare_content(SIMULATION).study)).cells == 35

    def test_what_nobody_has_used_is_removed(self, admission, store):
        old, new = carried_out(store, SWEEP), carried_out(store, SIMULATION)
        job = admission().post(task(SWEEP))
        year_ago = time.time() - 365 * 86_400
        os.utime(store.folder(old) / "study.json", (year_ago, year_ago))
        admission().tidy()
        assert not store.folder(old).exists()
        assert store.manifest(new) is not None
        assert admission().ledger.job(job.id) is not None  # it is young
        admission(retention_days=1e-9).tidy()
        assert admission().ledger.job(job.id) is None

    def test_use_is_noted(self, store):
        key = carried_out(store, SWEEP)
        long_ago = 1e9  # s, in 2001
        views = ZarrViews(store)
        views.view(key)
        uses = (
            lambda: store.get(key),
            lambda: store.manifest(key),  # a download
            lambda: views.view(key),  # from memory
        )
        for use in uses:
            os.utime(store.folder(key) / "study.json", (long_ago, long_ago))
            use()
            assert store.last_use(key) > 2 * 365 * 86_400 + long_ago

    def test_tidying_removes_what_late_workers_and_killed_writers_left(self, admission, store):
        done, half = carried_out(store, SWEEP), added(store, SIMULATION)
        for key in (done, half):
            store.write_block(key, 5, 0, BLOCK)
        left, young = store.folder(half) / ".x.part", store.folder(done) / ".abc.part"
        left.write_bytes(b"torn")
        os.utime(left, (1, 1))
        young.mkdir()
        (young / "picture.png").write_bytes(b"torn")
        admission().tidy()
        assert not (store.folder(done) / "blocks").exists()
        assert store.has_block(half, 5, 0)  # it may be posted again
        assert not left.exists()
        assert young.exists()  # somebody may be writing it
        assert store.remove_leftovers(0) == 1
        assert (store.folder(done) / NETCDF).exists()

    def test_what_is_just_being_added_is_in_use(self, admission, store):
        """Its folder is made before its file: tidying at that moment took it from the writer."""
        folder = store.directory / ("0" * 64)
        folder.mkdir(parents=True)
        admission().tidy()
        assert folder.exists()
