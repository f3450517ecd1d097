"""From a seed to a recording: draws motor, bench and hidden effects, runs the second plant, sizes the effects."""

import copy
import itertools
from types import SimpleNamespace

import numpy as np

import averaged
import digits
import effects
import motors
import second_drive
from second_plant import TURN, Inverter, Machine, RampedShaft, Shaft


def draw_group(rng, causes, count):
    """So many of the causes; none contains another or is equivalent to it."""
    while True:
        ids = [str(x) for x in rng.choice(causes, count, replace=False)]
        if all(effects.compatible(a, b) for a, b in itertools.combinations(ids, 2)):
            return ids


def draw_effects(rng, kind):
    """The ids to hide. kind: clean, single, pair, triple, unknown, or ids joined by +."""
    if kind == "clean":
        return []
    if kind == "single":
        return [str(rng.choice(effects.CAUSES))]
    if kind == "unknown":
        return [str(rng.choice(effects.UNKNOWN))]
    if kind in ("pair", "triple"):
        return draw_group(rng, effects.CAUSES, 2 if kind == "pair" else 3)
    ids = kind.split("+")
    for name in ids:
        if name not in effects.DRAWN_BY_NAME:
            raise ValueError(f"kind: clean, single, pair, triple, unknown or ids joined by +, not '{name}'")
    return ids


def lane_starts(seed, bench, T_s):
    """When each run begins in the recording, and when the last one ends: with generate.recording_text's pauses."""
    rng = np.random.default_rng([seed, 3])
    starts, start = [], 0.0
    for rows in bench.rows:
        starts.append(start)
        end = start + T_s * rows
        start = end + T_s * int(rng.integers(800, 4000))
        if bench.extra:
            rng.standard_normal(rows)
    return np.array(starts), end


def warming(t_s, model, motor):
    """Kelvins by which a drive has warmed: nineteen twentieths of its heating within the recording."""
    return model.heating_K * (1.0 - np.exp(-3.0 * np.maximum(t_s, 0.0) / motor.span_s))


def true_model(motor, ids, sizes, directions, has_i_c):
    model = effects.nominal_model(motor, averaged.no_effect())
    model.two_sensors = not has_i_c
    parameters = [effects.apply(model, motor, name, size, d, has_i_c)
                  for name, size, d in zip(ids, sizes, directions)]
    return model, parameters


