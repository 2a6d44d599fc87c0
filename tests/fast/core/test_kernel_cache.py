"""What compiled kernels depend on, and where they are kept; tests/service/test_compiled_code.py."""

import ast
import os
from pathlib import Path

from vibrafeed.core import kernel_cache
from vibrafeed.core.kernel_cache import COMPILERS, CORE, KEPT, imported, packages, sources
from vibrafeed.core.warm import STUDIES

FROZEN = CORE / "quantities/flags.py"
"""What kernels may import besides kernels; the values are frozen into the code."""


def parsed_imports(file: Path) -> set[Path]:
    """Return the files of ours that a file imports, as Python's own parser reads it."""
    names: list[str] = []
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom):
            names += [node.module or ".", *(f"{node.module}.{one.name}" for one in node.names)]
        elif isinstance(node, ast.Import):
            names += [one.name for one in node.names]
    assert not [name for name in names if name.startswith((".", "vibrafeed.app"))], file
    found = [CORE.parent.joinpath(*name.split(".")[1:]) for name in names
             if name.startswith("vibrafeed.")]  # fmt: skip
    both = [file for one in found for file in (one.with_suffix(".py"), one / "__init__.py")]
    return {file for file in both if file.is_file()}


def test_the_digest_of_a_package_covers_all_that_it_imports():
    compilers = {CORE / name for name in COMPILERS}
    kernels = {file for name in packages() for file in sources(name) if "kernels" in file.parts}
    assert kernels == set(CORE.glob("*/kernels/**/*.py"))
    for file in {*kernels, *compilers, FROZEN}:
        assert parsed_imports(file) == set(imported(file.read_text())), file
    for name, folder in packages().items():
        covered = set(sources(name))
        assert set(folder.glob("*.py")) <= covered <= {*kernels, *compilers, FROZEN}
        for file in covered - compilers:
            assert parsed_imports(file) <= covered, f"{name}: {file}"
        others = {other for other, place in packages().items() if place / "__init__.py" in covered}
        assert others <= {name, "motion"}, "an edit of one compiles another anew"


def test_every_package_of_kernels_is_compiled_beforehand():
    assert set(STUDIES) == set(packages()) - {"motion"}  # which all others compile


def test_folders_of_old_digests_go(tmp_path, monkeypatch):
    monkeypatch.setattr(kernel_cache, "root", lambda: tmp_path)
    old = [tmp_path / f"motion-planar-{number:016x}" for number in range(KEPT + 3)]
    for number, folder in enumerate(old):
        folder.mkdir()
        (folder / "code.nbc").write_text("")
        os.utime(folder, (1e9 + number, 1e9 + number))
    others = tmp_path / "motion-planar-of-somebody-else"
    others.mkdir()
    new = kernel_cache.folder.__wrapped__("motion-planar")
    assert set(tmp_path.iterdir()) == {new, others, *old[3:]}  # the last used, and the new one
