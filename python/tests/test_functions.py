"""The library's functions over arrays against double precision, within the errors that the headers state."""

import subprocess

import numpy as np
import pytest

import iqfoc
from iqfoc import functions as f

RNG = np.random.default_rng(7)
N = 20000
LSB = 2.0 ** -24


def numbers(size, count=1):
    """Even Q7.24 within +-size, so that half a cycle's turn is one too, and the same as floats."""
    x = f.from_float(RNG.uniform(-size, size, (count, N))) & ~np.int32(1)
    return x, f.to_float(x)


def close(results, expected, lsb):
    for got, wanted in zip(results, expected, strict=True):
        assert got.dtype == np.int32
        assert np.abs(f.to_float(got) - wanted).max() <= lsb * LSB


def test_numbers_convert_exactly_and_saturate():
    iq, x = numbers(128.0)
    assert (f.from_float(x) == iq).all()
    assert f.from_float(1000.0) == 2 ** 31 - 1 and f.from_float(-1000.0) == -(2 ** 31)
    assert f.from_float(1.0) == f.ONE and f.to_float(f.ONE) == 1.0
    with pytest.raises(ValueError):
        f.from_float([0.0, np.nan])


def test_floats_and_what_does_not_fit_are_refused():
    with pytest.raises(TypeError, match="from_float"):
        f.sqrt(1.0)
    with pytest.raises(OverflowError):
        f.sqrt(2 ** 31)