def simulate(motor, bench, model, rows, rng_seed):
    """Runs the second plant over all runs of the bench; rows: how many cycles to keep."""
    rng = np.random.default_rng(rng_seed)
    lanes, T_s, I_pk = bench.runs, 1.0 / motor.f_pwm_Hz, motor.I_rated_A_rms * np.sqrt(2.0)
    omega = np.array([w for w, _ in bench.points])
    machine = Machine(lanes, model.R_ohm, model.L_d_H, model.L_q_H, model.psi_f_Wb, model.psi_5_Wb, model.psi_7_Wb,
                      model.I_sat_A, model.dR_ohm, model.R_iron_ohm, model.tau_iron_s, model.dL_H,
                      model.psi_11_Wb, model.psi_13_Wb, model.flux_map, model.weak_pole, motor.pole_pairs, model.short)
    inverter = Inverter(lanes, T_s, model.t_dead_s, model.V_switch_V, model.V_diode_V)
    # At standstill the rotor is locked: the swing is a share of the speed.
    shaft = Shaft(rng.uniform(0.0, TURN * motor.pole_pairs, lanes), omega, omega * np.array(bench.swing),
                  np.array(bench.swing_Hz), rng.uniform(0.0, TURN, lanes))
    if hasattr(bench, "ramp_rad_s"):
        begin, end = bench.ramp_rad_s
        shaft = RampedShaft(shaft.theta_start_rad, omega, (end - begin) / (T_s * max(bench.rows)), T_s * bench.warm_up)
    steps = np.array([motors.excitation(rng, bench.warm_up + max(bench.rows), bench.excitation * I_pk)
                      for _ in range(lanes)]).T
    ones, three = np.ones(lanes), np.ones((3, lanes))
    starts, _ = lane_starts(rng_seed[0], bench, T_s)
    # The mean of all rows' times: of equal sampling, each run's middle weighed by its rows.
    middle_s = np.average(starts + 0.5 * T_s * (np.array(bench.rows) - 1), weights=bench.rows)
    u_file = motor.u_dc_V
    p = SimpleNamespace(
        i_ref_dq=np.array([i for _, i in bench.points]) + steps,
        gain=model.g.reshape(3, 1) * three, offset_A=model.o_A.reshape(3, 1) * three, noise_A=bench.noise_A,
        lsb_A=ones * 2.0 * bench.full_scale_A / 2 ** bench.bits, full_scale_A=bench.full_scale_A,
        loose_phase=model.loose_phase, loose_rate=model.loose_rate, loose_factor=model.loose_factor,
        two_sensors=not bench.has_i_c,
        pole_pairs=motor.pole_pairs, encoder_counts=bench.encoder_counts, theta_0_rad=model.theta_0_rad,
        t_delay_s=model.t_delay_s, order=model.order, amplitude_rad=model.amplitude_rad, phase_rad=model.phase_rad,
        L_d_file_H=motor.L_d_H * ones, L_q_file_H=motor.L_q_H * ones, R_file_ohm=motor.R_ohm * ones,
        psi_f_file_Wb=motor.psi_f_Wb, bandwidth_T=bench.bandwidth_T * (0.5 if model.delay_cycles else 1.0),
        u_max_ratio=0.97, u_dc_V=u_file, k_u=model.k_u, u_drift=bench.u_drift, u_drift_Hz=bench.u_drift_Hz,
        u_ripple=model.u_ripple, u_ripple_Hz=model.u_ripple_Hz, u_dc_noise_V=bench.u_dc_noise * u_file,
        u_dc_lsb_V=1.4 * u_file / 2 ** bench.bits, timer_counts=bench.timer_counts, modulator=getattr(bench, "modulator", "min_max" if bench.min_max else "sine"),
        omega_noise_rad_s=bench.omega_noise * motor.n_max_rpm * np.pi / 30.0 * motor.pole_pairs,
        R_share=np.zeros((bench.warm_up + rows, 1)), psi_share=np.zeros((bench.warm_up + rows, 1)),
        drifts=bool(model.R_rate_ohm_s or model.psi_rate_Wb_s or model.g_rate_s.any() or model.o_rate_A_s.any() or model.flux_share),
        clock_s=starts - middle_s, R_rate_ohm_s=model.R_rate_ohm_s, psi_rate_Wb_s=model.psi_rate_Wb_s,
        gain_rate_s=model.g_rate_s.reshape(3, 1), offset_rate_A_s=model.o_rate_A_s.reshape(3, 1),
        compensation_V=model.compensation_V, glitch_rate=model.glitch_rate, delay_cycles=model.delay_cycles,
        sensor_lag_s=model.sensor_lag_s, speed_lag_s=model.speed_lag_s, hysteresis_A=model.hysteresis_A, hum_V=model.hum_V,
        hum_Hz=model.hum_Hz, hum_phase=model.hum_phase, flux_order=model.flux_order, flux_share=model.flux_share,
        flux_rad=model.flux_rad, pick_up=model.pick_up)
    if model.heating_K:
        p.drifts = True
        p.warmer_K = warming(starts + T_s * np.arange(-bench.warm_up, rows).reshape(-1, 1), model, motor)
        # A pilot is shorter than the runs.
        mean_K = np.average([p.warmer_K[bench.warm_up:bench.warm_up + n, lane].mean() for lane, n in enumerate(bench.rows)],
                            weights=bench.rows)
        p.R_share, p.psi_share = model.alpha_R * (p.warmer_K - mean_K), model.alpha_psi * (p.warmer_K - mean_K)
    columns = second_drive.record(p, machine, inverter, shaft, rows, bench.warm_up, rng)
    if model.heating_K:
        columns["temp_C"] = 25.0 + p.warmer_K[bench.warm_up:]
    return columns


