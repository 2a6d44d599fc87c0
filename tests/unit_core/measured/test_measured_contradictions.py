"""Recordings as loggers write them, and those that show themselves that something is wrong.

The drive of all of them: 50 Hz, 0.3 mm along, 0.1 mm normal that lags by 0.6 rad, and gravity. A
part with friction 0.3 then travels with +56.6 mm/s (a time integration of another program).
"""

from __future__ import annotations

from datetime import datetime, timedelta

import numpy as np
import pytest

import vibrafeed
from recordings import signal_of
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
    with pytest.raises(StudyError) as caught:
        fit_drive(text, recording)
    return str(caught.value)


# --- times


@pytest.mark.parametrize(
    ("name", "factor"),
    [
        ("time_ms", 1e3), ("timestamp_ms", 1e3), ("t_us", 1e6), ("time (ms)", 1e3), ("timeMs", 1e3),
        ("Time us", 1e6), ("t_ns", 1e9), ("time_s", 1.0), ("Zeit [s]", 1.0), ("millis", 1e3),
        ("Uhr [ms]", 1e3), ("micros", 1e6), ("elapsed_ms", 1e3), ("time/ms", 1e3), ("t / s", 1.0),
        ("t in ms", 1e3),
    ],
)  # fmt: skip
def test_the_name_of_a_column_of_times_tells_their_unit(name, factor):
    is_true(fit_drive(table(SIGNAL.times * factor, head=f"{name},ax,az"), AX_AZ))


def test_the_name_of_a_channel_tells_its_unit():
    text = table(SIGNAL.times * 1e3, head="time_ms,acc_x_g,acc_z_g")
    is_true(fit_drive(text, Recording(along="acc_x_g", normal="acc_z_g")))
    text = table(SIGNAL.times, 1e3 * G, head="time_s,x_mg,z_mg")
    is_true(fit_drive(text, Recording(along="x_mg", normal="z_mg")))


@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_times_without_a_unit_that_cannot_be_seconds_are_refused(unit, factor):
    told = refused(table(SIGNAL.times * factor, head="time,ax,az"))
    if factor < 1e9:
        assert told.startswith("time: column 'time' does not say the unit of its times")
        assert (
            f"they look like {unit}. Write the unit in the heading, as in 'time [{unit}]'" in told
        )
    else:  # refused before a fit is tried
        assert "which no recorder does" in told
    known = Recording(along="ax", normal="az", unit="g", line_frequency=50)
    if factor < 1e9:
        told = refused(table(SIGNAL.times * factor, head="time,ax,az"), known)
        assert "write the unit in the heading, as in 'time [ms]'" in told


@pytest.mark.parametrize("blank", ["T", " "])
@pytest.mark.parametrize("date", [True, False])
@pytest.mark.parametrize("zone", ["", "Z"])
def test_times_after_iso_8601_are_read(blank, date, zone):
    start = datetime(2024, 2, 29, 23 if date else 3, 59, 59, 900_000)
    times = [start + timedelta(seconds=time) for time in SIGNAL.times.tolist()]
    texts = [
        (one.isoformat(blank, "microseconds") + zone)
        if date
        else one.time().isoformat("microseconds")
        for one in times
    ]
    is_true(fit_drive(table(texts), AX_AZ))


def test_times_that_cannot_be_read_say_so_once_and_name_the_rate():
    told = refused(table([f"{time:.4f} s ago" for time in SIGNAL.times]))
    assert told.startswith("time: the cells of column 'time' are not numbers and not times after")
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


# --- what stands above the numbers


@pytest.mark.parametrize(
    ("above", "head", "mark"),
    [
        ("", "#time,ax,az", ","),
        ("# Klipper\n", "# time,ax,az", ","),
        ("sep=;\n", "time;ax;az", ";"),
        ('"sep=,"\n', "time,ax,az", ","),
        ("Recorder;X1\nDate;2024-01-02\nRate;2000\n\n", "time;ax;az", ";"),
        ("Made by hand\nwith care, and more\n", "time,ax,az", ","),
        ("", "time;ax;az\ns;g;g", ";"),
        ("LabVIEW Measurement\t\nSeparator\tTab\t\nSamples\t800\t800\n***End_of_Header***\t\t\n",
         "X_Value\tax\taz\tComment", "\t"),
    ],
)  # fmt: skip
def test_names_below_a_preamble_or_behind_a_sign_are_found(above, head, mark):
    is_true(fit_drive(above + table(SIGNAL.times, head=head, mark=mark), AX_AZ))


# --- decimal marks


