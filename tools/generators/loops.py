"""loops WHAT [RATIO...]: tables of `iqfoc loops`.

    <!-- figures: loops six_step -->
    <!-- figures: loops ratios 5 10 20 50 -->
    <!-- figures: loops beliefs 5 10 20 50 -->
    <!-- figures: loops finite_set 20.15 50.15 100.15 -->
    <!-- figures: loops trade -->
    <!-- figures: loops run_up -->
    <!-- figures: loops updates 5 8 12 -->
    <!-- figures: loops corrected_mean -->
    <!-- figures: loops sensorless -->
    <!-- figures: loops pulse_modes 2019 -->
    <!-- figures: loops extended data/motors/jarzebowicz2019.toml data/scenarios/identification.toml dead_time saturation resistance:R=1.0 -->

`extended` records a drive with these effects, diagnoses it, and compares control by both motor files.
"""

import json
import pathlib
import tempfile

from .markdown import number, table

LOOPS = {
    "pi_midpoint": "PI, mid-point sample",
    "pi_mean": "PI, quasi-discrete mean",
    "deadbeat_euler": "deadbeat, Euler",
    "deadbeat_quasi_discrete": "deadbeat, quasi-discrete",
    "deadbeat_exact": "deadbeat, exact",
    "learning_euler": "observer, Euler",
    "learning_quasi_discrete": "observer, quasi-discrete",
    "learning_exact": "observer, exact",
}
BELIEFS = {"right": "right", "L+30": "L +30 %", "L-30": "L -30 %", "psi+10": "psi +10 %", "psi-10": "psi -10 %",
           "R+50": "R +50 %", "R-50": "R -50 %", "noise": "noise"}


def short(value):
    """Three digits: further ones may differ between machines."""
    return "-" if value is None else number(float(f"{value:.3g}"))


def six_step(result, _ratios):
    heads = ["feedback", "set-point, A", "fed back, A", "true i_q, A", "excess, %", "torque, Nm", "of the set-point, Nm"]
    rows = [[loop["feedback"], *(f"{loop[key]:.3f}" for key in ("i_q_reference_A", "i_q_fed_back_A", "i_q_A")),
             f"{loop['excess_percent']:.2f}", f"{loop['torque_Nm']:.3f}", f"{loop['torque_reference_Nm']:.3f}"]
            for loop in result["six_step"]]
    return table(heads, rows, right=heads[1:])


def ratios(result, wanted):
    heads = ["SFFR", "loop", "", "rms error, %", "constant part, %", "start, %", "overshoot, %", "settling, cycles", "THD, %",
             "stable up to L"]
    rows = []
    for point in result["current"]:
        if point["belief"] == "right" and point["sffr"] in wanted:
            settling = point["settling_cycles"]
            rows.append([f"{point['sffr']:g}", LOOPS[point["loop"]], point["outcome"], short(point["rms_percent"]),
                         short(point["offset_percent"]), short(point["start_percent"]), short(point["overshoot_percent"]),
                         "-" if settling is None else settling, short(point["thd_percent"]), f"{point['L_most']:.1f}"])
    return table(heads, rows, right=[head for head in heads if head not in ("loop", "")])


def beliefs(result, wanted):
    cells = {}
    for point in result["current"]:
        text = short(point["rms_percent"])
        if point["outcome"] == "trips":
            text = "trips"
        elif point["outcome"] == "unstable":
            text += " unstable"
        cells[point["sffr"], point["loop"], point["belief"]] = text
    heads = ["SFFR", "loop", *BELIEFS.values()]
    rows = [[f"{ratio:g}", LOOPS[loop], *(cells[ratio, loop, belief] for belief in BELIEFS)]
            for ratio in wanted for loop in LOOPS]
    return table(heads, rows, right=["SFFR", *BELIEFS.values()])


def finite_set_rows(points):
    return [[f"{point['intervals']:g}", point["predictor"], point["horizon"] or "-", f"{point['weight']:g}",
             short(point["rms_percent"]), short(point["offset_percent"]), short(point["thd_percent"]),
             f"{point['switching_Hz']:.0f}", f"{point['nodes']:.0f}" if point["horizon"] else "-"] for point in points]


FINITE_SET_HEADS = ["intervals per period", "predictor", "horizon", "weight", "rms error, %", "constant part, %", "THD, %",
                    "pulses per leg and second", "currents predicted per decision"]


def finite_set(result, wanted):
    rows = finite_set_rows(point for point in result["finite_set"] if point["intervals"] in wanted)
    return table(FINITE_SET_HEADS, rows, right=[head for head in FINITE_SET_HEADS if head != "predictor"])


def trade(result, _ratios):
    rows = finite_set_rows(result["finite_set_trade"])
    return table(FINITE_SET_HEADS, rows, right=[head for head in FINITE_SET_HEADS if head != "predictor"])


def updates(result, wanted):
    heads = ["SFFR", "loop", "updates", "constant error, %", "not constant, %", "start, %", "overshoot, %", "settling, periods"]
    rows = [[f"{point['sffr']:g}", LOOPS[point["loop"]], point["updates"],
             *(short(point[key]) for key in ("offset_percent", "wander_percent", "start_percent", "overshoot_percent")),
             "-" if point["settling_periods"] is None else f"{point['settling_periods']:g}"]
            for point in result["updates"] if point["sffr"] in wanted]
    return table(heads, rows, right=[head for head in heads if head != "loop"])


