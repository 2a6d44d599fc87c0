"""Where the service keeps what nobody has told it where to keep."""

from __future__ import annotations

from pathlib import Path

import pytest

from vibrafeed.app.cli.serve import _tell_of_older_data
from vibrafeed.app.folders import cache_folder, data_folder
from vibrafeed.app.settings import Settings


@pytest.mark.parametrize(
    ("platform", "variable", "folder"),
    [
        ("linux", "", "/home/ann/.local/share/vibrafeed"),
        ("linux", "/srv/share", "/srv/share/vibrafeed"),
        ("linux", "share", "/home/ann/.local/share/vibrafeed"),  # relative ones are ignored
        ("darwin", "", "/home/ann/Library/Application Support/vibrafeed"),
    ],
)
def test_the_data_folder_is_the_platforms(platform, variable, folder, monkeypatch):
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setenv("HOME", "/home/ann")
    monkeypatch.setenv("XDG_DATA_HOME", variable)
    monkeypatch.delenv("VIBRAFEED_DATA_DIRECTORY", raising=False)
    assert data_folder() == Path(folder)
    assert Settings().data_directory == Path(folder)
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", "/data")
    assert Settings().data_directory == Path("/data")


def test_windows_keeps_both_in_local_application_data(monkeypatch):
    monkeypatch.setattr("sys.platform", "win32")
    monkeypatch.setenv("XDG_DATA_HOME", "/srv/share")  # is no variable of Windows
    monkeypatch.setenv("LOCALAPPDATA", "/users/ann/AppData/Local")
    assert data_folder() == Path("/users/ann/AppData/Local/vibrafeed")
    assert cache_folder() == Path("/users/ann/AppData/Local/vibrafeed/Cache")


def test_a_user_without_home_has_a_folder_here(monkeypatch):
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    monkeypatch.setattr(Path, "home", lambda: (_ for _ in ()).throw(RuntimeError("no home")))
    assert data_folder() == Path("data")


@pytest.mark.parametrize(
    ("platform", "variable", "folder"),
    [
        ("linux", "", "/home/ann/.cache/vibrafeed"),
        ("linux", "/var/tmp", "/var/tmp/vibrafeed"),
        ("darwin", "", "/home/ann/Library/Caches/vibrafeed"),
    ],
)
def test_the_cache_folder_is_the_platforms(platform, variable, folder, monkeypatch):
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setenv("HOME", "/home/ann")
    monkeypatch.setenv("XDG_CACHE_HOME", variable)
    assert cache_folder() == Path(folder)


def test_studies_in_the_folder_of_before_are_named(tmp_path, monkeypatch, capsys):
    monkeypatch.delenv("VIBRAFEED_DATA_DIRECTORY", raising=False)
    monkeypatch.chdir(tmp_path)
    _tell_of_older_data(Settings())
    assert not capsys.readouterr().err
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "jobs.sqlite3").touch()
    _tell_of_older_data(Settings(data_directory=tmp_path / "elsewhere"))
    assert not capsys.readouterr().err
    _tell_of_older_data(Settings())
    assert str(tmp_path / "data") in capsys.readouterr().err.replace("\n", "")
