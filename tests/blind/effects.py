"""The hidden effects: what each does to the true drive, how large it may be, and what the truth file says of it.

An effect is a direction drawn once (signs, which phase, shape) and a size; its share of the one-cycle error is about
proportional to the size, so that generate.py can scale it to a chosen multiple of the noise floor.
"""

import copy

import numpy as np

from second_plant import FluxMap

CAUSES = ["resistance", "inductance", "flux_linkage", "saliency", "saturation", "dead_time", "voltage_gain",
          "current_offset", "current_gain", "angle_offset", "angle_harmonic", "angle_delay", "voltage_delay",
          "emf_harmonics", "phase_asymmetry"]
# Causes that came after the published seeds. They are asked for by name only: were they among the above, each seed that
# draws its effects would draw others.
LATER = [
    "phase_inductance",
    "saturation_dq",
    "resistance_drift", "flux_linkage_drift", "current_offset_drift", "current_gain_drift",
    "voltage_delay_half",
    "emf_harmonics_high",
    "angle_harmonic_electrical",
    "dead_time_over",
    "iron_loss",
    "temperature",
    "sensor_lag",
    "glitch",
    "speed_lag",
    "dc_link_ripple",
    "sensor_fault",
]
KNOWN = CAUSES + LATER
# What had no name when the published seeds were drawn. A loose contact among three sensors has one now, of two it has none.
UNKNOWN = ["dc_link_ripple", "iron_loss", "glitch", "loose_sensor"]
# Effects without a name: in the release sets, and by name. An angle's error of an order that no sensor's wrong fit has.
UNNAMED = ["loose_of_two", "angle_order"]
# More of them, which no set holds: by name only, to see that no rule was made for the above alone. A sensor that lags behind
# itself where the current turns, the mains in the voltage, a magnet whose flux differs around the rotor.
STRANGERS = ["sensor_hysteresis", "mains_hum", "flux_order"]
# A dead time that its compensation leaves a share of: for the benches in groups.py, and by name.
OF_BENCHES = ["dead_time_compensated"]
# Of the group "outside" in groups.py: what no cause stands for.
OUTSIDE = ["turn_short", "weak_pole", "hum", "common_hum", "switching_noise", "crosstalk", "encoder_interpolation", "sensor_hysteresis"]
DRAWN_BY_NAME = KNOWN + UNKNOWN + UNNAMED + STRANGERS + OF_BENCHES + OUTSIDE[:-1]
# The averaged model does not know them, or not in which cycles.
NOT_AVERAGED = UNNAMED + STRANGERS + OUTSIDE + ["glitch", "dc_link_ripple", "sensor_fault", "loose_sensor"]

# Least and largest size: what a bench plausibly shows. Relative to the file's value, the rated peak current, a cycle
# (dead time, delay) or radians.
RANGE = {
    "resistance": (0.08, 0.8), "inductance": (0.02, 0.35), "flux_linkage": (0.01, 0.2), "saliency": (0.03, 0.3),
    "saturation": (0.03, 0.3), "dead_time": (0.002, 0.03), "voltage_gain": (0.01, 0.15),
    "current_offset": (0.005, 0.08), "current_gain": (0.01, 0.1), "angle_offset": (0.01, 0.2),
    "angle_harmonic": (0.008, 0.1), "angle_delay": (0.04, 0.8), "voltage_delay": (1.0, 1.0),
    "emf_harmonics": (0.005, 0.08), "phase_asymmetry": (0.1, 1.2), "phase_inductance": (0.02, 0.35),
    "saturation_dq": (0.1, 0.5),
    "voltage_delay_half": (1.0, 1.0), "dead_time_over": (0.002, 0.03),
    "dead_time_compensated": (0.002, 0.03),
    "turn_short": (0.005, 0.04), "weak_pole": (0.02, 0.3), "hum": (0.003, 0.03), "common_hum": (0.003, 0.03),
    "switching_noise": (0.02, 0.3), "crosstalk": (0.005, 0.05), "encoder_interpolation": (0.003, 0.03),
    # What drifts: its change over the recording.
    "resistance_drift": (0.12, 0.6), "flux_linkage_drift": (0.02, 0.12), "current_offset_drift": (0.015, 0.08),
    "current_gain_drift": (0.02, 0.1), "emf_harmonics_high": (0.004, 0.03), "angle_harmonic_electrical": (0.008, 0.1),
    "temperature": (20.0, 70.0), "sensor_lag": (0.06, 0.2),
    "dc_link_ripple": (0.02, 0.12), "iron_loss": (0.02, 0.12), "glitch": (0.002, 0.03), "loose_sensor": (0.0005, 0.004),
    "speed_lag": (40.0, 160.0), "sensor_fault": (0.0005, 0.004), "loose_of_two": (0.0005, 0.004), "angle_order": (0.008, 0.1),
    "sensor_hysteresis": (0.003, 0.04), "mains_hum": (0.002, 0.03), "flux_order": (0.005, 0.08)}



