"""Random motors and benches for the blind recordings: what the user has, how the bench was run, how it was measured."""

from types import SimpleNamespace

import numpy as np


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def three_digits(x):
    """A data sheet's precision: the motor file holds round numbers, and the true motor has them."""
    return float(f"{x:.3g}")


def draw_motor(rng, salient, cycles_per_turn=(8.0, 120.0)):
    """A motor of 0.4 to 120 kW on a matching inverter, sized in per-unit so that it can be run to its top speed.

    cycles_per_turn: control cycles per electrical turn at top speed, least and most.
    """
    power_W = log_uniform(rng, 400.0, 120e3)
    u_dc_V = float(rng.choice([325.0, 565.0, 600.0, 750.0] if power_W > 1500.0 else [48.0, 96.0, 325.0, 565.0]))
    v_base_V = u_dc_V / np.sqrt(3.0)
    I_pk_A = power_W / (1.5 * 0.7 * v_base_V)
    f_pwm_Hz = float(rng.choice([2000, 2500, 4000] if power_W > 40e3 else [4000, 5000, 8000, 10000, 16000]))
    sffr_min = log_uniform(rng, *cycles_per_turn)
    pole_pairs = int(rng.choice([1, 2, 3, 3, 4, 4, 5, 7]))
    f_max_Hz = min(f_pwm_Hz / sffr_min, 1200.0)
    omega_max = 2.0 * np.pi * f_max_Hz
    emf = rng.uniform(0.45, 0.8)
    reactance = rng.uniform(0.15, 0.6)
    # The current may change by no more than about its rated peak in one cycle at full voltage.
    reactance = max(reactance, 2.0 * np.pi / (f_pwm_Hz / f_max_Hz) / 1.2)
    L_H = reactance * v_base_V / (omega_max * I_pk_A)
    ratio = rng.uniform(1.15, 2.2) if salient else 1.0
    r = log_uniform(rng, 0.012, 0.05) * (3e3 / power_W) ** 0.2
    motor = SimpleNamespace(
        name=f"{rng.choice(['Pump', 'Spindle', 'Compressor', 'Traction', 'Servo', 'Fan', 'Hoist', 'Mixer'])} "
             f"{three_digits(power_W / 1e3):g} kW",
        pole_pairs=pole_pairs, R_ohm=three_digits(r * v_base_V / I_pk_A), L_d_H=three_digits(L_H / np.sqrt(ratio)),
        L_q_H=three_digits(L_H * np.sqrt(ratio)) if salient else three_digits(L_H),
        psi_f_Wb=three_digits(emf * v_base_V / omega_max), I_rated_A_rms=three_digits(I_pk_A / np.sqrt(2.0)),
        n_max_rpm=float(round(60.0 * f_max_Hz / pole_pairs)), f_pwm_Hz=f_pwm_Hz, u_dc_V=u_dc_V)
    if not salient:
        motor.L_d_H = motor.L_q_H
    return motor


def draw_operating_points(rng, motor, runs, kind):
    """Speed and dq current of each run, within the voltage the inverter has; some reverse, some at standstill."""
    omega_max = motor.n_max_rpm * 2.0 * np.pi / 60.0 * motor.pole_pairs
    v_max = 0.84 * motor.u_dc_V / np.sqrt(3.0)
    I_pk = motor.I_rated_A_rms * np.sqrt(2.0)
    standstill = int(rng.integers(0, 3)) if runs >= 8 else int(rng.integers(0, 2))
    standstill = runs if kind == "standstill" else standstill
    speeds = np.concatenate([np.zeros(standstill), np.geomspace(0.05, 1.0, runs - standstill)])
    points = []
    for n, fraction in enumerate(speeds):
        omega = fraction * rng.uniform(0.85, 1.0) * omega_max * (-1.0 if n > standstill and rng.random() < 0.3 else 1.0)
        size, i_d = rng.uniform(0.2, 0.95) * I_pk, rng.choice([0.0, 0.0, -0.3, -0.5, 0.2])
        i = size * (i_d + 1j * np.sqrt(1.0 - i_d ** 2) * rng.choice([-1.0, 1.0, 1.0]))

        def voltage(w):
            flux = motor.psi_f_Wb + motor.L_d_H * i.real + 1j * motor.L_q_H * i.imag
            return abs(motor.R_ohm * i + 1j * w * flux)
        while voltage(omega) > v_max:
            omega *= 0.96
        points.append((omega, i))
    return points


def excitation(rng, cycles, amplitude_A):
    """Small steps of both references, held for 15 to 120 cycles, plus one slow sine: shape (cycles,), complex."""
    x = np.zeros(cycles, complex)
    for axis in (1.0, 1j):
        k = 0
        while k < cycles:
            hold = int(rng.integers(15, 121))
            x[k:k + hold] += axis * amplitude_A * rng.uniform(-1.0, 1.0)
            k += hold
    turn = rng.uniform(0.002, 0.01) * np.arange(cycles) * 2.0 * np.pi
    return x + 0.3 * amplitude_A * (np.sin(turn) + 1j * np.cos(0.7 * turn))


