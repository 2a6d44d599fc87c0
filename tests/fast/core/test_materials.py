"""The table of coefficients: rows with sources, found by words, the same wherever it is shown."""

import pytest
from fastapi.testclient import TestClient
from typer.testing import CliRunner

import vibrafeed
import vibrafeed.core.materials
from benchmarks.friction_page import PAGE, page
from vibrafeed.app.cli import app
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.materials import friction, leaf_springs
from vibrafeed.core.scenes import SCENES

ALL = friction()


def rows():
    return [*ALL["pairs"], *ALL["rebounds"]]


def test_every_row_has_values_and_a_source() -> None:
    for row in rows():
        ranges = {name: row.get(name) for name in vibrafeed.core.materials.VALUES if row.get(name)}
        assert ranges, row
        assert not ("coefficient" in ranges and len(ranges) > 1), row
        for name, (least, largest) in ranges.items():
            assert 0 < least <= largest, row
            assert name != "restitution" or largest <= 1, row
        assert row["part"], row
        assert row["track"], row
        if row.get("static") and row.get("kinetic") and row["kinetic"][0] > row["static"][1]:
            assert "one value for both" in row["note"], "a study takes no such pair"
        assert ALL["sources"][row["source"]]["address"].startswith("http"), row
    declared = vibrafeed.core.materials._data("friction.toml")["sources"]
    assert set(declared) == {row["source"] for row in rows()}  # none that nobody quotes


def test_rows_are_found_by_the_beginnings_of_their_words() -> None:
    found = friction("TEFLON alu")
    assert [row["part"] for row in found["pairs"]] == ["aluminium"]
    assert set(found["sources"]) == {"surface"}
    assert not friction("steel unobtainium")["pairs"]
    assert all("steel" in f"{row['part']} {row['track']}" for row in friction("steel")["rebounds"])
    assert found["about"] == ALL["about"]  # how far to trust them is told with any row
    for pair in ("brass steel", "ptfe", "polyurethane", "rubber", "glass", "lubricated steel"):
        assert friction(pair)["pairs"], "what a designer looks for"


def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


@pytest.mark.parametrize(
    ("words", "told", "other"),
    [
        (["abs", "steel"], ["ABS", "0.35", "Handbook of Surface Improvement", "first estimate"],
         "Lust"),
        ([], ["Polyurethane linings have high friction"], "No row"),
        (["--leaves", "glass", "epoxy"], ["18.6", "Accurate Plastics"], "Tokai"),
    ],
)  # fmt: skip
def test_the_command_line_prints_rows_with_their_sources(words, told, other) -> None:
    result = CliRunner().invoke(app, ["materials", *words])
    assert result.exit_code == 0, result.output
    said = " ".join(result.output.split())
    assert [word for word in told if word not in said] == []
    assert other not in said


@pytest.mark.parametrize("leaves", [[], ["--leaves"]])
def test_what_nobody_has_is_said(leaves) -> None:
    none = CliRunner().invoke(app, ["materials", *leaves, "unobtainium"])
    assert none.exit_code == 1
    assert "No row holds all of: unobtainium." in none.output


def test_the_service_and_python_say_the_same(tmp_path) -> None:
    client = TestClient(create_app(Settings(data_directory=tmp_path)), base_url="http://localhost")
    assert client.get("/friction").json() == ALL
    assert client.get("/friction", params={"words": "abs steel"}).json() == friction("abs steel")
    assert vibrafeed.friction("abs steel") == friction("abs steel")
    assert vibrafeed.leaf_springs("steel") == leaf_springs("steel")


def test_every_material_of_leaves_has_a_modulus_and_a_source() -> None:
    found = leaf_springs()
    for row in found["materials"]:
        assert 5 < row["elastic_modulus"][0] <= row["elastic_modulus"][1] < 250, row
        assert row["density"] is None or 1500 < row["density"][0] <= row["density"][1] < 8000, row
        assert found["sources"][row["source"]]["address"].startswith("http"), row
    declared = vibrafeed.core.materials._data("leaf_springs.toml")["sources"]
    assert set(declared) == {row["source"] for row in found["materials"]}


def test_glass_fibre_scatters_by_three_as_is_said() -> None:
    ranges = [row["elastic_modulus"] for row in leaf_springs("glass")["materials"]]
    assert 3 < max(most for _, most in ranges) / min(least for least, _ in ranges) < 4
    for name in ("linear-drive-unit", "bowl-drive-unit"):
        assert "elastic_modulus" not in SCENES[name].defaults, "no default where they scatter"
