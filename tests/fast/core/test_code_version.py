"""The version of the code that computes."""

import shutil

from vibrafeed.core import code_version


def digest():
    return code_version.digest.__wrapped__(code_version.WITHOUT_NUMBERS)[:8]


def test_it_follows_from_what_computes_alone(tmp_path, monkeypatch):
    sources = tmp_path / "core"
    shutil.copytree(code_version.CORE, sources, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(code_version, "CORE", sources)
    before = digest()
    assert code_version.code_version() == f"{code_version.core.__version__}+{before}"
    assert len(before) == 8
    with (sources / "catalogue.py").open("a") as file:
        file.write("# said in other words\n")
    for file in sources.rglob("*.py"):
        file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
    assert digest() == before, "it is the same where lines end otherwise"
    with (sources / "mechanics" / "impact.py").open("a") as file:
        file.write("# corrected\n")
    assert digest() != before


def test_every_file_that_is_left_out_exists():
    assert all((code_version.CORE / name).exists() for name in code_version.WITHOUT_NUMBERS)
