"""Recordings in the files of recorders and spreadsheets, and channels of other kinds."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.io import savemat, wavfile

from vibrafeed.core.errors import StudyError
from vibrafeed.core.measured import Recording, fit_drive, read_signal

GRAVITY = 9.80665
RATE = 2000.0
TIMES = np.arange(800) / RATE
TURN = 2.0 * np.pi * 50.0
WAVES = {"along": (3e-4, 0.0), "normal": (1e-4, -0.6)}


def channels(derivative):
    """Return time and the two channels of the drive, its displacement differentiated."""
    sines = [
        size * TURN**derivative * np.sin(TURN * TIMES + phase + derivative * np.pi / 2.0)
        for size, phase in WAVES.values()
    ]
    return np.array([TIMES, sines[0], sines[1] + GRAVITY * (derivative == 2)])


def is_true(source, along="ax", normal="az", **more):
    """Check that a fit of a source finds the drive."""
    fit = fit_drive(source, Recording(along=along, normal=normal, **more))
    found = fit.parameters()
    assert fit.frequency == pytest.approx(50.0, rel=1e-6)
    assert found["amplitude_along_1"] == pytest.approx(3e-4, rel=1e-3)
    assert found["amplitude_normal_1"] == pytest.approx(1e-4, rel=1e-3)
    lag = found["phase_normal_1"] - found["phase_along_1"]
    assert lag == pytest.approx(-np.degrees(0.6), abs=0.1)
    return fit


def text(values, units=("g", "g")):
    """Return channels as CSV."""
    head = f"time [s],ax [{units[0]}],az [{units[1]}]"
    return "\n".join([head, *(",".join(map(repr, row)) for row in values.T.tolist())])


def test_a_workbook(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook(write_only=True)
    sheet = book.create_sheet()
    sheet.append(["Recorder X1"])
    sheet.append(["Zeit [s]", "ax [m/s2]", "az [m/s2]", "Bemerkung"])
    for row in channels(2).T.tolist():
        sheet.append(row)
    book.save(tmp_path / "drive.xlsx")
    is_true(tmp_path / "drive.xlsx")


def test_matlab(tmp_path):
    time, ax, az = channels(2)
    savemat(tmp_path / "drive.mat", {"t": time[:, None], "ax": ax, "az": az, "title": "made"})
    is_true(tmp_path / "drive.mat", unit="m/s2")
    savemat(tmp_path / "matrix.mat", {"data": channels(2).T})
    is_true(tmp_path / "matrix.mat", "data_2", "data_3", unit="m/s2", time="data_1")


@pytest.mark.parametrize("kind", [np.int16, np.int32, np.float32])
def test_sound(tmp_path, kind):
    shares = channels(2)[1:].T / (8.0 * GRAVITY)
    scaled = shares if kind is np.float32 else shares * 2.0 ** (8 * kind().itemsize - 1)
    wavfile.write(tmp_path / "drive.wav", int(RATE), scaled.astype(kind))
    is_true(tmp_path / "drive.wav", "1", "2", scale="8 g")
    is_true(tmp_path / "drive.wav", "1", "2", scale="0.8 V", sensitivity="100 mV/g")
    with pytest.raises(StudyError, match="shares of a full scale that is not given"):
        is_true(tmp_path / "drive.wav", "1", "2")


def test_tdms(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    properties = {"wf_increment": 1.0 / RATE, "unit_string": "g"}
    with nptdms.TdmsWriter(tmp_path / "drive.tdms") as file:
        for name, values in zip(("ax", "az"), channels(2)[1:] / GRAVITY, strict=True):
            file.write_segment([nptdms.ChannelObject("group", name, values, properties)])
    is_true(tmp_path / "drive.tdms")


def test_uff(tmp_path):
    pyuff = pytest.importorskip("pyuff")
    path = tmp_path / "drive.uff"
    for name, values in zip(("ax", "az"), channels(2)[1:], strict=True):
        one = pyuff.prepare_58(
            binary=0, func_type=1, rsp_node=1, rsp_dir=1, ref_dir=1, ref_node=1, data=values,
            x=TIMES, id1=name, rsp_ent_name="track", ref_ent_name="none", abscissa_spacing=1,
            abscissa_spec_data_type=17, ordinate_spec_data_type=12, orddenom_spec_data_type=0,
            ordinate_axis_units_lab="m/s^2",
        )  # fmt: skip
        pyuff.UFF(str(path)).write_sets(one, "add")
    is_true(path)


@pytest.mark.parametrize("comma", [False, True])
@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
def test_labview(comma, columns):
    time, ax, az = (map("{:.6f}".format, row) for row in channels(2).tolist())
    names = "X_Value\tax\tX_Value\taz" if columns == "Multi" else "X_Value\tax\taz"
    rows = [
        {"No": f"\t{a}\t{n}", "One": f"{t}\t{a}\t{n}", "Multi": f"{t}\t{a}\t{t}\t{n}"}[columns]
        for t, a, n in zip(time, ax, az, strict=True)
    ]
    head = [
        "LabVIEW Measurement\t", "Separator\tTab", f"X_Columns\t{columns}", "***End_of_Header***\t",
        "\t", "Channels\t2\t\t", "Samples\t800\t800\t", "Y_Unit_Label\tm/s^2\tm/s^2\t",
        "Delta_X\t0.000500\t0.000500\t", "***End_of_Header***\t\t\t", names + "\tComment",
    ]  # fmt: skip
    source = "\n".join([*head, *rows])
    is_true(source.replace(".", ",") if comma else source)


@pytest.mark.parametrize(
    ("derivative", "units", "factor"),
    [(2, "m/s2", 1.0), (1, "mm/s", 1e3), (1, "m/s", 1.0), (0, "um", 1e6), (0, "mm", 1e3)],
)
def test_channels_may_be_accelerations_velocities_or_displacements(derivative, units, factor):
    values = channels(derivative)
    values[1:] *= factor
    fit = is_true(text(values, (units, units)))
    np.testing.assert_allclose(
        fit.fold().residual, 0.0, atol=1e-9 * np.abs(fit.signal.values).max()
    )
    assert (fit.tilt is not None) is (derivative == 2)


def test_the_errors_of_all_kinds_of_channels_are_honest():
    """The same noise, as a share of the drive, gives the same share of error."""
    rng = np.random.default_rng(1)
    shares = []
    for derivative in (2, 1, 0):
        values = channels(derivative)
        size = values[1].std()
        values[1:] += 0.02 * size * rng.standard_normal((2, 800))
        units = (("m", "m/s", "m/s2")[derivative],) * 2
        fit = fit_drive(text(values, units), Recording(along="ax", normal="az"))
        shares.append(fit.amplitude_errors[0, 0] / fit.amplitudes[0, 0])
        assert abs(fit.amplitudes[0, 0] - 3e-4) < 4.0 * fit.amplitude_errors[0, 0]
    np.testing.assert_allclose(shares, 0.02 / np.sqrt(800), rtol=0.3)


@pytest.mark.parametrize(
    ("unit", "factor", "sensitivity"),
    [("V", 0.1, "100 mV/g"), ("mV", 100.0, "100 mV/g"), ("mV", 100.0, "0.1 V per g"),
     ("V", 0.1, "10.19716 mV/(m/s2)"), ("LSB", 16384.0, "16384 LSB/g"),
     ("counts", 16384.0, "16384 counts/g")],
)  # fmt: skip
def test_volts_and_counts_with_a_sensitivity(unit, factor, sensitivity):
    values = channels(2)
    values[1:] *= factor / GRAVITY
    is_true(text(values, (unit, unit)), sensitivity=sensitivity)


def test_kinds_are_not_mixed_and_volts_need_a_sensitivity():
    with pytest.raises(StudyError, match="the columns are different quantities"):
        read_signal(text(channels(2), ("m/s2", "mm")), Recording(along="ax", normal="az"))
    with pytest.raises(StudyError, match="column 'ax' is a voltage"):
        read_signal(text(channels(2), ("V", "V")), Recording(along="ax"))
    with pytest.raises(StudyError, match="is not a sensitivity for channels in V"):
        read_signal(text(channels(2), ("V", "V")), Recording(along="ax", sensitivity="5 pC/g"))
