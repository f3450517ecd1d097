"""The diagnosis: the program's, to the last digit, as Python objects."""

import json
import pickle
import subprocess

import numpy as np
import pytest

import iqfoc


def test_names_the_cause(diagnosis):
    assert diagnosis.verdict == "explained"
    (cause,) = diagnosis.causes
    assert cause.id == "resistance" and cause.probability > 0.9 and cause.gain > 1.0
    low, high = cause["R"].ci95
    assert cause["R"].nominal == 0.75 and low <= 0.95 <= high
    assert diagnosis.error.extended < diagnosis.error.nominal


def test_pickled_and_compared(diagnosis, recording, motor):
    again = pickle.loads(pickle.dumps(diagnosis))
    assert again == diagnosis and hash(again) == hash(diagnosis) and again is not diagnosis
    assert iqfoc.diagnose(recording, motor, skip="resistance") != diagnosis
    with pytest.raises(KeyError, match="resistance has no L; it has R"):
        diagnosis.causes[0]["L"]


def test_json_is_the_programs(program, diagnosis, recording, motor, tmp_path):
    recording.write(tmp_path / "r.csv")
    motor.write(tmp_path / "m.toml")
    subprocess.run([program, "diagnose", tmp_path / "r.csv", "--motor", tmp_path / "m.toml", "--json", tmp_path / "d.json"], check=True,
                   capture_output=True)
    theirs = (tmp_path / "d.json").read_text().replace(str(tmp_path / "r.csv"), recording.label).replace(str(tmp_path / "m.toml"), motor.label)
    assert theirs == diagnosis.json


def test_extended_motor_explains(diagnosis, recording, motor):
    again = iqfoc.diagnose(recording, diagnosis.to_motor())
    assert again.verdict == "clean" and not again.causes
    assert motor.R_ohm == 0.75 and abs(diagnosis.to_motor().R_ohm - 0.95) < 0.03


def test_series_and_tables(diagnosis, recording):
    s = diagnosis.series
    assert {len(c) for c in s.values()} == {recording.rows}
    held = s["held_out"] == 1.0
    assert held.sum() == diagnosis.data["rows_held_out"]
    rms = [np.sqrt(np.nanmean(s[f"error_{n}_alpha_A"][held] ** 2 + s[f"error_{n}_beta_A"][held] ** 2)) for n in ("nominal", "extended")]
    assert rms[0] / rms[1] == pytest.approx(diagnosis.error.gain, rel=0.02)
    assert [r["name"] for r in diagnosis.tables["causes"]] == ["R"] and {r["run"] for r in diagnosis.tables["runs"]} == {1, 2, 3}


def test_shown(diagnosis):
    assert "resistance" in str(diagnosis) and "resistance" in diagnosis._repr_html_() and "explained" in repr(diagnosis)
    assert json.loads(diagnosis.json) == diagnosis.data


@pytest.mark.extra
def test_plot(diagnosis):
    pytest.importorskip("matplotlib")
    in_time, by_run = diagnosis.plot().axes
    assert [line.get_label() for line in in_time.lines] == ["nominal", "extended"]
    assert list(by_run.lines[0].get_ydata()) == [r["nominal"] for r in diagnosis.data["runs"]]


def test_skip_and_refusals(recording, motor):
    assert "resistance" not in [c.id for c in iqfoc.diagnose(recording, motor, skip=["resistance"]).causes]
    for arguments, words in ((dict(skip=["resistor"]), "'resistor' is no cause id"), ({}, "nowhere.csv")):
        with pytest.raises(iqfoc.InputError, match=words) as refused:
            iqfoc.diagnose("nowhere.csv" if not arguments else recording, motor, **arguments)
        assert "\n" not in str(refused.value)


def test_page_needs_no_other_program(diagnosis, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    page = diagnosis.page(tmp_path / "out")
    assert "resistance" in page.read_text(encoding="utf-8")
    assert iqfoc.Motor(tmp_path / "out" / "motor_extended.toml").R_ohm == diagnosis.to_motor().R_ohm
    assert json.loads((tmp_path / "out" / "diagnosis.json").read_text())["verdict"] == diagnosis.verdict
