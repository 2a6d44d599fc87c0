"""Recordings as loggers write them, and those that show themselves that something is wrong.

The drive of all of them: 50 Hz, 0.3 mm along, 0.1 mm normal that lags by 0.6 rad, and gravity. A
part with friction 0.3 then travels with +56.6 mm/s (a time integration of another program).
"""

from datetime import datetime, timedelta

import numpy as np
import pytest

from night import spread
from recordings import signal_of
from refusals import words_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.intake.sections import read_rows
from vibrafeed.core.measured import Recording, fit_drive
from vibrafeed.core.study.unusual import questions
from vibrafeed.core.tables.text import contradictions

GRAVITY = 9.80665
TRUE = {"along": [(3e-4, 0.0)], "normal": [(1e-4, -0.6)]}
SIGNAL = signal_of(TRUE)
G = SIGNAL.values / GRAVITY + np.array([[0.0], [1.0]])
AX_AZ = Recording(along="ax", normal="az", unit="g")


def table(times, values=G, head="time,ax,az", mark=",", form="{:.6f}"):
    """Return a recording as text: a row for each time and the values of its channels."""
    rows = [
        mark.join([time if isinstance(time, str) else repr(float(time)), *map(form.format, cells)])
        for time, cells in zip(times, np.array(values).T.tolist(), strict=True)
    ]
    return "\n".join([head, *rows]) + "\n"


def plain(values, unit="g"):
    """Return a recording with times in seconds."""
    return table(SIGNAL.times, values, f"time [s],ax [{unit}],az [{unit}]")


def is_true(fit):
    """Check that a fit has found the drive."""
    assert fit.frequency == pytest.approx(50.0, rel=1e-5)
    found = fit.parameters()
    assert found["amplitude_along_1"] == pytest.approx(3e-4, rel=1e-4)
    assert found["amplitude_normal_1"] == pytest.approx(1e-4, rel=1e-4)
    assert found["phase_normal_1"] == pytest.approx(-np.degrees(0.6), abs=0.01)


def refused(text, recording=AX_AZ):
    """Return the problems of a recording, as a user reads them."""
    return words_of(fit_drive, text, recording)


# --- times


@pytest.mark.parametrize(
    ("name", "factor"),
    spread(
        [
            ("time_ms", 1e3), ("t_us", 1e6), ("time (ms)", 1e3), ("timeMs", 1e3), ("Time us", 1e6),
            ("t_ns", 1e9), ("Zeit [s]", 1.0), ("millis", 1e3), ("Uhr [ms]", 1e3), ("micros", 1e6),
            ("elapsed_ms", 1e3), ("time/ms", 1e3), ("t / s", 1.0), ("t in ms", 1e3),
        ],
        7,
    ),
)  # fmt: skip
def test_the_name_of_a_column_of_times_tells_their_unit(name, factor):
    is_true(fit_drive(table(SIGNAL.times * factor, head=f"{name},ax,az"), AX_AZ))


def test_the_name_of_a_channel_tells_its_unit():
    text = table(SIGNAL.times, 1e3 * G, head="time_s,x_mg,z_mg")
    is_true(fit_drive(text, Recording(along="x_mg", normal="z_mg")))


@pytest.mark.parametrize(
    ("unit", "factor", "line", "words"),
    [
        ("ms", 1e3, None,
         "so the unit is probably ms. Write the unit in the heading, as in 'time [ms]'"),
        ("us", 1e6, 50, "write the unit in the heading, as in 'time [ms]'"),
        ("ns", 1e9, None, "seems to have one sample every"),  # refused before a fit is tried
    ],
)  # fmt: skip
def test_times_without_a_unit_that_cannot_be_seconds_are_refused(unit, factor, line, words):
    recording = Recording(along="ax", normal="az", unit="g", line_frequency=line)
    assert words in refused(table(SIGNAL.times * factor, head="time,ax,az"), recording)


@pytest.mark.parametrize(
    ("blank", "date", "zone"), [("T", True, "Z"), (" ", True, ""), ("T", False, "")]
)
def test_times_after_iso_8601_are_read(blank, date, zone):
    start = datetime(2024, 2, 29, 23 if date else 3, 59, 59, 900_000)
    times = [start + timedelta(seconds=time) for time in SIGNAL.times.tolist()]
    texts = [one.isoformat(blank, "microseconds") + zone for one in times]
    is_true(fit_drive(table(texts if date else [text[11:] for text in texts]), AX_AZ))


def test_times_that_cannot_be_read_say_so_once_and_name_the_rate():
    told = refused(table([f"{time:.4f} s ago" for time in SIGNAL.times]))
    assert told.startswith("time: the cells of column 'time' are neither numbers nor times of")
    assert "Give rate = the samples per second" in told
    assert "\n" not in told


@pytest.mark.parametrize("share", [1 / 800, 0.02])
def test_lost_samples_move_nothing(share):
    kept = np.random.default_rng(1).random(800) > share
    kept[[0, -1]] = True
    kept[333] = False
    text = table(SIGNAL.times[kept], G[:, kept], head="time [s],ax,az")
    is_true(fit_drive(text, AX_AZ))