def test_commas_of_thousands_beside_decimal_points_are_refused():
    milli = G * GRAVITY * 1e3
    text = table(SIGNAL.times, milli, "time [s];ax [mm/s2];az [mm/s2]", ";", "{:,.0f}")
    told = refused(text, Recording(normal="az"))
    assert told.startswith("time: column 'time' has '0.0'")
    assert "\nnormal: column 'time' has '" in told
    assert "one of the two marks separates thousands" in told
    swapped = text.replace(",", "#").replace(".", ",").replace("#", ".")
    assert "one of the two marks separates thousands" in refused(swapped, Recording(normal="az"))


def test_commas_of_thousands_are_refused_without_decimals_anywhere():
    milli = np.abs(G) * GRAVITY * 1e3
    text = table(np.arange(800), milli, "time [ms];ax [mm/s2];az [mm/s2]", ";", "{:,.0f}")
    text = "\n".join(line.replace(".0;", ";") for line in text.split("\n"))
    assert "thousands are separated" in refused(text, Recording(normal="az"))


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
    path = tmp_path / "runs.csv"
    path.write_text("amplitude [mm];conveying_velocity [mm/s]\n0.1;1,234\n0.2;2,345\n")
    with pytest.raises(StudyError, match="one of the two marks separates thousands"):
        read_rows(path)
    path.write_text("amplitude [mm];conveying_velocity [mm/s]\n0,1;1,234\n0,2;2,345\n")
    assert read_rows(path)[0] == {"amplitude": "0.1 mm", "conveying_velocity": "1.234 mm/s"}
    path.write_text('amplitude,friction\n"0,1",0.3\n')
    with pytest.raises(StudyError, match="one of the two marks separates thousands"):
        read_rows(path)


# --- gravity


def along_normal(along, normal):
    """Return the accelerations of the drive with other constants, in g."""
    return G + np.array([[along], [normal - 1.0]])