def plants_of(kind):
    """The plants that know a kind. Iron of a flux map is drawn as an algebraic law: the main plant's is of the family that is fitted."""
    return ("second",) if any(name in kind for name in ["saturation_dq"] + STRANGERS) else ("second", "main")


# Of each group one effect contains another or can stand in for it (docs/diagnosis.md), so that a pair never has two of them.
GROUPS = [{"inductance", "saliency", "saturation", "phase_inductance", "saturation_dq"}, {"resistance", "phase_asymmetry"},
          {"current_gain", "inductance"}, {"angle_delay", "sensor_lag"}, {"angle_delay", "speed_lag"}]
WITHOUT_SIZE = {"voltage_delay", "voltage_delay_half"}


def cause_of(effect):
    """The cause's id: of a variant, such as a value that drifts or a delay that is no whole number, it is that cause's."""
    for variant in ("_drift", "_half", "_high", "_electrical", "_over", "_compensated"):
        effect = effect.removesuffix(variant)
    return {"glitch": "missed_update"}.get(effect, effect)


def told_as(effect, has_i_c):
    """Its id in a truth file, and whether a diagnosis has a name for it."""
    if effect == "loose_sensor" and has_i_c:
        return "sensor_fault", True
    return cause_of(effect), effect in KNOWN + OF_BENCHES


def compatible(a, b):
    return cause_of(a) != cause_of(b) and not any(a in group and b in group for group in GROUPS)


