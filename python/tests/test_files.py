"""Motor files and recordings: the same numbers in and out, and one clear line for what cannot be used."""

import pickle

import numpy as np
import pytest

import iqfoc

BAD = [
    ({"R_ohm": -1.0}, r"^motor:\d+:\d+: .*R_ohm"),
    ({"L_d_H": float("nan")}, "L_d_H"),
    ({"speed": 3.0}, "a motor has no speed"),
    ({"extension": {"dead_time": {"v_dead_V": 1.0}}}, "i_knee_A"),
]


def test_motor_goes_round(motor, tmp_path):
    motor.write(tmp_path / "m.toml")
    for again in (iqfoc.Motor(tmp_path / "m.toml"), pickle.loads(pickle.dumps(motor)), motor.replace()):
        assert again == motor and again.name == motor.name
    hot = motor.replace(R_ohm=1.5, extension={"dead_time": {"v_dead_V": 4.2, "i_knee_A": 0.15}})
    assert hot.R_ohm == 1.5 and hot.extension["dead_time"]["v_dead_V"] == 4.2 and motor.R_ohm == 0.75
    assert "R_ohm" in hot._repr_html_()


@pytest.mark.parametrize(("values", "words"), BAD)
def test_bad_motor_is_refused(motor, values, words):
    with pytest.raises(iqfoc.InputError, match=words) as refused:
        motor.replace(**values)
    assert "\n" not in str(refused.value) and "/tmp" not in str(refused.value)


def test_motor_without_a_file():
    for read in (iqfoc.Motor, iqfoc.Recording):
        with pytest.raises(FileNotFoundError, match="nowhere.toml") as missing:
            read("nowhere.toml")
        assert isinstance(missing.value, iqfoc.InputError)
    with pytest.raises(TypeError):
        iqfoc.Motor()


def test_recording_goes_round(recording, tmp_path):
    recording.write(tmp_path / "r.csv", "a comment")
    for again in (iqfoc.Recording(tmp_path / "r.csv"), pickle.loads(pickle.dumps(recording)), iqfoc.Recording(recording.to_dict())):
        assert list(again) == list(recording) and again.T_s == recording.T_s
        assert all((again[n] == recording[n]).all() for n in recording)
    rows = np.rec.fromarrays(list(recording.values()), names=list(recording))
    assert (iqfoc.Recording(rows)["t_s"] == recording["t_s"]).all()
    assert "t_s" in recording._repr_html_()


@pytest.mark.extra
def test_a_recording_is_a_dict_that_stays_as_it_is(recording):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(recording)
    assert list(frame.columns) == list(recording) and len(frame) == recording.rows
    assert iqfoc.Recording(frame) == recording
    for change in (lambda: recording.update(t_s=0), lambda: recording.pop("t_s"), recording.clear):
        with pytest.raises(TypeError, match="cannot be changed"):
            change()
    assert iqfoc.Recording(changed(recording, u_dc_V=recording["u_dc_V"] + 1.0)) != recording


def changed(recording, **columns):
    return {**recording.to_dict(), **columns}


def test_bad_columns_are_refused(recording):
    t_s = recording["t_s"].copy()
    t_s[5] = t_s[4]
    spoilt = recording["i_a_A"].copy()
    spoilt[17] = np.nan
    for columns, words in ((changed(recording, t_s=t_s), r"recording:6: t_s .* does not rise"),
                           (changed(recording, i_a_A=spoilt), r"recording:18: i_a_A is no number"),
                           (changed(recording, u_dc_V=recording["u_dc_V"] * 1e9), "absurd"),
                           (changed(recording, run=recording["run"] + 0.5), "not a whole number"),
                           (changed(recording, t_s=t_s[:9]), "one length"),
                           ({"t_s": t_s, "ia": spoilt}, "missing columns: i_a_A, i_b_A"),
                           ({n: c[:0] for n, c in recording.items()}, "no rows")):
        with pytest.raises(iqfoc.InputError, match=words):
            iqfoc.Recording(columns)
    with pytest.raises(iqfoc.InputError, match="not int"):
        iqfoc.Recording(3)


def test_third_phase_and_speed_are_filled_in(recording, motor):
    bare = {n: c for n, c in recording.items() if n not in ("i_c_A", "omega_e_rad_s", "i_c_mid_A")}
    made = iqfoc.Recording(bare)
    assert "i_c_A" not in made and "omega_e_rad_s" not in made
    assert iqfoc.diagnose(made, motor).verdict in ("explained", "partly")
