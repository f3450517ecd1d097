"""Blind recordings by the project's own plant: the drawn case as a scenario and --effect arguments of iqfoc simulate.

Motor, operating points, noise and effect sizes are drawn as for the second plant, so that the two can be compared.
"""

import os
import subprocess
import tempfile

import numpy as np

import draw
import effects
import generate
import reading


def toml_list(values):
    return "[" + ", ".join(f"{v:.9g}" for v in values) + "]"


def reference(rng, name, value, amplitude, T_s, cycles):
    """A current reference: steps of 25 to 120 cycles (a course holds 64 at most) about a value."""
    at, k = [], 0
    while k < cycles and len(at) < 64:
        at.append(k * T_s)
        k += int(rng.integers(25, 121))
    steps = value + amplitude * rng.uniform(-1.0, 1.0, len(at))
    return f"{name} = {{ at_s = {toml_list(at)}, steps = {toml_list(steps)} }}"


def scenario_text(case, cycles):
    motor, bench = case.motor, case.bench
    rng = np.random.default_rng([case.seed, 4])
    I_pk, T_s = motor.I_rated_A_rms * np.sqrt(2.0), 1.0 / motor.f_pwm_Hz
    omega_max = motor.n_max_rpm * np.pi / 30.0 * motor.pole_pairs
    late = any(effects.cause_of(name) == "voltage_delay" for name in case.ids)
    lines = ['name = "blind"', "[control]",
             f"bandwidth_Hz = {bench.bandwidth_T * (0.5 if late else 1.0) * motor.f_pwm_Hz / (2.0 * np.pi):.6g}",
             "[sensors]", f"current_bits = {bench.bits}", f"current_full_scale_A = {bench.full_scale_A:.9g}",
             f"current_noise_A = {bench.noise_A:.9g}",
             # The second plant's encoder counts, as noise of the same size.
             f"angle_noise_rad = {2.0 * np.pi * motor.pole_pairs / bench.encoder_counts / np.sqrt(12.0):.6g}",
             f"speed_noise_rad_s = {bench.omega_noise * omega_max:.6g}",
             f"u_dc_noise_V = {bench.u_dc_noise * motor.u_dc_V:.6g}",
             "[log]"]
    for key, on in (("voltages", bench.columns != "duty"), ("duties", bench.columns != "u"),
                    ("third_current", bench.has_i_c), ("mid_currents", bench.has_mid),
                    ("mechanical_angle", True)):  # for the oracle; without_column() takes it out again
        lines.append(f"{key} = {'true' if on else 'false'}")
    for (omega, i), swing in zip(bench.points, bench.swing):
        rpm = omega / motor.pole_pairs * 30.0 / np.pi
        lines += ["[[run]]", f"cycles = {cycles}", f"theta_mech_start_rad = {rng.uniform(0.0, 2.0 * np.pi):.6f}",
                  f"speed_rpm = {{ at_s = [0.0, {cycles * T_s:.9g}], ramp = {toml_list([rpm, rpm * (1.0 - swing)])} }}",
                  reference(rng, "i_d_A", i.real, bench.excitation * I_pk, T_s, cycles),
                  reference(rng, "i_q_A", i.imag, bench.excitation * I_pk, T_s, cycles)]
    return "\n".join(lines) + "\n"


