"""Studies of a part from a file: what they give, what they keep, and bad files."""

from __future__ import annotations

import base64
import json

import numpy as np
import pytest
import trimesh

import vibrafeed
from surfaces import as_data, as_step, box
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, parse_study, prepare_content
from vibrafeed.core.intake.part import read_part
from vibrafeed.core.kinds import run_study

SHARES = ["let_down_share", "thrown_share"]
SIZES = {"length": "30 mm", "width": "20 mm", "height": "10 mm"}
ARRIVING = {"arrival_rate": 300, "wanted_aspect": 1}
LINES = (
    {"turned_share_1": 0.6, "wiper_height_2": "12 mm"},
    {"ledge_width_1": "6 mm", "delta": 10, "turned_share_1": 0.3, "gap_length_2": "12 mm",
     "outlet_capacity_3": 150},
    {"turned_share_1": 0.3, "turn_1": 12, "passed_aspect_2": 1, "wiper_height_3": "25 mm",
     "device_order": 4},
)  # fmt: skip


def resting(part, outputs=SHARES, **more):
    return vibrafeed.sweep(scene="resting-part", part=part, outputs=outputs, **more)


def refusal(part, **more):
    content = {"kind": "sweep", "scene": "resting-part", "outputs": SHARES, "part": part, **more}
    with pytest.raises(StudyError) as caught:
        prepare_content(content, files=True)
    return {problem.place: problem.message for problem in caught.value.problems}


def triangles(mesh):
    return np.array(mesh.triangles)


def surface(corners):
    return as_data(trimesh.Trimesh(**trimesh.triangles.to_kwargs(corners), process=False))


# --- what they give


def test_each_cell_is_an_aspect_and_sizes_are_those_of_the_box():
    found = resting(box(30, 20, 10), [*SHARES, "lying_height", "lying_length", "lying_width"])
    assert found.aspect.values.tolist() == [1, 2, 3]
    names = [f"{kind}_{name}" for kind in SHARES for name in ("flat", "on_side", "on_end")]
    closed = vibrafeed.sweep(scene="resting-part", outputs=names, **SIZES)
    for kind in SHARES:
        known = [float(closed[name]) for name in names if name.startswith(kind)]
        assert found[kind].values == pytest.approx(known, abs=1e-9)
    assert found.lying_height.values == pytest.approx([0.01, 0.02, 0.03])
    assert found.lying_length.values == pytest.approx([0.03, 0.03, 0.02])
    assert found.lying_width.values == pytest.approx([0.02, 0.01, 0.01])


def test_a_standing_box_topples_as_its_closed_form():
    outputs = ["topple_speed", "topple_slope", "rocking_friction"]
    found = resting(box(30, 20, 10), outputs, aspect=1)
    closed = vibrafeed.sweep(scene="resting-part", outputs=outputs, length="30 mm", height="10 mm")
    for name in outputs:
        assert float(found[name]) == pytest.approx(float(closed[name]), rel=1e-9)


def test_mass_and_volume_need_no_aspect():
    found = resting(box(30, 20, 10), ["part_volume", "part_mass"], part_density="7850 kg/m^3")
    assert float(found.part_volume) == pytest.approx(6e-6)
    assert float(found.part_mass) == pytest.approx(0.0471)
    assert "aspect" not in found.coords


@pytest.mark.parametrize("devices", LINES)
def test_a_line_takes_the_aspects_of_the_file(devices):
    outputs = ["yield", "yield_lower", "yield_upper", "oriented_feed_rate", "purity"]
    given = {"scene": "orienting-line", "outputs": outputs, **ARRIVING, **devices}
    found = vibrafeed.sweep(part=box(30, 20, 10), **given)
    closed = vibrafeed.sweep(**given, **SIZES)
    for name in outputs:
        assert float(found[name]) == pytest.approx(float(closed[name]), rel=1e-9)


def test_a_drop_test_replaces_the_shares_of_a_file():
    counts = {"drop_count_1": 121, "drop_count_2": 54, "drop_count_3": 25}
    outputs = ["yield", "yield_lower", "yield_upper", "yield_deviation"]
    devices = {"turned_share_1": 0.6, "wiper_height_2": "12 mm"}
    found = vibrafeed.sweep(
        scene="orienting-line", part=box(30, 20, 10), outputs=outputs, **counts, **devices
    )
    closed = vibrafeed.sweep(scene="orienting-line", outputs=outputs, **SIZES, **counts, **devices)
    for name in outputs:
        assert float(found[name]) == pytest.approx(float(closed[name]), rel=1e-9)