def draw_direction(rng, effect, has_i_c):
    """Everything about an effect but its size."""
    d = {"sign": float(rng.choice([-1.0, 1.0])), "phase": int(rng.integers(3)), "angle": rng.uniform(0.0, 2.0 * np.pi)}
    if effect == "saliency":
        while True:
            d["d"], d["q"] = rng.uniform(-1.0, 1.0, 2)
            if max(abs(d["d"]), abs(d["q"])) > 0.6 and abs(d["d"] - d["q"]) > 0.6:
                break
    if cause_of(effect) in ("current_offset", "current_gain"):
        # Offsets without a common part, which a floating star would not show; gains differ, with a small common part.
        x = rng.standard_normal(3)
        x -= x.mean()
        if not has_i_c:
            x = np.array([x[0], x[1], 0.0]) if cause_of(effect) == "current_gain" else x
        common = cause_of(effect) == "current_gain" and has_i_c
        d["x"] = x / np.abs(x).max() + (0.1 * rng.uniform(-1.0, 1.0) if common else 0.0)
    if effect == "angle_harmonic":
        d["order"] = int(rng.integers(1, 3))
    if effect == "emf_harmonics":
        d["c5"], d["c7"] = rng.choice([-1.0, 1.0], 2) * rng.uniform(0.4, 1.0, 2)
    if effect == "angle_harmonic_electrical":
        d["times"] = int(rng.integers(1, 3))
    if effect == "emf_harmonics_high":
        d["c5"], d["c11"], d["c13"] = rng.choice([-1.0, 1.0], 3) * rng.uniform(0.4, 1.0, 3) * [rng.choice([0.0, 1.0]), 1, 1]
    if effect == "dead_time":
        d["drop"] = float(rng.choice([0.0, 0.0, 0.4]))
    if effect == "dead_time_over":
        d["over"] = float(rng.uniform(1.5, 2.5))
    if effect == "dead_time_compensated":
        d["left"] = float(rng.choice([-1.0, 1.0, 1.0]) * rng.uniform(0.3, 0.8))
    if effect == "voltage_delay_half":
        d["cycles"] = float(rng.choice([0.5, 0.5, 1.5]))
    if effect == "saturation":
        d["file_is_unsaturated"] = bool(rng.random() < 0.6)
    if effect == "saturation_dq":
        d["d_share"], d["c_share"] = rng.uniform(0.1, 0.5), rng.uniform(0.3, 1.0)
        d["right_at"] = float(rng.choice([0.1, 0.5, 0.9]))
        d["powers"] = rng.uniform(3.0, 6.0), rng.uniform(1.5, 4.0), 1.0, float(rng.integers(2))
    if effect == "dc_link_ripple":
        d["Hz"] = float(rng.choice([100.0, 300.0, 360.0]))
    if effect == "mains_hum":
        d["Hz"] = float(rng.choice([50.0, 60.0]))
    if effect in ("hum", "common_hum"):
        d["Hz"] = float(rng.choice([50.0, 60.0]))
    if effect == "switching_noise":
        d["tau"], d["coupling"] = float(rng.uniform(0.05, 0.3)), float(rng.choice([0.0, 0.3]))
    if effect == "turn_short":
        d["turns"], d["tau"] = float(rng.uniform(0.03, 0.15)), float(rng.uniform(0.2, 0.6))
    if effect == "encoder_interpolation":
        d["order"] = int(rng.choice([32, 64, 128, 256, 512]) * rng.integers(1, 3))
    if effect == "flux_order":
        d["order"] = int(rng.choice([1, 2, 4]))
    if effect in ("loose_sensor", "loose_of_two", "sensor_fault"):
        d["factor"] = float(rng.choice([0.0, 0.0, 0.5]))
    return d


def iron(motor, size, d):
    """A flux map whose q inductance falls by the share `size` at the rated current, the d axis' by less of it, both by
    each other; at `right_at` of that current (i_d = -i_q/2) it has the inductances of the motor file.
    """
    I_pk = motor.I_rated_A_rms * np.sqrt(2.0)
    i = np.array([d["right_at"] * I_pk * (-0.5 + 0.85j)])
    S, T, U, V = d["powers"]
    L_d, L_q = motor.L_d_H, motor.L_q_H
    for _ in range(200):
        # At these fluxes, those of the rated current, each term takes its share of the current.
        psi_d, psi_q = motor.psi_f_Wb + 0.3 * L_d * I_pk, (1.0 - size) * L_q * I_pk
        made = FluxMap(motor.psi_f_Wb, L_d, L_q, d["d_share"] * size / L_d / psi_d ** S,
                       size / (1.0 - size) / L_q / psi_q ** T,
                       d["c_share"] * size / L_q / (psi_d ** (U + 1.0) * psi_q ** (V + 1.0)), *d["powers"])
        psi = made.flux(i)[0]
        off_d = (psi.real - motor.psi_f_Wb) / i[0].real / motor.L_d_H
        off_q = psi.imag / i[0].imag / motor.L_q_H
        L_d, L_q = L_d * off_d ** -0.5, L_q * off_q ** -0.5
        if abs(off_d - 1.0) + abs(off_q - 1.0) < 1e-9:
            break
    return made


def factor(size, sign):
    """1 + size up, its reciprocal down: both are the same step on a ratio."""
    return (1.0 + size) ** sign


