"""watch WHAT MOTOR [OPTION VALUE]...: tables of `iqfoc watch`.

    <!-- figures: watch trials motors/compressor_salient.toml --trials 60 --cycles 1e5 -->
    <!-- figures: watch clean motors/compressor_salient.toml --trials 60 --cycles 1e5 -->
"""

from .markdown import table

CHANGES = {"magnet": "magnet 5 % weaker", "winding": "winding 60 K warmer", "sensor": "a sensor's gain 2 % higher",
           "dead_time": "dead time doubled"}


def trials(result):
    heads = ["change", "drives", "noted within 1 s", "right group", "alarm before it", "median, s", "latest, s", "amount", "since"]
    rows = [[CHANGES[t["change"]], t["trials"], t["noted"], t["right"], t["early"], f"{t['median_s']:.3f}", f"{t['latest_s']:.2f}",
             f"{t['amount']:.1f}", t["since_within_0.1_s"]] for t in result["trials"]]
    return table(heads, rows, right=heads[1:])


def clean(result):
    found = result["clean"]
    heads = ["level", "passed", "the bound"]
    rows = [[level, found["passed"][level - 1], f"{found['cycles'] / 32 * 22 / 2.718281828459045 ** level:.3g}"]
            for level in (2, 4, 6, 8, 10, 12)]
    return f"{found['cycles']:.3g} cycles, {found['alarms']} alarms.\n\n" + table(heads, rows, right=heads)


PARTS = {"trials": trials, "clean": clean}


def generate(program, arguments):
    if len(arguments) < 2 or len(arguments) % 2 or arguments[0] not in PARTS:
        raise ValueError(f"expected one of {', '.join(sorted(PARTS))}, a motor file and pairs of option and value, got {arguments}")
    what, motor, *options = arguments
    return f"{PARTS[what](program.json('watch', '--motor', motor, *options))}\n"