def oracle(columns, model, motor):
    """The one-cycle error of the true model: rms, and the predictions. The dead time's knee is the one unknown."""
    T_s, I_pk = 1.0 / motor.f_pwm_Hz, motor.I_rated_A_rms * np.sqrt(2.0)
    best = None
    for knee in np.geomspace(1e-3, 0.3, 7) * I_pk if model.v_dead_V else [1.0]:
        tried = copy.copy(model)
        tried.i_knee_A = knee
        error, measured, predicted = averaged.predict(columns, tried, motor.pole_pairs, T_s)
        if best is None or averaged.rms(error) < best[0]:
            best = (averaged.rms(error), averaged.rms(measured), predicted, knee)
    return best


def noise_floor_A(bench):
    """The one-cycle error that sensor noise and quantisation alone leave: two samples, both axes."""
    phase = bench.noise_A ** 2 + (2.0 * bench.full_scale_A / 2 ** bench.bits) ** 2 / 12.0
    return np.sqrt(2.0 * phase * (4.0 / 3.0 if bench.has_i_c else 8.0 / 3.0))


def shares(columns, motor, bench, model, ids, sizes, directions):
    """Each effect's share of the one-cycle error over the noise floor: the truth without it against the truth."""
    floor, T_s = noise_floor_A(bench), 1.0 / motor.f_pwm_Hz
    error, _, predicted, knee = oracle(columns, model, motor)
    out = []
    for n, name in enumerate(ids):
        if name in effects.NOT_AVERAGED:
            # What it leaves beyond the floor is its share.
            out.append(float(np.sqrt(max(error ** 2 / floor ** 2 - 1.0, 0.0))))
            continue
        rest = [m for m in range(len(ids)) if m != n]
        without, _ = true_model(motor, [ids[m] for m in rest], [sizes[m] for m in rest],
                                [directions[m] for m in rest], bench.has_i_c)
        without.i_knee_A = knee
        _, _, other = averaged.predict(columns, without, motor.pole_pairs, T_s)
        n = min(len(other), len(predicted))  # a voltage that acts late costs rows at the start
        out.append(averaged.rms(other[-n:] - predicted[-n:]) / floor)
    return out


def draw_case(seed, kind, bench_kind="usual", with_digits=False):
    """What is drawn before anything runs: motor and its file, bench, and the effects' ids, directions and target shares."""
    rng = np.random.default_rng([seed, 20190])
    ids = draw_effects(rng, kind)
    salient = bool(rng.random() < 0.5) and "saturation" not in ids or "saturation_dq" in ids
    motor = motors.draw_motor(rng, salient, *([motors.CYCLES_PER_TURN] if bench_kind in motors.ONE_RUN else []))
    bench = motors.draw_bench(rng, motor, bench_kind)
    if "speed_lag" in ids:
        # It shows while the speed changes: by more than the bench's own swing, and no faster than before at the most.
        bench.swing = [float(s) for s in np.random.default_rng([seed, 8]).uniform(0.3, 0.6, bench.runs)]
        bench.points = [(w / (1.0 + s), i) for (w, i), s in zip(bench.points, bench.swing)]
    if "sensor_fault" in ids or "loose_of_two" in ids:
        bench.has_i_c = "sensor_fault" in ids  # whose current it is only three sensors tell
    motor.span_s = lane_starts(seed, bench, 1.0 / motor.f_pwm_Hz)[1]  # how long the recording takes
    directions = [effects.draw_direction(rng, name, bench.has_i_c) for name in ids]
    targets = [motors.log_uniform(rng, 2.0, 12.0) for _ in ids]
    ceilings = [rng.uniform(0.5, 1.0) for _ in ids]
    errors = digits.relative_errors(seed, motor, ids) if with_digits else {}
    return SimpleNamespace(seed=seed, kind=kind, ids=ids, motor=motor, file=digits.file_of(motor, errors), bench=bench,
                           directions=directions, targets=targets, ceilings=ceilings, file_errors=errors)


