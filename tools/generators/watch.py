"""watch WHAT MOTOR [OPTION VALUE]...: tables of `iqfoc watch`.

    <!-- figures: watch trials tests/blind/watch_trials.json -->
    <!-- figures: watch clean data/motors/compressor_salient.toml --trials 20 --cycles 1e5 -->
    <!-- figures: watch warming data/motors/compressor_salient.toml --trials 20 --cycles 1e5 -->
    <!-- figures: watch angle data/motors/compressor_salient.toml --trials 20 --cycles 1e5 -->
    <!-- figures: watch conditions data/motors/compressor_salient.toml --trials 20 --cycles 1e5 -->
    <!-- figures: watch long tests/blind/watch_clean.jsonl -->

`trials` reads what `iqfoc watch --trials 200 --json tests/blind/watch_trials.json` wrote, `long` what `tests/blind/watch_clean.py`
ran. Both take too long for a check.
"""

import json
import math
import pathlib

from .markdown import table

CHANGES = {"magnet": "magnet 5 % weaker", "winding": "winding 60 K warmer", "sensor": "a sensor's gain 2 % higher",
           "dead_time": "dead time doubled", "phase": "resistance of one phase 50 % higher", "rotor": "rotor eccentric, 5 % of flux"}
CONDITIONS = {"constant": "constant link, temperatures and inductances", "ripple_1": "link +-1 % at 300 Hz", "ripple_3": "link +-3 % at 300 Hz",
              "temperature": "winding +-10 K, magnet +-5 K, in 20 s, adapted", "saturation_3": "L 3 % lower at rated current, stated",
              "saturation_10": "L 10 % lower at rated current, stated", "load_steps": "torque reversed each 3 to 20 ms"}


def least_share(good, of):
    """The lower end of the 95 % interval of a share (Clopper and Pearson, 1934)."""
    low, high = 0.0, good / of
    for _ in range(50):
        p = 0.5 * (low + high)
        seldom = sum(math.comb(of, k) * p ** k * (1.0 - p) ** (of - k) for k in range(good, of + 1)) < 0.025
        low, high = (p, high) if seldom else (low, p)
    return low


def trials(result):
    heads = ["change", "drives", "detected within 1 s", "right group", "share of right, 95 %", "alarm before the change", "median, s", "latest, s",
             "amount", "since"]
    rows = [[CHANGES[t["change"]], t["trials"], t["noted"], t["right"],
             f"above {100.0 * least_share(t['right'], t['trials']):.1f} %", t["early"], f"{t['median_s']:.3f}", f"{t['latest_s']:.2f}",
             f"{t['amount']:.1f}", t["since_within_0.1_s"]] for t in result["trials"]]
    return table(heads, rows, right=heads[1:])


def levels(found):
    heads = ["level", "times passed", "bound"]
    rows = [[level, found["passed"][level - 1], f"{found['cycles'] / 32 * 30 / 2.718281828459045 ** level:.3g}"]
            for level in (2, 4, 6, 8, 10, 12)]
    return f"{found['cycles']:.3g} cycles, {found['alarms']} alarms.\n\n" + table(heads, rows, right=heads)


def clean(result):
    return levels(result["clean"])


def long(path):
    """Chunks of clean cycles, each a line, summed up."""
    chunks = [json.loads(line) for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines()]
    if len({chunk["seed"] for chunk in chunks}) != len(chunks):
        raise ValueError(f"{path}: a seed occurs twice")
    return levels({"cycles": sum(chunk["cycles"] for chunk in chunks), "alarms": sum(chunk["alarms"] for chunk in chunks),
                   "passed": [sum(of_level) for of_level in zip(*(chunk["passed"] for chunk in chunks))]})


def warming(result):
    found = result["warming"]
    heads = ["", "error of R at the end, %", "of psi_f, %", "largest error of R, %", "of psi_f, %", "prediction error, %", "error of the model's torque, %",
             "alarm"]
    rows = [[words, f"{t['R_off_percent']:+.1f}", f"{t['psi_off_percent']:+.2f}", f"{t['R_most_percent']:.1f}",
             f"{t['psi_most_percent']:.2f}", f"{t['error_percent']:.2f}", f"{t['torque_percent']:.2f}", "yes" if t["alarm"] else "none"]
            for words, t in (("fixed model", found["plain"]), ("adapted model", found["adapted"]))]
    return table(heads, rows, right=heads[1:])


def conditions(result):
    heads = ["no change", "cycles", "alarms", "alarms per 10^6 cycles", "highest sum"]
    rows = [[CONDITIONS[key], f"{c['cycles']:.3g}", c["alarms"], f"{c['alarms_per_million']:.3g}", f"{c['highest']:.1f}"]
            for key, c in result["conditions"].items()]
    return table(heads, rows, right=heads[1:])


ANGLE = {"none": "none", "offset": "offset of 20 degrees", "slip": "slip of 40 degrees", "eccentric": "eccentric, 8 degrees"}


def angle(result):
    heads = ["fault of the angle sensor, electrical", "drives", "right", "named before the fault", "latest, s", "amount off by, at most, degrees"]
    rows = [[ANGLE[t["fault"]], t["trials"], t["right"], t["early"], "-" if t["latest_s"] is None else f"{t['latest_s']:.2f}",
             "-" if t["amount_off_deg"] is None else f"{t['amount_off_deg']:.1f}"] for t in result["angle_sensor"]]
    return table(heads, rows, right=heads[1:])


PARTS = {"angle": angle, "clean": clean, "conditions": conditions, "warming": warming}


def generate(program, arguments):
    if arguments[:1] == ["long"] and len(arguments) == 2:
        return f"{long(program.root / arguments[1])}\n"
    if arguments[:1] == ["trials"] and len(arguments) == 2:
        return f"{trials(json.loads((program.root / arguments[1]).read_text(encoding='utf-8')))}\n"
    if len(arguments) < 2 or len(arguments) % 2 or arguments[0] not in PARTS:
        raise ValueError(f"expected one of {', '.join(sorted(PARTS))}, a motor file and pairs of option and value, got {arguments}")
    what, motor, *options = arguments
    return f"{PARTS[what](program.json('watch', '--motor', motor, *options))}\n"