def test_the_best_wiper_for_a_part_from_a_file():
    found = vibrafeed.optimise(
        scene="orienting-line", part=box(30, 20, 10),
        criterion={"kind": "maximise", "output": "oriented_feed_rate"},
        variables={"wiper_height_1": {"lower": "5 mm", "upper": "35 mm"}},
        arrival_rate=300, wanted_aspect=1,
    )  # fmt: skip
    assert 0.01 <= float(found.best_wiper_height_1) <= 0.02


# --- what they keep


@pytest.mark.parametrize("kind", ["stl", "obj", "ply"])
def test_a_file_is_read_beside_its_study_and_the_result_runs_without_it(tmp_path, kind):
    file = tmp_path / f"box.{kind}"
    trimesh.creation.box((30, 20, 10)).export(file)
    study = tmp_path / "part.toml"
    study.write_text(
        'kind = "sweep"\nscene = "resting-part"\noutputs = ["thrown_share"]\n'
        f'[part]\nfile = "box.{kind}"\nunit = "mm"\n'
    )
    loaded = load_study(study)
    file.unlink()
    assert loaded.variant == "mesh"
    table = run_study(parse_study(json.loads(loaded.canonical())))
    assert table.thrown_share.values == pytest.approx([0.8586676690, 0.1303972419, 0.0109350890])
    assert f"box.{kind} (SHA-256 {loaded.part.sha256})" in table.attrs["part"]