def effect_arguments(case, model):
    """One --effect per hidden effect, from the true model."""
    half_s = 0.5 * case.motor.span_s  # there the clock of iqfoc simulate begins

    def drifts(names, middle, rate):
        return {name + end: value for name, x, v in zip(names, middle, rate)
                for end, value in (("", x - v * half_s), ("_rate", v))}
    sets = {
        "resistance": lambda: {"R": model.R_ohm}, "flux_linkage": lambda: {"psi_f": model.psi_f_Wb},
        "saliency": lambda: {"L_d": model.L_d_H, "L_q": model.L_q_H},
        # "L_0" there is the mean of the two axes.
        "saturation": lambda: {"L_0": 0.5 * (model.L_d_H + model.L_q_H), "I_sat": model.I_sat_A},
        "dead_time": lambda: {"t_dead": model.t_dead_s, "v_switch": model.V_switch_V, "v_diode": model.V_diode_V},
        "dead_time_over": lambda: {"t_dead": model.t_dead_s, "compensation": model.compensation_V},
        "dead_time_compensated": lambda: sets["dead_time_over"](),
        "voltage_gain": lambda: {"k_u": model.k_u},
        "current_offset": lambda: dict(zip(("o_a", "o_b", "o_c"), model.o_A)),
        "current_gain": lambda: dict(zip(("g_a", "g_b", "g_c"), model.g)),
        "angle_offset": lambda: {"theta_0": model.theta_0_rad},
        "angle_harmonic_electrical": lambda: sets["angle_harmonic"](),
        "angle_harmonic": lambda: {"order": model.order, "amplitude": model.amplitude_rad, "phase": model.phase_rad},
        "angle_delay": lambda: {"t_delay": model.t_delay_s},
        "sensor_lag": lambda: {"tau": model.sensor_lag_s},
        "voltage_delay": lambda: {"cycles": model.delay_cycles},
        "voltage_delay_half": lambda: {"cycles": model.delay_cycles},
        "emf_harmonics": lambda: {"psi_5": model.psi_5_Wb, "psi_7": model.psi_7_Wb},
        "emf_harmonics_high": lambda: {"psi_5": model.psi_5_Wb, "psi_11": model.psi_11_Wb, "psi_13": model.psi_13_Wb},
        "phase_asymmetry": lambda: dict(zip(("dR_a", "dR_b", "dR_c"), model.dR_ohm)),
        "phase_inductance": lambda: dict(zip(("dL_a", "dL_b", "dL_c"), model.dL_H)),
        "resistance_drift": lambda: drifts(["R"], [model.R_ohm], [model.R_rate_ohm_s]),
        "flux_linkage_drift": lambda: drifts(["psi_f"], [model.psi_f_Wb], [model.psi_rate_Wb_s]),
        "current_offset_drift": lambda: drifts(("o_a", "o_b", "o_c"), model.o_A, model.o_rate_A_s),
        "current_gain_drift": lambda: drifts(("g_a", "g_b", "g_c"), model.g, model.g_rate_s),
        "dc_link_ripple": lambda: {"frequency": model.u_ripple_Hz, "share": model.u_ripple},
        "speed_lag": lambda: {"tau": model.speed_lag_s},
        "angle_order": lambda: sets["angle_harmonic"](),
        "temperature": lambda: {
            "alpha_R": model.alpha_R, "alpha_psi": model.alpha_psi, "heating": model.heating_K,
            "tau": case.motor.span_s / 3.0, "reference": model.heating_K * (1.0 - (1.0 - np.exp(-3.0)) / 3.0)},
        "turn_short": lambda: dict(zip(("turns", "R", "tau", "phase"), (*model.short[:3], model.short[3] + 1))),
        "weak_pole": lambda: {"share": model.weak_pole},
        "hum": lambda: {"amplitude": model.pick_up["hum_A"], "frequency": model.pick_up["hum_Hz"],
                        "channel": 0 if model.pick_up["hum_channel"] is None else model.pick_up["hum_channel"] + 1},
        "common_hum": lambda: sets["hum"](),
        "switching_noise": lambda: {"amplitude": model.pick_up["edge_A"], "tau": model.pick_up["edge_s"],
                                    "coupling": model.pick_up["edge_coupling"]},
        "crosstalk": lambda: {"share": model.pick_up["crosstalk"]},
        "sensor_hysteresis": lambda: {"width": model.hysteresis_A},
        "encoder_interpolation": lambda: sets["angle_harmonic"](),
        "iron_loss": lambda: {"R_fe": model.R_iron_ohm, "tau_fe": model.tau_iron_s},
        "glitch": lambda: {"probability": model.glitch_rate},
        # Two samples a cycle there, one decision a cycle here; bursts of 1 to 12 cycles.
        "loose_sensor": lambda: {"probability": 0.5 * model.loose_rate, "channel": model.loose_phase, "samples": 13,
                                 "gain": model.loose_factor},
        "loose_of_two": lambda: sets["loose_sensor"](),
        "sensor_fault": lambda: {"phase": model.loose_phase + 1, "probability": 0.5 * model.loose_rate, "samples": 13,
                                 "gain": model.loose_factor}}
    out = []
    for name in case.ids:
        # "inductance" there makes both axes equal; a salient motor's two are set one by one.
        settings = sets["saliency" if name == "inductance" else name]()
        program_id = {"inductance": "saliency", "glitch": "glitch", "loose_of_two": "loose_sensor", "angle_order": "angle_harmonic",
                      "encoder_interpolation": "angle_harmonic", "common_hum": "hum"}.get(name, effects.cause_of(name))
        out += ["--effect", program_id + ":" + ",".join(f"{k}={v:.12g}" for k, v in settings.items())]
    return out


