"""A study with five mistakes: all five at once, each with its place, and nothing is written."""

STUDY = """
kind = "simulate"
scene = "rectangle-on-plane"
outputs = ["conveying_velocity", "sped"]

[parameters]
frequency = "50 Hzz"
amplitude = { start = "0.05 mm", stop = "0.75 mm", num = 0 }
beta = "30 mm"
friction = -0.4
"""
PLACES = {
    "outputs": "'sped'",
    "parameters.frequency": "'Hzz'",
    "parameters.amplitude": "num",
    "parameters.beta": "'mm'",
    "parameters.friction": "-0.4",
}


def test_five_mistakes_at_once(vibrafeed, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY)
    told = vibrafeed("run", "study.toml", exit_code=2)
    assert told.stdout == ""
    first, *lines = told.stderr.splitlines()
    assert "study.toml" in first
    assert "5 problems" in first
    found = dict(line.strip().split(": ", 1) for line in lines)
    assert found.keys() == PLACES.keys()
    for place, fault in PLACES.items():
        assert fault in found[place]
    assert "Traceback" not in told.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]