def apply(model, motor, effect, size, d, has_i_c):
    """Changes the true model in place; returns the parameters as the truth file states them.

    Each parameter: name, unit, value, and compare (false where this recording cannot show the value).
    """
    I_pk, T_s = motor.I_rated_A_rms * np.sqrt(2.0), 1.0 / motor.f_pwm_Hz

    def truth(name, unit, value, compare=True):
        return {"name": name, "unit": unit, "value": float(value), "compare": compare}

    if effect == "resistance":
        model.R_ohm = motor.R_ohm * factor(size, d["sign"])
        return [truth("R", "ohm", model.R_ohm)]
    if effect == "inductance":
        model.L_d_H, model.L_q_H = motor.L_d_H * factor(size, d["sign"]), motor.L_q_H * factor(size, d["sign"])
        return [truth("L", "H", 0.5 * (model.L_d_H + model.L_q_H), motor.L_d_H == motor.L_q_H)]
    # What drifts begins at the file's value; the truth holds its value at the recording's middle, and its rate.
    if effect == "resistance_drift":
        change = motor.R_ohm * size * d["sign"]
        model.R_ohm, model.R_rate_ohm_s = motor.R_ohm + 0.5 * change, change / motor.span_s
        return [truth("R", "ohm", model.R_ohm), truth("R_rate", "ohm/s", model.R_rate_ohm_s)]
    if effect == "flux_linkage_drift":
        change = motor.psi_f_Wb * size * d["sign"]
        model.psi_f_Wb, model.psi_rate_Wb_s = motor.psi_f_Wb + 0.5 * change, change / motor.span_s
        return [truth("psi_f", "Wb", model.psi_f_Wb), truth("psi_f_rate", "Wb/s", model.psi_rate_Wb_s)]
    if effect == "current_offset_drift":
        model.o_A, model.o_rate_A_s = 0.5 * size * I_pk * d["x"], size * I_pk * d["x"] / motor.span_s
        return [truth(f"o_{p}{rate}", "A", x[n]) for n, p in enumerate("abc")
                for rate, x in (("", model.o_A), ("_rate", model.o_rate_A_s))]
    if effect == "current_gain_drift":
        model.g, model.g_rate_s = 1.0 + 0.5 * size * d["x"], size * d["x"] / motor.span_s
        return [truth(f"g_{p}{rate}", "1", x[n], has_i_c or p != "c") for n, p in enumerate("abc")
                for rate, x in (("", model.g), ("_rate", model.g_rate_s))]
    if effect == "flux_linkage":
        model.psi_f_Wb = motor.psi_f_Wb * factor(size, d["sign"])
        return [truth("psi_f", "Wb", model.psi_f_Wb)]
    if effect == "saliency":
        model.L_d_H, model.L_q_H = motor.L_d_H * (1.0 + size * d["d"]), motor.L_q_H * (1.0 + size * d["q"])
        return [truth("L_d", "H", model.L_d_H), truth("L_q", "H", model.L_q_H)]
    if effect == "saturation":
        model.I_sat_A = I_pk / np.sqrt(size)
        if not d["file_is_unsaturated"]:
            # The file's inductance is right at about half the rated current instead of at zero.
            model.L_d_H = model.L_q_H = motor.L_q_H * (1.0 + 0.25 * size)
        return [truth("L_0", "H", model.L_q_H), truth("I_sat", "A", model.I_sat_A)]
    if effect == "saturation_dq":
        model.flux_map = iron(motor, size, d)
        # The truth is no polynomial: its terms are not compared, what it gains is.
        return [truth("L_d0", "H", model.flux_map.L_d_H, False), truth("L_q0", "H", model.flux_map.L_q_H, False)]
    if effect == "dead_time":
        model.t_dead_s = size * T_s
        total = size * motor.u_dc_V * (1.0 + d["drop"])
        drop = d["drop"] * size * motor.u_dc_V
        model.V_switch_V, model.V_diode_V, model.v_dead_V = 1.2 * drop, 0.8 * drop, total
        return [truth("v_dead", "V", total), truth("i_knee", "A", 0.0, False)]
    if effect == "dead_time_over":
        # Compensated by more than is lost.
        model.t_dead_s = size * T_s
        model.compensation_V = d["over"] * size * motor.u_dc_V
        model.v_dead_V = size * motor.u_dc_V * (1.0 - d["over"])
        return [truth("v_dead", "V", model.v_dead_V), truth("i_knee", "A", 0.0, False)]
    if effect == "dead_time_compensated":
        model.t_dead_s = size * T_s
        model.compensation_V = (1.0 - d["left"]) * size * motor.u_dc_V
        model.v_dead_V = d["left"] * size * motor.u_dc_V
        return [truth("v_dead", "V", model.v_dead_V), truth("i_knee", "A", 0.0, False)]
    if effect == "voltage_gain":
        model.k_u = factor(size, d["sign"])
        return [truth("k_u", "1", model.k_u)]
    if effect == "current_offset":
        model.o_A = size * I_pk * d["x"]
        return [truth(f"o_{p}", "A", model.o_A[n]) for n, p in enumerate("abc")]
    if effect == "current_gain":
        model.g = 1.0 + size * d["x"]
        return [truth(f"g_{p}", "1", model.g[n], has_i_c or p != "c") for n, p in enumerate("abc")]
    if effect == "angle_offset":
        model.theta_0_rad = size * d["sign"]
        return [truth("theta_0", "rad", model.theta_0_rad)]
    if effect == "angle_harmonic":
        model.order, model.amplitude_rad, model.phase_rad = d["order"], size, d["angle"]
        # Without a mechanical angle the revolution's start is open, and so is the phase.
        return [truth("order", "1", d["order"]), truth("amplitude", "rad", size),
                truth("phase", "rad", d["angle"], False)]
    if effect == "angle_harmonic_electrical":
        model.order, model.amplitude_rad, model.phase_rad = d["times"] * motor.pole_pairs, size, d["angle"]
        return [truth("order", "1", model.order), truth("amplitude", "rad", size),
                truth("phase", "rad", d["angle"], False)]
    if effect == "angle_delay":
        model.t_delay_s = size * T_s * d["sign"]
        return [truth("t_delay", "s", model.t_delay_s)]
    if effect == "sensor_lag":
        # A filter: samples that are late see no edge and are an angle's delay.
        model.sensor_lag_s = size * T_s
        return [truth("tau", "s", model.sensor_lag_s)]
    if effect == "voltage_delay":
        model.delay_cycles = 1
        return [truth("cycles", "1", 1.0)]
    if effect == "voltage_delay_half":
        # Compare registers that load at the carrier's peak.
        model.delay_cycles = d["cycles"]
        return [truth("cycles", "1", d["cycles"])]
    if effect == "emf_harmonics":
        model.psi_5_Wb, model.psi_7_Wb = size * motor.psi_f_Wb * d["c5"], size * motor.psi_f_Wb * d["c7"]
        return [truth("psi_5", "Wb", model.psi_5_Wb), truth("psi_7", "Wb", model.psi_7_Wb)]
    if effect == "emf_harmonics_high":
        # With a 5th, or without any.
        model.psi_5_Wb, model.psi_11_Wb, model.psi_13_Wb = (size * motor.psi_f_Wb * d[c] for c in ("c5", "c11", "c13"))
        return [truth("psi_5", "Wb", model.psi_5_Wb), truth("psi_11", "Wb", model.psi_11_Wb),
                truth("psi_13", "Wb", model.psi_13_Wb)]
    if effect == "temperature":
        # Copper and a magnet, warming by so many kelvins; the file's values are those at the recording's mean.
        model.alpha_R, model.alpha_psi, model.heating_K = 0.0039, -0.0011, size
        return [truth("alpha_R", "1/K", model.alpha_R), truth("alpha_psi", "1/K", model.alpha_psi)]
    if effect == "phase_asymmetry":
        model.dR_ohm = np.zeros(3)
        model.dR_ohm[d["phase"]] = size * motor.R_ohm
        return [truth(f"dR_{p}", "ohm", model.dR_ohm[n]) for n, p in enumerate("abc")]
    if effect == "phase_inductance":
        model.dL_H = np.zeros(3)
        model.dL_H[d["phase"]] = 0.5 * (motor.L_d_H + motor.L_q_H) * (factor(size, d["sign"]) - 1.0)
        return [truth(f"dL_{p}", "H", model.dL_H[n]) for n, p in enumerate("abc")]
    if effect == "dc_link_ripple":
        model.u_ripple, model.u_ripple_Hz = size, d["Hz"]
        return [truth("share", "1", size), truth("frequency", "Hz", d["Hz"])]
    if effect == "speed_lag":
        model.speed_lag_s = size * T_s
        return [truth("tau", "s", model.speed_lag_s)]
    if effect == "angle_order":
        model.order = 3 if motor.pole_pairs != 3 else 5
        model.amplitude_rad, model.phase_rad = size, d["angle"]
        return [truth("order", "1", model.order, False)]
    if effect == "sensor_hysteresis":
        model.hysteresis_A = size * I_pk
        return [truth("width", "A", model.hysteresis_A, False)]
    if effect == "mains_hum":
        model.hum_V, model.hum_Hz, model.hum_phase = size * motor.u_dc_V, d["Hz"], d["phase"]
        return [truth("amplitude", "V", model.hum_V, False)]
    if effect == "flux_order":
        model.flux_order, model.flux_share, model.flux_rad = d["order"], size, d["angle"]
        return [truth("share", "1", size, False)]
    if effect == "turn_short":
        # The fault's current shows at the terminals by so much of the rated one at top speed.
        emf_V = motor.n_max_rpm * np.pi / 30.0 * motor.pole_pairs * motor.psi_f_Wb
        fault_ohm = max(2.0 / 3.0 * d["turns"] ** 2 * emf_V / (size * I_pk) - d["turns"] * motor.R_ohm, 0.0)
        model.short = (d["turns"], fault_ohm, d["tau"] * T_s, d["phase"])
        return [truth("turns", "1", d["turns"], False)]
    if effect == "weak_pole":
        model.weak_pole = size
        return [truth("share", "1", size, False)]
    if effect in ("hum", "common_hum"):
        model.pick_up = {"hum_A": size * I_pk, "hum_Hz": d["Hz"], "hum_channel": None if effect == "common_hum" else d["phase"]}
        return [truth("amplitude", "A", size * I_pk, False)]
    if effect == "switching_noise":
        model.pick_up = {"edge_A": size * I_pk, "edge_s": d["tau"] * T_s, "edge_coupling": d["coupling"]}
        return [truth("amplitude", "A", size * I_pk, False)]
    if effect == "crosstalk":
        model.pick_up = {"crosstalk": size * d["sign"]}
        return [truth("share", "1", size * d["sign"], False)]
    if effect == "encoder_interpolation":
        # Sine and cosine of unlike size or offset: once or twice a line.
        model.order, model.amplitude_rad, model.phase_rad = d["order"], size, d["angle"]
        return [truth("amplitude", "rad", size, False)]
    if effect == "iron_loss":
        omega_max = motor.n_max_rpm * np.pi / 30.0 * motor.pole_pairs
        model.R_iron_ohm, model.tau_iron_s = omega_max * motor.psi_f_Wb / (size * I_pk), 0.5 * T_s
        return [truth("R_fe", "ohm", model.R_iron_ohm), truth("tau_fe", "s", model.tau_iron_s)]
    if effect == "glitch":
        model.glitch_rate = size
        return [truth("share", "1", size)]
    if effect in ("loose_sensor", "loose_of_two", "sensor_fault"):
        model.loose_rate, model.loose_factor = size, d["factor"]
        model.loose_phase = d["phase"] if has_i_c else d["phase"] % 2
        return [truth("phase", "1", model.loose_phase + 1.0, has_i_c)]
    raise ValueError(f"no such effect: {effect}")


def nominal_model(motor, blank):
    """The motor file as a true model: nothing hidden."""
    model = copy.deepcopy(blank)
    model.R_ohm, model.L_d_H, model.L_q_H, model.psi_f_Wb = motor.R_ohm, motor.L_d_H, motor.L_q_H, motor.psi_f_Wb
    return model