def test_a_logger_that_is_late_is_fitted_at_its_true_times():
    """As a loop on a small computer: steps of 1 ms, of which 2 % take 2 to 4 ms."""
    rng = np.random.default_rng(2)
    steps = np.where(rng.random(1000) < 0.02, rng.uniform(2e-3, 4e-3, 1000), 1e-3)
    times = np.cumsum(steps).round(6)
    turning = 2 * np.pi * 50.0
    values = [
        -amplitude * turning**2 * np.sin(turning * times + phase) / GRAVITY
        for ((amplitude, phase),) in TRUE.values()
    ]
    values[1] = values[1] + 1.0
    is_true(fit_drive(table(times, values, head="time [s],ax,az"), AX_AZ))


def test_commas_of_thousands_are_refused():
    milli, head = np.abs(G) * GRAVITY * 1e3, "time [ms];ax [mm/s2];az [mm/s2]"
    text = table(np.arange(800), milli, head, ";", "{:,.0f}")
    swapped = text.replace(",", "#").replace(".", ",").replace("#", ".")
    for one in (text, swapped):  # beside decimals of the times
        assert "one of the two marks separates thousands" in refused(one, Recording(normal="az"))
    whole = text.replace(".0;", ";")  # without decimals anywhere
    assert "thousands are separated" in refused(whole, Recording(normal="az"))


# --- decimal marks


@pytest.mark.parametrize(
    ("cells", "fine"),
    [
        (["9,807", "14,742"], True), (["9,807", "0,742"], True), (["9,807", "742"], False),
        (["9,80", "742"], True), (["9,807", "7421"], True), (["9,807", "9.8"], False),
        (["1.234,5", "9"], True), (["9.807", "742"], False), (["it hums, loudly", "1.2"], True),
    ],
)  # fmt: skip
def test_marks_of_one_column(cells, fine):
    """A cell with both marks is no number, which is told where it is read."""
    assert (not contradictions({"a": cells})) is fine


def test_observations_have_one_decimal_mark(tmp_path):
    path, head = tmp_path / "runs.csv", "amplitude [mm];conveying_velocity [mm/s]\n"
    path.write_text(head + "0.1;1,234\n0.2;2,345\n")
    with pytest.raises(StudyError, match="one of the two marks separates thousands"):
        read_rows(path)
    path.write_text(head + "0,1;1,234\n0,2;2,345\n")
    assert read_rows(path)[0] == {"amplitude": "0.1 mm", "conveying_velocity": "1.234 mm/s"}


# --- gravity


def along_normal(along, normal):
    """Return the accelerations of the drive with other constants, in g."""
    return G + np.array([[along], [normal - 1.0]])


@pytest.mark.parametrize(
    ("values", "unit", "says"),
    [
        (G * [[1], [-1]], "g", "is -1 g (and 0.00 g along): the channel points down"),
        (along_normal(0.0, 0.5), "g", "normal channel is 0.5 g"),
        (G[::-1], "g", "along channel is 1 g (and 0.00 g normal): gravity belongs to the normal"),
        (G, "m/s2", "it would be 1 g if the values were in g rather than in m s-2"),
        (G * GRAVITY, "mm/s2", "commas that separate thousands"),
        (G * 1e3, "g", "it would be 1 g if the values were a thousandth"),
        (along_normal(0.6, 0.8), "g", "the track would climb by 37 degrees"),
        (along_normal(0.3, 0.0), "g", "along channel is 0.3 g (and 0.00 g normal)"),
    ],
)
def test_constants_that_contradict_gravity_are_refused(values, unit, says):
    assert says in refused(plain(values, unit), Recording(along="ax", normal="az"))


def test_one_channel_is_compared_with_gravity_too():
    assert "gravity belongs to the normal channel" in refused(plain(G), Recording(along="az"))
    assert "points downwards" in refused(plain(G), Recording(normal="-az"))


@pytest.mark.parametrize(
    ("along", "normal"), [(0.0, 0.0), (0.02, -0.05), (np.sin(0.2), np.cos(0.2))]
)
def test_tilt_offsets_and_sensors_without_constants_are_allowed(along, normal):
    is_true(fit_drive(plain(along_normal(along, normal)), Recording(along="ax", normal="az")))


def test_three_axes_show_a_sensor_upside_down_and_turning_it_mends_it():
    across = 1e-3 * np.random.default_rng(1).normal(size=(1, 800))
    values = np.vstack([G[:1], across, -G[1:]])
    text = table(SIGNAL.times, values, "time [s],ax [g],ay [g],az [g]")
    told = refused(text, Recording(sensor=("ax", "ay", "az")))
    assert "a minus sign in front of the column's name" in told
    is_true(fit_drive(text, Recording(sensor=("ax", "-ay", "az"), mounting=(0, 0, 180))))