def draw_sizes(case):
    """The effects' sizes: a short pilot tells how large each shows at its middle size, then it is scaled to its target.

    Where the one-cycle error is nearly blind to an effect, the size ends at half to all of what a bench plausibly
    shows (effects.RANGE), and the truth file's evidence (share times the root of the rows) says what is there.
    """
    sizes = [float(np.sqrt(np.prod(effects.RANGE[name]))) for name in case.ids]
    if any(name not in effects.WITHOUT_SIZE for name in case.ids):
        model, _ = true_model(case.motor, case.ids, sizes, case.directions, case.bench.has_i_c)
        pilot = simulate(case.motor, case.bench, model, 120, [case.seed, 1])
        found = shares(pilot, case.motor, case.bench, model, case.ids, sizes, case.directions)
        for n, name in enumerate(case.ids):
            low, high = effects.RANGE[name]
            if name not in effects.WITHOUT_SIZE:
                wanted = sizes[n] * case.targets[n] / max(found[n], 1e-3)
                sizes[n] = float(np.clip(wanted, low, max(low, case.ceilings[n] * high)))
    return sizes


def draw(seed, kind, sizes=None, bench_kind="usual", with_digits=False):
    """Everything about one blind recording by the second plant; sizes: the effects' sizes, instead of drawn ones."""
    case = draw_case(seed, kind, bench_kind, with_digits)
    motor, bench, ids = case.motor, case.bench, case.ids
    sizes = draw_sizes(case) if sizes is None else sizes
    model, parameters = true_model(motor, ids, sizes, case.directions, bench.has_i_c)
    columns = simulate(motor, bench, model, max(bench.rows), [seed, 2])
    truth = truth_of(case, sizes, model, parameters, columns)
    return SimpleNamespace(motor=motor, file=case.file, bench=bench, columns=columns, truth=truth)


def mean_flux_Wb(model, pole_pairs):
    """Around the rotor: a weak pole takes half a cosine squared from one pole pair."""
    return model.psi_f_Wb * (1.0 - 0.5 * model.weak_pole / pole_pairs)


def truth_of(case, sizes, model, parameters, columns, plant="second"):
    """The truth file of a recording, with what an oracle reaches on it."""
    motor, bench = case.motor, case.bench
    if model.v_dead_V:
        # What dead time takes goes with the true DC link: the second plant's drifts, and k_u is true over measured.
        measured_V = float(columns["u_dc_V"].mean()) if "u_dc_V" in columns else motor.u_dc_V
        model = copy.copy(model)
        more_V = model.k_u * measured_V - motor.u_dc_V
        model.v_dead_V += more_V * (model.t_dead_s * motor.f_pwm_Hz - model.compensation_V / motor.u_dc_V)
        parameters[[effects.cause_of(x) for x in case.ids].index("dead_time")][0]["value"] = model.v_dead_V
    error, size, _, _ = oracle(columns, model, motor)
    nominal = effects.nominal_model(case.file, averaged.no_effect())
    nominal_error, _, _ = averaged.predict(columns, nominal, motor.pole_pairs, 1.0 / motor.f_pwm_Hz)
    share = shares(columns, motor, bench, model, case.ids, sizes, case.directions)
    n = sum(bench.rows)
    return {
        "schema": 1, "seed": case.seed, "kind": case.kind, "plant": plant,
        "effects": [{"id": told[0], "known": told[1], "size": s, "share_of_floor": round(q, 3),
                     "evidence": round(q * np.sqrt(n), 1), "parameters": par}
                    for told, s, q, par in zip((effects.told_as(x, bench.has_i_c) for x in case.ids), sizes, share, parameters)],
        "motor_file_should_say": {"R_ohm": model.R_ohm, "L_d_H": model.L_d_H, "L_q_H": model.L_q_H,
                                  "psi_f_Wb": mean_flux_Wb(model, motor.pole_pairs)},
        "file_errors": case.file_errors,
        "oracle": {"nominal_percent": 100.0 * averaged.rms(nominal_error) / size,
                   "true_percent": 100.0 * error / size,
                   "floor_percent": 100.0 * float(noise_floor_A(bench)) / size,
                   "gain": averaged.rms(nominal_error) / error},
        "sffr_min": motor.f_pwm_Hz / (motor.n_max_rpm / 60.0 * motor.pole_pairs)}