def test_a_step_file_says_its_unit(tmp_path):
    pytest.importorskip("cascadio")
    text, sizes = as_step(trimesh.creation.box((30, 20, 10))), ["lying_height", "lying_length"]
    (tmp_path / "box.stp").write_text(text)
    known, outputs = resting(box(30, 20, 10), [*SHARES, *sizes]), [*SHARES, *sizes]
    for part in ({"data": text}, {"file": str(tmp_path / "box.stp")}):
        found = resting(part, outputs)
        for name in outputs:  # its numbers have passed through 32 bits
            assert found[name].values == pytest.approx(known[name].values, rel=1e-6)
    assert "its own unit" in refusal({"data": text, "unit": "mm"})["part.unit"]
    assert "no solid that can be read" in refusal({"data": text[: len(text) // 2]})["part.data"]
    other = {"data": text.replace("DATA;", "DATA;\n#9=DOCUMENT_FILE('other.step','','',$,'',$);")}
    assert "refers to other files" in refusal(other)["part.data"]


def test_a_binary_file_as_text():
    raw = trimesh.creation.box((30, 20, 10)).export(file_type="stl")
    found = resting({"data": base64.b64encode(raw).decode(), "unit": "mm"})
    assert found.thrown_share.values == pytest.approx(resting(box(30, 20, 10)).thrown_share.values)
    inches = resting({"data": base64.b64encode(raw).decode(), "unit": "inch"}, ["lying_height"])
    assert inches.lying_height.values[0] == pytest.approx(0.254)


@pytest.mark.parametrize(("sides", "aspects"), [(24, 2), (96, 2), (360, 2)])
def test_a_cylinder_of_32_bit_numbers_in_any_position(sides, aspects):
    mesh = trimesh.creation.cylinder(5, 14, sections=sides)
    mesh.apply_transform(trimesh.transformations.random_rotation_matrix(np.array([0.3, 0.5, 0.8])))
    mesh.apply_translation([100, -50, 30])
    raw = base64.b64encode(mesh.export(file_type="stl")).decode()
    found = resting({"data": raw, "unit": "mm"})
    assert found.sizes["aspect"] == aspects
    side = 14 / np.hypot(14, 10)
    assert found.let_down_share.values[0] == pytest.approx(side, abs=2 / sides**2)


def test_materials_and_groups_of_an_obj_file_are_one_body():
    lines = trimesh.creation.box((30, 20, 10)).export(file_type="obj").splitlines()
    grouped = [
        f"o part{k}\nusemtl paint{k}\n{line}" if line.startswith("f") else line
        for k, line in enumerate(lines)
    ]
    assert resting({"data": "\n".join(grouped), "unit": "mm"}).sizes["aspect"] == 3
    polygon = "\n".join([*lines, "f " + "1 2 3 4 " * 300_000])
    assert "is too large" in refusal({"data": polygon, "unit": "mm"})["part.data"]
    from_zero = "\n".join([*lines[:-1], "f 0/1 2 3"])
    assert "are numbered from 1" in refusal({"data": from_zero, "unit": "mm"})["part.data"]


def test_a_service_reads_no_files():
    content = {"kind": "sweep", "scene": "resting-part", "outputs": SHARES,
               "part": {"file": "bracket.stl", "unit": "mm"}}  # fmt: skip
    with pytest.raises(StudyError, match="the service cannot read the file from your computer"):
        prepare_content(content)


def test_numbers_from_the_network_are_checked():
    part = read_part(box(30, 20, 10), files=False).model_dump(mode="json")
    content = {"kind": "sweep", "scene": "resting-part", "variant": "mesh", "outputs": SHARES,
               "parameters": {"aspect": 1}}  # fmt: skip
    assert parse_study({**content, "part": part}).part.name == "data"
    for place, value in {
        ("aspects", 0, "height"): np.nan, ("volume",): np.inf, ("aspects",): [],
        ("triangles", 0, 2): 5000, ("sha256",): "x",
    }.items():  # fmt: skip
        bad = json.loads(json.dumps(part))
        *way, last = place
        section = bad
        for step in way:
            section = section[step]
        section[last] = value
        with pytest.raises(StudyError, match=f"^part.{place[0]}"):
            parse_study({**content, "part": bad})


# --- bad files


def test_bad_surfaces_are_refused():
    corners = triangles(trimesh.creation.box((30, 20, 10)))
    bad = {
        "is not closed": corners[1:],
        "inside out": corners[:, ::-1],
        "some triangles": np.concatenate([corners[:1, ::-1], corners[1:]]),
        "has 2 bodies": np.concatenate([corners, corners + 100]),
        "encloses no volume": corners * [1, 1, 0],
        "m long": corners * 1e6,
        "not finite": np.where(corners == 15, np.nan, corners),
    }
    for message, surface_ in bad.items():
        assert message in " ".join(refusal(surface(surface_)).values()), message


def test_all_faults_at_once_with_those_of_the_study():
    corners = triangles(trimesh.creation.box((30, 20, 10)))
    part = surface(np.concatenate([corners[1:], corners + 100]))
    with pytest.raises(StudyError) as caught:
        prepare_content({"kind": "sweep", "scene": "resting-part", "outputs": SHARES,
                         "part": part, "parameters": {"gravity": "x"}}, files=True)  # fmt: skip
    said = str(caught.value)
    assert "is not closed" in said
    assert "2 bodies" in said
    assert "parameters.gravity" in said


def test_units_are_asked_for():
    data = box(30, 20, 10)["data"]
    assert refusal({"data": data}) == {"part.unit": "the unit is missing"}
    assert "part.unit" in refusal({"data": data, "unit": "yard"})
    assert "part.units" in refusal({"data": data, "units": "mm", "unit": "mm"})
    assert "part" in refusal({"unit": "mm"})
    assert "part" in refusal("bracket.stl")


def test_files_that_cannot_be_read(tmp_path):
    (tmp_path / "junk.stl").write_bytes(b"hello")
    with (tmp_path / "large.stl").open("wb") as file:
        file.seek(500_000_083)
        file.write(b"\0")
    for name, message in {
        "missing.stl": "No such file", "junk.stl": "is damaged", "large.stl": "is too large",
        "bracket.iges": "is not an STL, OBJ, PLY or STEP file",
    }.items():  # fmt: skip
        assert message in refusal({"file": str(tmp_path / name), "unit": "mm"})["part.file"]


def test_a_part_goes_with_its_variant():
    assert "cannot use a part from a file" in refusal(box(3, 2, 1), variant="box", parameters={
        "length": 3, "width": 2, "height": 1})["part"]  # fmt: skip
    content = {"kind": "sweep", "scene": "resting-part", "variant": "mesh", "outputs": SHARES,
               "parameters": {"aspect": 1}}  # fmt: skip
    with pytest.raises(StudyError, match="variant mesh needs a part from a file"):
        prepare_content(content)
    with pytest.raises(StudyError, match="the part has 3 aspects"):
        resting(box(3, 2, 1), aspect=4)
    with pytest.raises(StudyError, match="passed_aspect_1: the part has 3 aspects"):
        vibrafeed.sweep(
            scene="orienting-line", part=box(3, 2, 1), outputs=["yield"], passed_aspect_1=4
        )
    with pytest.raises(StudyError, match="a study of this kind cannot use a part from a file"):
        vibrafeed.simulate(scene="rectangle-on-plane", part=box(3, 2, 1))