def corrected_mean(result, _ratios):
    heads = ["SFFR", "highest stable bandwidth, Hz", "default, Hz", "default in the plant", "80 % of the highest in the plant"]
    rows = [[f"{loop['sffr']:g}", f"{loop['bandwidth_most_Hz']:.3g}" if loop["bandwidth_most_Hz"] else "none",
             f"{loop['bandwidth_default_Hz']:.3g}", loop["outcome_default"], loop["outcome_below"] or "-"]
            for loop in result["corrected_mean"]]
    return table(heads, rows, right=heads[:3])


def sensorless(result, _ratios):
    """One row for each ratio and load; what belongs to the step is in the row of the full load."""
    keys = ("overshoot_measured_percent", "overshoot_observed_percent", "step_difference_percent")
    heads = ["SFFR", "load, %", "angle: bias, degrees", "rms", "speed: rms, %", "overshoot, measured angle, %", "observed angle",
             "largest difference, %"]
    rows = [[f"{loop['sffr']:g}", f"{100 * loop['load']:.0f}", f"{round(loop['bias_deg'], 2) + 0.0:.2f}", f"{loop['rms_deg']:.2f}",
             f"{loop['speed_rms_percent']:.3f}", *("" if loop[key] is None else f"{loop[key]:.1f}" for key in keys)]
            for loop in result["sensorless"]]
    if not all(loop["locked"] for loop in result["sensorless"]):
        raise ValueError("a drive on the observed angle lost its lock")
    return table(heads, rows, right=heads)


def run_up(result, _ratios):
    heads = ["modulation", "more torque, %", "less, %", "lowest i_d", "voltage over u_dc", "pulses per turn"]
    rows = [[run["text"], *(f"{abs(run[key]):.1f}" for key in ("more_percent", "less_percent")), f"{run['i_d_least']:.2f}",
             f"{run['voltage_most']:.3f}", f"{run['pulses_per_turn']:.1f}"] for run in result["run_up"]]
    return table(heads, rows, right=heads[1:])


def pulse_modes(program, drive):
    """The modes of one drive of `iqfoc loops --pulse-modes`."""
    runs = [run for run in program.json("loops", "--pulse-modes")["pulse_modes"] if run["drive"] == drive]
    if len(runs) != 1:
        raise ValueError(f"no drive is named '{drive}'")
    columns = {"up, from Hz": ("up_from_Hz", 0), "down, to Hz": ("down_to_Hz", 0), "pulses a second, at most": ("pulses_per_second", 0),
               "distortion, %": ("distortion_percent", 1), "space vectors, %": ("space_vectors_percent", 1),
               "torque error, %": ("torque_error_percent", 1)}
    rows = [[mode["mode"], *("-" if mode[key] is None else f"{mode[key]:.{digits}f}" for key, digits in columns.values())]
            for mode in runs[0]["modes"]]
    return table(["mode", *columns], rows, right=list(columns))


def extended(program, motor, scenario, *effects):
    options = [word for effect in effects for word in ("--effect", effect)]
    with tempfile.TemporaryDirectory() as folder:
        recording, diagnosis, result = (str(pathlib.Path(folder) / name) for name in ("recording.csv", "diagnosis", "loops.json"))
        program.output(str(program.path), "simulate", "--motor", motor, "--scenario", scenario, "-o", recording, *options)
        program.output(str(program.path), "diagnose", recording, "--motor", motor, "-o", diagnosis)
        program.output(str(program.path), "loops", "--motor", motor, "--extended", f"{diagnosis}/motor_extended.toml", *options,
                       "--json", result)
        points = json.loads(pathlib.Path(result).read_text(encoding="utf-8"))["extended"]
    heads = ["rpm", "loop", "parameters", "rms error, %", "torque error, %", "torque ripple, %"]
    rows = [[f"{point['rpm']:g}", point["loop"], point["belief"],
             *(f"{round(point[key], 2) + 0.0:.2f}" for key in ("rms_percent", "torque_error_percent", "torque_ripple_percent"))] for point in points]
    return table(heads, rows, right=[head for head in heads if head not in ("loop", "parameters")])


PARTS = {"six_step": six_step, "ratios": ratios, "beliefs": beliefs, "finite_set": finite_set, "trade": trade,
         "run_up": run_up, "updates": updates, "corrected_mean": corrected_mean, "sensorless": sensorless}


def generate(program, arguments):
    if len(arguments) >= 3 and arguments[0] == "extended":
        return extended(program, *arguments[1:])
    if len(arguments) == 2 and arguments[0] == "pulse_modes":
        return pulse_modes(program, arguments[1])
    if not arguments or arguments[0] not in PARTS:
        raise ValueError(f"expected one of {', '.join(sorted(PARTS))}, got {arguments}")
    return PARTS[arguments[0]](program.json("loops"), [float(ratio) for ratio in arguments[1:]])