# Benches of one run without a search for speeds: at one speed, or from one to another.
ONE_RUN = ["steady", "ramp"]
BENCHES = ["usual", "standstill", "one_point", "discontinuous"] + ONE_RUN
CYCLES_PER_TURN = (5.0, 40.0)  # of a motor in them, at top speed
ROWS_MOST = 8000  # the second plant takes a minute for them
DISCONTINUOUS = ["dpwm_min", "dpwm_max", "dpwm_1", "dpwm_0", "dpwm_2", "dpwm_3"]


def draw_bench(rng, motor, kind="usual"):
    """How the recording is taken: runs, excitation, sensors, DC link, and which columns the file has.

    kind: "usual" spreads 6 to 12 runs over speed and current; "standstill" and "one_point" show less, and a
    diagnosis has to say what they cannot tell apart. "discontinuous" holds a leg at a rail for a third of the time or for sixths of it,
    and logs no duties.
    """
    I_pk = motor.I_rated_A_rms * np.sqrt(2.0)
    runs = 1 if kind in ["one_point"] + ONE_RUN else int(rng.integers(6, 13))
    bench = SimpleNamespace(
        runs=runs, rows=[int(rng.integers(1100, 1500)) * 10 // max(runs, 4) for _ in range(runs)], warm_up=150,
        points=draw_operating_points(rng, motor, runs, kind), excitation=rng.uniform(0.04, 0.12),
        noise_A=log_uniform(rng, 0.0006, 0.005) * I_pk, bits=int(rng.choice([12, 12, 14])),
        full_scale_A=rng.uniform(1.6, 2.6) * I_pk, encoder_counts=2 ** int(rng.choice([15, 16, 17])),
        omega_noise=log_uniform(rng, 1e-6, 1e-4), timer_counts=int(rng.choice([2500, 5000, 8500, 10000])),
        min_max=bool(rng.random() < 0.75), bandwidth_T=rng.uniform(0.12, 0.22),
        u_drift=rng.uniform(0.0, 0.02), u_drift_Hz=rng.uniform(0.5, 3.0), u_dc_noise=rng.uniform(0.0, 2e-4),
        swing=[rng.uniform(0.0, 0.012) for _ in range(runs)], swing_Hz=[rng.uniform(0.5, 4.0) for _ in range(runs)],
        columns=rng.choice(["u", "duty", "both"]), has_mid=bool(rng.random() < 0.4),
        has_run=bool(rng.random() < 0.8), has_i_c=bool(rng.random() < 0.7), wrap=str(rng.choice(["2pi", "pi", "no"])),
        has_mech=bool(rng.random() < 0.4), comments=bool(rng.random() < 0.5), shuffle=bool(rng.random() < 0.3),
        extra=bool(rng.random() < 0.4), crlf=bool(rng.random() < 0.2))
    if kind in ONE_RUN:
        make_one_run(rng, motor, bench, kind)
    if kind == "discontinuous":
        bench.modulator, bench.columns = str(rng.choice(DISCONTINUOUS)), "u"
    return bench


def make_one_run(rng, motor, bench, kind):
    """One run of 0.3 to 2 s as most logs are: references that mostly stand still, at one speed, or on a ramp up or down."""
    bench.rows = [int(min(rng.uniform(0.3, 2.0) * motor.f_pwm_Hz, ROWS_MOST))]
    if rng.random() < 0.7:
        bench.excitation = 0.0
    omega_max = motor.n_max_rpm * 2.0 * np.pi / 60.0 * motor.pole_pairs
    I_pk, v_max = motor.I_rated_A_rms * np.sqrt(2.0), 0.84 * motor.u_dc_V / np.sqrt(3.0)
    least = 2.0 * np.pi * motor.f_pwm_Hz / 50.0 / omega_max  # of top speed: 50 cycles per turn
    i_d = rng.choice([0.0, 0.0, -0.3, 0.2])
    i = rng.uniform(0.2, 0.9) * I_pk * (i_d + 1j * np.sqrt(1.0 - i_d ** 2) * rng.choice([-1.0, 1.0, 1.0]))
    omega = omega_max * rng.uniform(min(max(0.4, least), 1.0), 1.0)
    while abs(motor.R_ohm * i + 1j * omega * (motor.psi_f_Wb + motor.L_d_H * i.real + 1j * motor.L_q_H * i.imag)) > v_max:
        omega *= 0.97
    bench.swing = [rng.uniform(0.0, 0.003)]
    direction = rng.choice([-1.0, 1.0, 1.0])
    bench.points = [(float(omega * direction), i if direction > 0.0 else i.real - 1j * i.imag)]
    if kind == "ramp":
        low = float(rng.uniform(0.03, 0.2) * omega * direction)
        high = bench.points[0][0]
        bench.ramp_rad_s = (low, high) if rng.random() < 0.5 else (high, low)
        bench.points = [(bench.ramp_rad_s[0], bench.points[0][1])]
        bench.swing = [1.0 - bench.ramp_rad_s[1] / bench.ramp_rad_s[0]]