def study(text, **parameters):
    """Return a study of a recording."""
    drive = {"data": text, "along": "ax", "normal": "az"}
    return {
        "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
        "drive": drive, "parameters": {"friction": 0.3, **parameters},
    }  # fmt: skip


def test_times_in_whole_milliseconds_are_even_and_the_longest_piece_beside_a_gap_counts():
    """A recorder of 800 samples a second that writes whole milliseconds has steps of 1 and 2."""
    signal = signal_of(TRUE, rate=800.0, count=800)
    values = signal.values / GRAVITY + np.array([[0.0], [1.0]])
    is_true(fit_drive(table(np.floor(signal.times * 1e3), values, "time_ms,ax,az"), AX_AZ))
    lost = np.sort(np.random.default_rng(1).choice(800, 640, replace=False))
    # Every fifth sample is lost, at random; up to three in a row.
    assert "not evenly spaced: steps are 1.25 to 5 ms, usually 1.25 ms; " in refused(
        table(signal.times[lost], values[:, lost], "time [s],ax,az")
    )
    kept = np.r_[0:280, 520:800]
    fit = fit_drive(table(signal.times[kept], values[:, kept]), AX_AZ)
    is_true(fit)
    assert fit.samples == 280


# --- what a feeder can be


@pytest.mark.parametrize(
    ("text", "parameters", "words"),
    [
        (plain(G), {}, ()),
        *((table(SIGNAL.times * factor, head="time [s],ax [g],az [g]"), {},
           (f"frequency = {50 / factor:,.6g} Hz, fitted to data, is unusual; usual values are 1 to",
            f"With times in {unit} it would be 50 Hz."))
          for unit, factor in (("ms", 1e3), ("us", 1e6), ("min", 1 / 60))),
        (plain(G * 100 * [[1.0], [0.0]] + [[0.0], [1.0]]), {},
         ("amplitude_along_1 = 30 mm, fitted to data, is unusual; usual values",)),
        # Where gravity belongs.
        (plain(along_normal(np.sin(0.2), np.cos(0.2))), {},
         ("climbs by 11.5 degrees, the study computes with gamma = 0 degrees",)),
        (plain(along_normal(np.sin(0.6), np.cos(0.6))), {"gamma": "34.4 deg"}, ()),
    ],
)  # fmt: skip
def test_fitted_numbers_are_judged_as_typed_ones(text, parameters, words):
    asked = prepare_content(study(text, **parameters)).questions
    assert len(asked) == bool(words)
    assert all(word in asked[0] for word in words)


def test_channels_that_do_not_move_as_a_feeder_does_are_asked_about():
    """Along and across were mixed up: 0 mm/s, and nobody was told."""
    noise = np.random.default_rng(1).normal(0.0, 1e-3, SIGNAL.times.size)
    text = table(SIGNAL.times, [G[0], noise, G[1]], "time [s],ax [g],ay [g],az [g]")
    along, normal = (
        f"the recording's {axis} channel shows no motion of the drive. Is it the right column?"
        for axis in ("along", "normal")
    )
    across = (
        "the recording moves most across the track. Are the names of the channels, or the "
        "mounting, right?"
    )
    for channels, expected in (
        ({"along": "ay", "normal": "az"}, (along,)),
        ({"along": "ax", "normal": "ay"}, (normal,)),
        ({"along": "ay", "across": "ax", "normal": "az"}, (along, across)),
        ({"sensor": ["ay", "-ax", "az"]}, (along, across)),
        ({"sensor": ["ax", "ay", "az"]}, ()),
    ):
        content = {**study(""), "drive": {"data": text, **channels}}
        assert prepare_content(content).questions == expected
    level = table(SIGNAL.times, [G[0], 1.0 + noise], "time [s],ax [g],az [g]")
    assert prepare_content(study(level)).questions == ()  # gravity shows that it is the normal one


def test_observed_numbers_are_judged_as_typed_ones(tmp_path):
    path = tmp_path / "runs.csv"
    path.write_text("amplitude,conveying_velocity [mm/s]\n" + "0.3,20\n0.4,30\n")
    (asked,) = questions({"observations": read_rows(path)})
    assert asked.startswith("amplitude = 0.4 means 400 mm; usual values are")


# --- the line of the stroke


@pytest.mark.parametrize("lag", [0.0, 0.6, 1.5, np.pi])
def test_the_stroke_is_the_longest_way_of_the_track(lag):
    fit = fit_drive(plain(signal_of({**TRUE, "normal": [(1e-4, -lag)]}).values / GRAVITY),
                    Recording(along="ax", normal="az"))  # fmt: skip
    places = fit.displacement(np.linspace(0, 2 * np.pi, 20_001)).T
    sizes = np.hypot(*places.T)
    farthest = places[sizes.argmax()] * np.sign(places[sizes.argmax()][0])
    expected = [sizes.max(), sizes.min(), np.arctan2(*farthest[::-1])]
    found = [fit.stroke.major, fit.stroke.minor, fit.stroke.angle]
    assert (np.abs(np.subtract(found, expected)) < [1e-9, 1e-7, 1e-3]).all()