def for_the_diagnosis(lines, has_mech):
    """The recording without its comments, which name the effects, and without the mechanical angle unless drawn."""
    rows = [line for line in lines if not line.startswith("#")]
    if has_mech:
        return rows
    at = rows[0].rstrip("\r\n").split(",").index("theta_mech_rad")
    split = (row.rstrip("\r\n").split(",") for row in rows)
    return [",".join(row[:at] + row[at + 1:]) + "\n" for row in split]


# The firmware does not know of a voltage delay: beyond one cycle in so many per turn its control loop would not run.
SFFR_WITH_LATE_VOLTAGE = 45.0


def make(seed, kind, folder, iqfoc, sizes=None, bench_kind="usual", with_digits=False):
    """Writes rec.csv, motor.toml and truth.json of a case simulated by `iqfoc simulate`."""
    case = draw.draw_case(seed, kind, bench_kind, with_digits)
    sizes = draw.draw_sizes(case) if sizes is None else sizes
    model, parameters, columns = simulate(case, sizes, folder, iqfoc)
    generate.write_truth(draw.truth_of(case, sizes, model, parameters, columns, "main"), folder)


def simulate(case, sizes, folder, iqfoc):
    """Writes rec.csv and motor.toml; returns the true model, the effects' parameters and the columns."""
    # Here the runs are of one length and follow one another after pauses of ten cycles.
    case.motor.span_s = (case.bench.runs * int(np.mean(case.bench.rows)) + (case.bench.runs - 1) * 9) / case.motor.f_pwm_Hz
    model, parameters = draw.true_model(case.motor, case.ids, sizes, case.directions, case.bench.has_i_c)
    if model.delay_cycles:
        limit = 2.0 * np.pi * case.motor.f_pwm_Hz / SFFR_WITH_LATE_VOLTAGE
        case.bench.points = [(omega * min(1.0, limit / max(abs(w) for w, _ in case.bench.points)), i)
                             for omega, i in case.bench.points]
    cycles = int(np.mean(case.bench.rows))
    case.bench.rows = [cycles] * case.bench.runs
    os.makedirs(folder, exist_ok=True)
    recording = os.path.join(folder, "rec.csv")
    generate.write_text(folder, "motor.toml", generate.motor_text(case.file))
    with tempfile.TemporaryDirectory(prefix="scenario-") as scratch:
        scenario, raw = os.path.join(scratch, "scenario.toml"), os.path.join(scratch, "raw.csv")
        generate.write_text(scratch, "true.toml", generate.motor_text(case.motor))
        with open(scenario, "w", encoding="utf-8") as file:
            file.write(scenario_text(case, cycles))
        command = [iqfoc, "simulate", "--motor", os.path.join(scratch, "true.toml"), "--scenario", scenario, "-o", raw,
                   "--seed", str(case.seed)]
        command += effect_arguments(case, model)
        done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
        if done.returncode != 0:
            raise RuntimeError(f"iqfoc simulate, exit {done.returncode}: {done.stderr.strip()}")
        with open(raw, encoding="utf-8", newline="") as source:
            lines = for_the_diagnosis(source, case.bench.has_mech)
        with open(recording, "w", encoding="utf-8", newline="") as file:
            file.writelines(lines)
        runs = reading.read_columns(raw, case.motor.pole_pairs)
    columns = {name: np.concatenate([r[name] for r in runs], axis=-1) for name in runs[0]}
    return model, parameters, columns