@pytest.mark.parametrize(
    ("values", "unit", "says"),
    [
        (
            G * [[1], [-1]],
            "g",
            "normal channel is -1 g (and 0.00 g along): the channel points down",
        ),
        (along_normal(0.0, 0.5), "g", "normal channel is 0.5 g"),
        (along_normal(0.0, -0.5), "g", "normal channel is -0.5 g"),
        (G[::-1], "g", "along channel is 1 g (and 0.00 g normal): gravity belongs to the normal"),
        (G, "m/s2", "it would be 1 g if the values were in g rather than in m s-2"),
        (G * GRAVITY, "g", "it would be 1 g if the values were in m s-2 rather than in g"),
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
    fit_drive(plain(G), Recording(along="ax"))


@pytest.mark.parametrize(
    ("along", "normal"),
    [(0.0, 0.0), (0.02, -0.05), (0.0, 1.05), (np.sin(0.2), np.cos(0.2)), (-0.1, 0.95)],
)
def test_tilt_offsets_and_sensors_without_constants_are_allowed(along, normal):
    is_true(fit_drive(plain(along_normal(along, normal)), Recording(along="ax", normal="az")))


def test_three_axes_show_a_sensor_upside_down_and_turning_it_mends_it():
    across = 1e-3 * np.random.default_rng(1).normal(size=(1, 800))
    values = np.vstack([G[:1], across, -G[1:]])
    text = table(SIGNAL.times, values, "time [s],ax [g],ay [g],az [g]")
    told = refused(text, Recording(sensor=("ax", "ay", "az")))
    assert "points downwards" in told
    assert "a minus sign in front of the column's name" in told
    is_true(fit_drive(text, Recording(sensor=("ax", "ay", "-az"))))
    is_true(fit_drive(text, Recording(sensor=("ax", "-ay", "az"), mounting=(0, 0, 180))))


def study(text, **parameters):
    """Return a study of a recording."""
    drive = {"data": text, "along": "ax", "normal": "az"}
    return {
        "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
        "drive": drive, "parameters": {"friction": 0.3, **parameters},
    }  # fmt: skip


def test_a_stated_climb_is_where_gravity_belongs():
    steep = plain(along_normal(np.sin(0.6), np.cos(0.6)))
    with pytest.raises(StudyError, match="the track would climb by 34 degrees"):
        prepare_content(study(steep))
    assert prepare_content(study(steep, gamma="34.4 deg")).questions == ()
    (asked,) = prepare_content(study(plain(along_normal(np.sin(0.2), np.cos(0.2))))).questions
    assert "climbs by 11.5 degrees, the study computes with gamma = 0 degrees" in asked


def test_times_in_whole_milliseconds_are_even_and_a_gap_is_none():
    """A recorder of 800 samples a second that writes whole milliseconds has steps of 1 and 2."""
    signal = signal_of(TRUE, rate=800.0, count=800)
    values = signal.values / GRAVITY + np.array([[0.0], [1.0]])
    is_true(fit_drive(table(np.floor(signal.times * 1e3), values, "time_ms,ax,az"), AX_AZ))
    gap = np.r_[0:280, 520:800]
    with_gap = fit_drive(table(signal.times[gap], values[:, gap]), AX_AZ)
    assert with_gap.samples == 280
    is_true(with_gap)
    lost = np.sort(np.random.default_rng(1).choice(800, 640, replace=False))
    assert "not evenly spaced" in refused(table(signal.times[lost], values[:, lost]))


# --- what a feeder can be


def test_fitted_numbers_are_judged_as_typed_ones():
    drive = study(table(SIGNAL.times * 1e3, head="time [s],ax [g],az [g]"))
    (asked,) = prepare_content(drive).questions
    assert asked.startswith(
        "frequency = 0.05 Hz, fitted to data, is unusual; usual values are 1 to"
    )
    assert asked.endswith("With times in ms it would be 50 Hz.")
    with pytest.warns(UserWarning, match="With times in ms it would be 50 Hz"):
        vibrafeed.study(drive)
    slow = study(plain(G * 100 * [[1.0], [0.0]] + [[0.0], [1.0]]))
    (asked,) = prepare_content(slow).questions
    assert asked.startswith("amplitude_along_1 = 30 mm, fitted to data, is unusual; usual values")


def test_channels_that_do_not_move_as_a_feeder_does_are_asked_about():
    """Along and across were mixed up: 0 mm/s, and nobody was told."""
    noise = np.random.default_rng(1).normal(0.0, 1e-3, SIGNAL.times.size)
    text = table(SIGNAL.times, [G[0], noise, G[1]], "time [s],ax [g],ay [g],az [g]")

    def asked(**channels):
        return prepare_content({**study(""), "drive": {"data": text, **channels}}).questions

    along, normal = (
        f"the recording's {axis} channel shows no motion of the drive. Is it the right column?"
        for axis in ("along", "normal")
    )
    across = "the recording moves most across the track. Are the names of the channels, or the "
    assert asked(along="ay", normal="az") == (along,)
    assert asked(along="ax", normal="ay") == (normal,)
    for channels in (
        {"along": "ay", "across": "ax", "normal": "az"},
        {"sensor": ["ay", "-ax", "az"]},
    ):
        assert asked(**channels) == (along, across + "mounting, right?")
    assert asked(along="ax", normal="az") == asked(sensor=["ax", "ay", "az"]) == ()
    level = table(SIGNAL.times, [G[0], 1.0 + noise], "time [s],ax [g],az [g]")
    assert prepare_content(study(level)).questions == ()  # gravity shows that it is the normal one


def test_observed_numbers_are_judged_as_typed_ones(tmp_path):
    path = tmp_path / "runs.csv"
    path.write_text("amplitude,conveying_velocity [mm/s]\n" + "0.3,20\n0.4,30\n")
    (asked,) = questions({"observations": read_rows(path)})
    assert asked.startswith("amplitude = 0.4 means 400 mm; usual values are")
    path.write_text("amplitude [mm],conveying_velocity [mm/s]\n" + "0.3,20\n0.4,30\n")
    assert questions({"observations": read_rows(path)}) == []


def test_the_speed_is_the_one_of_the_drive():
    text = table(SIGNAL.times * 1e3, head="time_ms,ax [g],az [g]")
    speed = vibrafeed.simulate(study(text)).conveying_velocity
    assert float(speed) == pytest.approx(56.6e-3, abs=0.05e-3)


# --- the line of the stroke


@pytest.mark.parametrize("lag", [0.0, 0.6, 1.5, 2.5, np.pi])
def test_the_stroke_is_the_longest_way_of_the_track(lag):
    fit = fit_drive(plain(signal_of({**TRUE, "normal": [(1e-4, -lag)]}).values / GRAVITY),
                    Recording(along="ax", normal="az"))  # fmt: skip
    places = fit.displacement(np.linspace(0, 2 * np.pi, 20_001)).T
    sizes = np.hypot(*places.T)
    farthest = places[sizes.argmax()] * np.sign(places[sizes.argmax()][0])
    assert fit.stroke.major == pytest.approx(sizes.max(), rel=1e-6)
    assert fit.stroke.minor == pytest.approx(sizes.min(), abs=1e-7)
    assert fit.stroke.angle == pytest.approx(np.arctan2(*farthest[::-1]), abs=1e-3)
