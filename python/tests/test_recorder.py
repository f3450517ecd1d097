"""The recorder on a run: its stream is what `iqfoc record` reads, and holds the cycles that the run returned."""

import subprocess

import numpy as np
import pytest

import iqfoc

# Of Q7.24: the base of each unit, 2^-24 of it, and half a step of rounding.
STEP = 2.0 ** -25


def run(motor, cycles=400, effects=(), **choice):
    plant, cycle, recorder = iqfoc.Drive(motor, effects).plant(), iqfoc.Cycle(motor), iqfoc.Recorder(motor, **choice)
    plant.set_speed(1000.0)
    cycle.reference(0.0, 5.0)
    return cycle.run(plant, cycles, recorder), recorder


def same(recording, rows, which, motor):
    base = {"A": motor.I_base_A, "V": motor.u_dc_V, "s": 2.0 * np.pi / motor.T_s, "d": 2.0 * np.pi}
    for name in set(recording) & set(rows) - {"t_s"}:
        error = recording[name] - rows[name][which]
        if name == "theta_e_rad":
            error = np.remainder(error + np.pi, 2.0 * np.pi) - np.pi
        assert np.abs(error).max() <= 1.02 * STEP * base.get(name[-1], 1.0), name


def test_every_cycle_arrives(motor):
    rows, recorder = run(motor, columns=(*iqfoc.recorder.COLUMNS, "i_a_mid_A", "i_b_mid_A", "i_c_mid_A"))
    recording = iqfoc.read_stream(recorder.stop())
    assert recorder.finished and recorder.lost == 0 and recording.rows == 400
    assert {"i_c_mid_A", "d_c", "u_dc_V"} <= set(recording)
    same(recording, rows, slice(None), motor)
    assert np.abs(recording["t_s"] - motor.T_s * np.arange(400)).max() < 1e-9
    assert recording.T_s == pytest.approx(motor.T_s, rel=1e-8)


def test_the_program_reads_the_stream(program, motor, tmp_path):
    _, recorder = run(motor)
    (tmp_path / "stream.bin").write_bytes(recorder.stop())
    subprocess.run([program, "record", "--port", tmp_path / "stream.bin", "-o", tmp_path / "r.csv"], check=True, capture_output=True)
    assert iqfoc.Recording(tmp_path / "r.csv") == iqfoc.read_stream(tmp_path / "stream.bin")


def test_a_diagnosis_of_the_stream(motor):
    """The drive has more resistance than its motor file; the stream shows it."""
    plant, cycle, recorder = iqfoc.Drive(motor, "resistance:R=0.95").plant(), iqfoc.Cycle(motor), iqfoc.Recorder(motor)
    rng = np.random.default_rng(3)
    before = 300.0
    for speed in (300.0, 1200.0, -900.0):
        for on_the_way in np.linspace(before, speed, 100):  # a rotor does not jump
            plant.set_speed(on_the_way)
            cycle.run(plant, 1, recorder)
        before = speed
        for _ in range(30):
            cycle.reference(*rng.uniform(-6.0, 6.0, 2))
            cycle.run(plant, 20, recorder)
    found = iqfoc.diagnose(iqfoc.read_stream(recorder.stop()), motor)
    resistance, = (c for c in found.causes if c.id == "resistance")
    low, high = resistance["R"].ci95
    # Without noise the tolerances of the motor file's other values hardly count; the interval is narrow all the same.
    assert low <= 0.95 <= high and high - low < 0.05


def test_triggers(motor):
    """One full memory around the moment: a level, and a status bit."""
    plant, cycle = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor)
    recorder = iqfoc.Recorder(motor, rows=100, trigger="rises", trigger_column="i_a_A", level=3.0, pre_share=0.25)
    cycle.reference(0.0, 0.0)
    cycle.run(plant, 300, recorder)
    assert not recorder.finished
    cycle.reference(6.0, 0.0)
    rows = cycle.run(plant, 300, recorder)
    recording = iqfoc.read_stream(recorder.stream)
    first = int(np.argmax(rows["i_a_A"] >= 3.0))
    assert recorder.finished and recording.rows == 100
    assert recording["i_a_A"][25] >= 3.0 > recording["i_a_A"][24]
    same({n: c[25:] for n, c in recording.items()}, rows, slice(first, first + 75), motor)

    recorder, cycle = iqfoc.Recorder(motor, rows=50, trigger="status", status="VOLTAGE_LIMIT"), iqfoc.Cycle(motor)
    cycle.run(plant, 300, recorder)
    assert recorder.stream == b""
    plant.set_speed(3500.0)
    cycle.run(plant, 300, recorder)
    assert iqfoc.read_stream(recorder.stream).rows == 50


def test_a_slow_line_loses_rows_and_says_so(motor):
    rows, recorder = run(motor, cycles=2000, rows=20, octets_per_cycle=25)
    recording = iqfoc.read_stream(recorder.stop())
    assert recorder.lost > 0 and 0 < recording.rows == 2000 - recorder.lost
    assert f"{recorder.lost} rows lost on the target" in recording.notes[0]
    kept = np.rint(recording["t_s"] / motor.T_s).astype(int)
    same(recording, rows, kept, motor)
    assert recording["run"].max() > 1


def test_decimation_and_a_second_stream(motor):
    plant, cycle, recorder = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor), iqfoc.Recorder(motor, decimation=4)
    cycle.reference(0.0, 2.0)
    cycle.run(plant, 100, recorder)
    recorder.arm()
    cycle.run(plant, 100, recorder)
    decimated = iqfoc.read_stream(recorder.stop())
    assert decimated.rows == 50 and decimated.T_s == pytest.approx(4 * motor.T_s)
    recorder = iqfoc.Recorder(motor)
    cycle.run(plant, 50, recorder)
    recorder.arm()
    cycle.run(plant, 30, recorder)
    assert np.unique(iqfoc.read_stream(recorder.stop())["run"]).size == 2


def test_refusals(motor, tmp_path):
    for choice, words in ((dict(columns=["torque_Nm"]), "torque_Nm"), (dict(trigger="soon"), "no trigger"), (dict(rows=1), "rows = 1"),
                          (dict(trigger="status"), "expected names"), (dict(trigger="status", status="LATER"), "no status 'LATER'"),
                          (dict(trigger="rises"), "trigger_column"), (dict(pre_share=1.0), "pre_share"), (dict(columns=[]), "1 to 16")):
        with pytest.raises(ValueError, match=words):
            iqfoc.Recorder(motor, **choice)
    with pytest.raises(FileNotFoundError):
        iqfoc.read_stream(tmp_path / "nowhere.bin")
    with pytest.raises(iqfoc.InputError, match="no row received"):
        iqfoc.read_stream(b"boot: hello\r\n" * 20)
