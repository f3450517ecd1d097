"""watch WHAT MOTOR [OPTION VALUE]...: tables of `iqfoc watch`.

    <!-- figures: watch trials tests/blind/watch_trials.json -->
    <!-- figures: watch clean motors/compressor_salient.toml --trials 20 --cycles 1e5 -->
    <!-- figures: watch warming motors/compressor_salient.toml --trials 20 --cycles 1e5 -->
    <!-- figures: watch long tests/blind/watch_clean.jsonl -->

The first is what `iqfoc watch --trials 200 --json tests/blind/watch_trials.json` wrote, the last the sum of what
`tests/blind/watch_clean.py` ran: both take longer than a check may.
"""

import json
import math
import pathlib

from .markdown import table

CHANGES = {"magnet": "magnet 5 % weaker", "winding": "winding 60 K warmer", "sensor": "a sensor's gain 2 % higher",
           "dead_time": "dead time doubled"}


def least_share(good, of):
    """The lower end of the 95 % interval of a share (Clopper and Pearson, 1934): at which so many or more are had in 2.5 %."""
    low, high = 0.0, good / of
    for _ in range(50):
        p = 0.5 * (low + high)
        seldom = sum(math.comb(of, k) * p ** k * (1.0 - p) ** (of - k) for k in range(good, of + 1)) < 0.025
        low, high = (p, high) if seldom else (low, p)
    return low


def trials(result):
    heads = ["change", "drives", "noted within 1 s", "right group", "share of right, 95 %", "alarm before it", "median, s", "latest, s",
             "amount", "since"]
    rows = [[CHANGES[t["change"]], t["trials"], t["noted"], t["right"],
             f"above {100.0 * least_share(t['right'], t['trials']):.1f} %", t["early"], f"{t['median_s']:.3f}", f"{t['latest_s']:.2f}",
             f"{t['amount']:.1f}", t["since_within_0.1_s"]] for t in result["trials"]]
    return table(heads, rows, right=heads[1:])


def levels(found):
    heads = ["level", "passed", "the bound"]
    rows = [[level, found["passed"][level - 1], f"{found['cycles'] / 32 * 22 / 2.718281828459045 ** level:.3g}"]
            for level in (2, 4, 6, 8, 10, 12)]
    return f"{found['cycles']:.3g} cycles, {found['alarms']} alarms.\n\n" + table(heads, rows, right=heads)


def clean(result):
    return levels(result["clean"])


def long(path):
    """Chunks of clean cycles, each a line, summed up."""
    chunks = [json.loads(line) for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines()]
    if len({chunk["seed"] for chunk in chunks}) != len(chunks):
        raise ValueError(f"{path}: a seed stands twice")
    return levels({"cycles": sum(chunk["cycles"] for chunk in chunks), "alarms": sum(chunk["alarms"] for chunk in chunks),
                   "passed": [sum(of_level) for of_level in zip(*(chunk["passed"] for chunk in chunks))]})


def warming(result):
    told = result["warming"]
    heads = ["", "R off at the end, %", "psi_f off, %", "at the worst, R, %", "psi_f, %", "prediction error, %", "torque by the model off, %",
             "alarm"]
    rows = [[words, f"{t['R_off_percent']:+.1f}", f"{t['psi_off_percent']:+.2f}", f"{t['R_most_percent']:.1f}",
             f"{t['psi_most_percent']:.2f}", f"{t['error_percent']:.2f}", f"{t['torque_percent']:.2f}", "yes" if t["alarm"] else "none"]
            for words, t in (("as told", told["plain"]), ("followed", told["adapted"]))]
    return table(heads, rows, right=heads[1:])


PARTS = {"clean": clean, "warming": warming}


def generate(program, arguments):
    if arguments[:1] == ["long"] and len(arguments) == 2:
        return f"{long(program.root / arguments[1])}\n"
    if arguments[:1] == ["trials"] and len(arguments) == 2:
        return f"{trials(json.loads((program.root / arguments[1]).read_text(encoding='utf-8')))}\n"
    if len(arguments) < 2 or len(arguments) % 2 or arguments[0] not in PARTS:
        raise ValueError(f"expected one of {', '.join(sorted(PARTS))}, a motor file and pairs of option and value, got {arguments}")
    what, motor, *options = arguments
    return f"{PARTS[what](program.json('watch', '--motor', motor, *options))}\n"
