"""tune WHAT MOTOR [OPTION VALUE]...: tables of `iqfoc tune`.

    <!-- figures: tune margins data/motors/jarzebowicz2019.toml --ratio 5 -->
    <!-- figures: tune trial data/motors/jarzebowicz2019.toml --ratio 5 --drives 200 -->
    <!-- figures: tune comparison data/motors/jarzebowicz2019.toml --ratio 5 -->
    <!-- figures: tune observer data/motors/jarzebowicz2019.toml --ratio 5 -->
    <!-- figures: tune choices data/motors/jarzebowicz2019.toml --ratio 5 -->
    <!-- figures: tune speed data/motors/jarzebowicz2019.toml --ratio 5 --inertia 1e-3 -->
    <!-- figures: tune steady data/motors/jarzebowicz2019.toml --ratio 5 -->
"""

from .markdown import number, table

CONTROLLERS = {
    "pi_midpoint": "PI, mid-point sample",
    "pi_mean": "PI, quasi-discrete mean",
    "deadbeat_exact": "deadbeat, exact",
    "tuned_pi": "tuned PI",
    "tuned_deadbeat": "tuned deadbeat",
    "deadbeat_true": "deadbeat, exact, true machine",
}
TRUTHS = ("nominal", "L low", "L high")


def short(value):
    """Three digits: further ones may differ between machines."""
    return "-" if value is None else number(float(f"{value:.3g}"))


def margins(result):
    heads = ["rpm", "SFFR", "disk margin", "gain margin, dB", "phase margin, deg", "delay margin, cycles", "nominal disk margin"]
    rows = [[f"{point['rpm']:.0f}", "-" if point["sffr"] is None else f"{point['sffr']:.3g}", f"{point['disk_margin']:.2f}",
             f"{point['gain_margin_dB']:.1f}", f"{point['phase_margin_deg']:.0f}", f"{point['delay_margin_cycles']:.2f}",
             f"{point['nominal']['disk_margin']:.2f}"] for point in result["points"][::2]]
    return f"Bandwidth {result['bandwidth_rad_s']:.0f} rad/s, limited by {result['limited_by']}.\n\n" + table(heads, rows, right=heads)


def trial(result):
    found = result["trial"]
    heads = ["", "predicted", "simulated"]
    rows = [["largest overshoot, % of the step", f"{found['promised']['overshoot_percent']:.0f}",
             f"{found['found']['overshoot_percent']:.0f}"],
            ["longest settling, cycles", f"{found['promised']['settling_cycles']:.0f}", f"{found['found']['settling_cycles']:.0f}"],
            ["unstable drives", "0", found["unstable"]],
            ["drives that settle later than predicted, by more than a tenth and a cycle", "0", found["late"]],
            ["drives that overshoot by a tenth of the step more than predicted", "0", found["high"]]]
    return f"{found['drives']} drives, up to {found['rpm_most']:.0f} rpm.\n\n" + table(heads, rows, right=heads[1:])


def comparison(result):
    loops = result["comparison"]["loops"]
    heads = ["SFFR", "controller"]
    for truth in TRUTHS:
        heads += [f"{truth}: rms error, %", "overshoot, %", "settling, cycles"]
    rows = []
    for ratio in (5, 8, 10, 20):
        for controller, text in CONTROLLERS.items():
            row = [f"{ratio:g}", text]
            for truth in TRUTHS:
                cell = next((loop for loop in loops if (loop["sffr"], loop["controller"], loop["truth"]) == (ratio, controller, truth)),
                            None)
                if cell is None or cell["outcome"] == "trips":
                    row += ["trips" if cell else "-", "-", "-"]
                else:
                    unstable = " unstable" if cell["outcome"] == "unstable" else ""
                    row += [short(cell["rms_percent"]) + unstable, f"{cell['overshoot_percent']:.0f}",
                            "-" if cell["settling_cycles"] is None else cell["settling_cycles"]]
            rows.append(row)
    return table(heads, rows, right=[head for head in heads if head != "controller"])