def test_arguments_broadcast():
    d, q = f.park(np.full((3, 1), f.ONE, np.int32), 0, np.arange(4, dtype=np.int32) * (f.ONE // 4))
    assert d.shape == q.shape == (3, 4)
    assert d[0].tolist() == [f.ONE, 0, -f.ONE, 0]
    assert np.isscalar(f.sqrt(f.ONE).item()) and f.sqrt(f.ONE) == f.ONE
    assert f.sqrt(np.zeros(0, np.int32)).shape == (0,)


def test_arithmetic():
    (a, b), (x, y) = numbers(11.0, 2)
    close([f.mul(a, b)], [x * y], 0.5)
    close([f.div(a, b)], [np.clip(x / y, -128.0, 128.0 - LSB)], 0.5)
    close([f.sqrt(np.abs(a))], [np.sqrt(np.abs(x))], 0.63)
    turn = np.arctan2(x, y) / (2 * np.pi)
    close([f.atan2(a, b)], [turn], 0.64)
    close(f.sincos(a), [np.sin(2 * np.pi * x), np.cos(2 * np.pi * x)], 0.51)


def test_transforms():
    (a, b, c), (x, y, z) = numbers(30.0, 3)
    close(f.clarke2(a, b), [x, (x + 2 * y) / 3 ** 0.5], 0.7)
    close(f.clarke3(a, b, c), [(2 * x - y - z) / 3, (y - z) / 3 ** 0.5], 0.7)
    close(f.clarke_inverse(a, b), [x, -x / 2 + 3 ** 0.5 / 2 * y, -x / 2 - 3 ** 0.5 / 2 * y], 1.2)
    assert (sum(v.astype(np.int64) for v in f.clarke_inverse(a, b)) == 0).all()
    s, co = (f.to_float(v) for v in f.sincos(c))
    close(f.park(a, b, c), [co * x + s * y, co * y - s * x], 0.51)
    close(f.park_inverse(a, b, c), [co * x - s * y, co * y + s * x], 0.51)


def test_rotor_and_means():
    (t,), (turns,) = numbers(0.33)
    h = np.pi * turns
    s1 = np.sinc(turns)
    with np.errstate(invalid="ignore", divide="ignore"):
        s2 = np.where(turns == 0, 0.0, (np.sin(h) - h * np.cos(h)) / (2 * h ** 2))
    close(f.rotor(t), [turns, 2 * h, s1, s2, 2 * np.sin(h), s1 - np.cos(h)], 0.61)
    close([f.steady_gain(t)], [s1 + 2 * np.tan(h) * s2], 0.8)
    assert f.rotor(f.ONE)[0] == f.TURNS_MAX
    (a, b, da, db, mid), (x, y, dx, dy, _) = numbers(20.0, 5)
    _, _, q1, q2, _, _ = (f.to_float(v) for v in f.rotor(t))
    sine, cosine = (f.to_float(v) for v in f.sincos(mid))
    mean = (q1 * (x + 1j * y) - 1j * q2 * (dx + 1j * dy)) * (cosine - 1j * sine)
    close(f.mean_correct(a, b, da, db, mid, t), [mean.real, mean.imag], 1.3)
    steady = f.to_float(f.steady_gain(t)) * (x + 1j * y) * (cosine - 1j * sine)
    close(f.mean_correct_steady(a, b, mid, t), [steady.real, steady.imag], 1.3)


def test_modulation():
    (a, b), (x, y) = numbers(0.4, 2)
    *duties, scale = f.modulate(a, b)
    assert (scale == f.ONE).all() and all(((d >= 0) & (d <= f.ONE)).all() for d in duties)
    close(f.modulated_voltage(*duties), [x, y], 7)
    *duties, scale = f.modulate(8 * a, 8 * b)
    assert (scale < f.ONE).any() and all(((d >= 0) & (d <= f.ONE)).all() for d in duties)
    *nearest, _ = f.modulate_nearest(a, b)
    close(nearest, [f.to_float(d) for d in f.modulate(a, b)[:3]], 0)
    with pytest.raises(ValueError, match="u_dc_inverse"):
        f.modulate(a, b, 0)
    states = f.six_step_state(f.from_float(np.arange(6) / 6.0))
    assert states.tolist() == [0, 1, 2, 3, 4, 5]
    close(f.six_step_voltage(states), [2 / 3 * np.cos(np.arange(6) * np.pi / 3), 2 / 3 * np.sin(np.arange(6) * np.pi / 3)], 0.7)


def test_predictions_meet_their_formulas(motor):
    machine = iqfoc.Machine(motor)
    assert abs(machine.k_u - motor.T_s * motor.u_dc_V / (motor.L_d_H * motor.I_base_A) * 2 ** 24) <= 0.5
    (ia, ib, th), (xa, xb, theta) = numbers(1.5, 3)
    (ua, ub, t), (va, vb, turns) = numbers(0.3, 3)
    k_u, k_r, k_psi = (k * LSB for k in (machine.k_u, machine.k_r, machine.k_psi))
    i, u, phi = xa + 1j * xb, va + 1j * vb, 2 * np.pi * turns
    drop = i + k_u * u - k_r * i
    standard = drop - 1j * k_psi * phi * np.exp(2j * np.pi * theta)
    quasi = drop - 1j * k_psi * phi * np.sinc(turns) * np.exp(2j * np.pi * (theta + turns / 2))
    close(machine.predict(ia, ib, ua, ub, th, t, "euler"), [standard.real, standard.imag], 4)
    close(machine.predict(ia, ib, ua, ub, th, t), [quasi.real, quasi.imag], 6)


def test_methods_agree_where_the_machine_lets_them(motor):
    """The exact solution of R, L and magnet, by three predictors that share no formula: a machine without saliency."""
    machine = iqfoc.Machine(motor)
    (ia, ib, th, ua, ub, t), (xa, xb, theta, va, vb, turns) = numbers(0.3, 6)
    omega, tau = 2 * np.pi * turns / motor.T_s, motor.L_d_H / motor.R_ohm
    i, u = (xa + 1j * xb) * motor.I_base_A, (va + 1j * vb) * motor.u_dc_V
    decay = np.exp(-motor.T_s / tau)
    turned = np.exp(1j * omega * motor.T_s)
    emf = 1j * omega * motor.psi_f_Wb * np.exp(2j * np.pi * theta) / (motor.R_ohm + 1j * omega * motor.L_d_H)
    end = (i * decay + u / motor.R_ohm * (1 - decay) - emf * (turned - decay)) / motor.I_base_A
    for method, lsb in (("exact", 4), ("salient", 6)):
        close(machine.predict(ia, ib, ua, ub, th, t, method), [end.real, end.imag], lsb)
    # A flux map without parts that saturate is the straight iron of the other, where its steps reach the change of a cycle.
    by_flux = [np.asarray(x, float) * LSB for x in machine.predict(ia, ib, ua, ub, th, t, "flux")]
    by_map = machine.predict(ia, ib, ua, ub, th, t, "flux_map")
    near = np.abs(by_flux[0] + 1j * by_flux[1] - (xa + 1j * xb) * turned) < 0.7
    assert near.sum() > 300
    close([x[near] for x in by_map], [x[near] for x in by_flux], 12)
    with pytest.raises(ValueError, match="euler"):
        machine.predict(0, 0, 0, 0, 0, 0, "guess")


def test_golden_vectors_are_the_programs(program):
    assert subprocess.run([program, "golden"], check=True, capture_output=True, text=True).stdout == f"golden {iqfoc.golden()}\n"
