"""tune WHAT MOTOR [OPTION VALUE]...: tables of `iqfoc tune`.

    <!-- figures: tune margins motors/jarzebowicz2019.toml --ratio 5 -->
    <!-- figures: tune trial motors/jarzebowicz2019.toml --ratio 5 --drives 200 -->
    <!-- figures: tune comparison motors/jarzebowicz2019.toml --ratio 5 -->
"""

from .markdown import number, table

CONTROLLERS = {
    "pi_midpoint": "PI, mid-point sample",
    "pi_mean": "PI, quasi-discrete mean",
    "deadbeat_exact": "deadbeat, exact",
    "tuned_pi": "tuned PI",
    "tuned_deadbeat": "tuned deadbeat",
    "deadbeat_true": "deadbeat, exact, of the true machine",
}
TRUTHS = ("nominal", "L low", "L high")


def short(value):
    """Two to three digits are what a closed loop repeats to on another machine."""
    return "-" if value is None else number(float(f"{value:.3g}"))


def margins(result):
    heads = ["rpm", "SFFR", "disk margin", "gain margin, dB", "phase margin, deg", "delay margin, cycles", "nominal disk margin"]
    rows = [[f"{point['rpm']:.0f}", "-" if point["sffr"] is None else f"{point['sffr']:.3g}", f"{point['disk_margin']:.2f}",
             f"{point['gain_margin_dB']:.1f}", f"{point['phase_margin_deg']:.0f}", f"{point['delay_margin_cycles']:.2f}",
             f"{point['nominal']['disk_margin']:.2f}"] for point in result["points"][::2]]
    return f"Bandwidth {result['bandwidth_rad_s']:.0f} rad/s, limited by {result['limited_by']}.\n\n" + table(heads, rows, right=heads)


def trial(result):
    found = result["trial"]
    heads = ["", "promised", "found"]
    rows = [["largest overshoot, % of the step", f"{found['promised']['overshoot_percent']:.0f}",
             f"{found['found']['overshoot_percent']:.0f}"],
            ["longest settling, cycles", f"{found['promised']['settling_cycles']:.0f}", f"{found['found']['settling_cycles']:.0f}"],
            ["unstable", "0", found["unstable"]],
            ["settled later than promised by more than a tenth and a cycle", "0", found["late"]],
            ["overshot by more than promised and a tenth of the step", "0", found["high"]]]
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


PARTS = {"margins": margins, "trial": trial, "comparison": comparison}


def generate(program, arguments):
    if len(arguments) < 2 or len(arguments) % 2 or arguments[0] not in PARTS:
        raise ValueError(f"expected one of {', '.join(sorted(PARTS))}, a motor file and pairs of option and value, got {arguments}")
    what, motor, *options = arguments
    return f"{PARTS[what](program.json('tune', '--motor', motor, *options))}\n"