def steady(result):
    """The tuned controllers' steady error over that of deadbeat control that knows the true machine, least and largest of the truths."""
    errors = {(loop["sffr"], loop["controller"], loop["truth"]): loop["rms_percent"] for loop in result["comparison"]["loops"]}
    heads = ["SFFR", "least ratio of the steady errors", "largest"]
    rows = []
    for sffr in sorted({key[0] for key in errors}):
        ratios = [errors[sffr, controller, truth] / errors[sffr, "deadbeat_true", truth]
                  for controller in ("tuned_pi", "tuned_deadbeat") for truth in TRUTHS]
        rows.append([f"{sffr:g}", f"{min(ratios):.2f}", f"{max(ratios):.2f}"])
    return table(heads, rows, right=heads)


def observer(result):
    found, trial = result["observer"], result["observer"]["trial"]
    worst = min(found["points"], key=lambda point: point["disk_margin"])
    heads = ["rpm", "SFFR", "disk margin", "nominal", "angle error, degrees", "noise of the angle, degrees rms", "of the speed, %"]
    rows = [[f"{point['rpm']:.0f}", f"{point['sffr']:.3g}", f"{point['disk_margin']:.2f}", f"{point['disk_margin_nominal']:.2f}",
             f"{point['angle_error_deg']:.1f}", f"{point['angle_noise_deg']:.3f}", f"{point['speed_noise_percent']:.3f}"]
            for point in found["points"][1::2]]
    return (f"Bandwidth {found['bandwidth_rad_s']:.0f} rad/s, largest gain {found['gain_max']:g}. Worst disk margin: {worst['disk_margin']:.2f} at "
            f"{worst['rpm']:.0f} rpm with\n{worst['worst_machine']}.\n\n" + table(heads, rows, right=heads) +
            f"\n\n{trial['drives']} drives in the plant: unstable {trial['unstable']}, lock lost {trial['lost']}. Largest steady angle error: "
            f"predicted {trial['predicted_deg']:.1f} degrees,\nsimulated {trial['simulated_deg']:.1f}; largest difference in one drive "
            f"{trial['off_deg']:.2f}.\n")


def speed(result):
    found = result["speed"]
    heads = ["inertia, kg m2", "overshoot of the run-up, rpm", "dip, rpm", "back within a tenth of the predicted dip, ms"]
    rows = [[short(one["J_kgm2"]), f"{one['overshoot_rpm']:.0f}", f"{one['dip_rpm']:.0f}", f"{1000 * one['settled_s']:.0f}"]
            for one in found["trial"]]
    return (f"Bandwidth {found['bandwidth_rad_s']:.0f} rad/s, a step every {found['cycles']} cycles, disk margin {found['disk_margin']:.2f} "
            f"(stated inertia: {found['disk_margin_nominal']:.2f}).\nRamp {found['ramp_rpm_s']:.0f} rpm/s; a load of "
            f"{100 * found['load_share']:.0f} % of the rated torque, predicted dip {found['dip_rpm']:.0f} rpm.\n\n" +
            table(heads, rows, right=heads) + "\n")


def choices(result):
    heads = ["bandwidth, rad/s", "run-up, s", "noise of the angle, degrees rms", "worst disk margin"]
    rows = [[f"{one['bandwidth_rad_s']:.0f}", f"{one['run_up_s']:.2g}", f"{one['angle_noise_deg']:.3f}", f"{one['disk_margin']:.2f}"]
            for one in result["observer"]["choices"]]
    return table(heads, rows, right=heads)


PARTS = {"speed": speed, "observer": observer, "choices": choices, "steady": steady, "margins": margins, "trial": trial, "comparison": comparison}


def generate(program, arguments):
    if len(arguments) < 2 or len(arguments) % 2 or arguments[0] not in PARTS:
        raise ValueError(f"expected one of {', '.join(sorted(PARTS))}, a motor file and pairs of option and value, got {arguments}")
    what, motor, *options = arguments
    return f"{PARTS[what](program.json('tune', '--motor', motor, *options))}\n"
