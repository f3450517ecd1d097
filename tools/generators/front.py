"""front users: the table of the front page, each row with a number that the program or a file of the tree gives.
front release: the newest release set of the blind tests, from docs/release-sets.md.

    <!-- figures: front users -->
"""

import json
import re

from .markdown import table

MOTOR = "data/motors/jarzebowicz2019.toml"
RECORDING = "data/recordings/dead_time"
ROW = re.compile(r"^\| (.+?) \| (\d+) \| (.+?) \| (.+?) \| .+ \|$", re.MULTILINE)
SHOWN = {
    "single effects named exactly": "one cause: named exactly",
    "pairs named exactly": "two causes: both named, nothing else",
    "triples named exactly": "three causes: all named, nothing else",
    "clean recordings with no cause": "no cause: none named",
    "unknown effects with a false cause": "a cause outside the catalogue: a wrong cause named",
    "benches: the larger causes named with their values, no false name": "benches: the larger causes named with their values, no false name",
    "effects outside the catalogue on benches: a false cause": "effects outside the catalogue on benches: a wrong cause named",
    "one speed: a false cause": "one speed: a wrong cause named",
    "true parameters inside their 95 % interval": "true values inside their 95 % interval",
}


def newest_set(program):
    """(number, {what: (of how many, measured, 95 % confidence)}) of the last set on the page."""
    page = (program.root / "docs/release-sets.md").read_text(encoding="utf-8")
    found = list(re.finditer(r"^Release set (\d+), commit \w+:$", page, re.MULTILINE))
    if not found:
        raise ValueError("docs/release-sets.md has no release set")
    rows = {what: (of, measured, span) for what, of, measured, span in ROW.findall(page[found[-1].end():])}
    return found[-1][1], rows


def release(program):
    number_of_set, rows = newest_set(program)
    lines = [(words, *rows[what]) for what, words in SHOWN.items() if what in rows]
    heads = ["hidden in the recording", "recordings or values", f"release set {number_of_set}", "95 % confidence"]
    return table(heads, lines, right=heads[1:3])


def counts(program):
    """The benchmark's row of the two interrupts on a Cortex-M4."""
    rows = json.loads((program.root / "bench/baseline.json").read_text(encoding="utf-8"))["cortex-m4"]
    return next(row for row in rows if row["function"] == "isr_cycle")


def users(program):
    isr = counts(program)
    listed = program.output(str(program.path), "simulate", "--list-effects")
    effects = len(re.findall(r"^  \w", listed, re.MULTILINE))  # the default sizes are indented further
    errors = program.json("sweep", "--motor", MOTOR, "--rpm", "8000")["points"][0]
    prediction = {method: f"{value:.2g}" for method, value in errors["prediction"].items()}
    single = newest_set(program)[1]["single effects named exactly"]
    rows = [
        ("You write a drive's firmware", "`cmake -S . -B build/library -DIQFOC_LIBRARY_ONLY=ON && cmake --build build/library`",
         f"current control in C99 without floating point: {isr['mean']:.0f} instructions per PWM period on a Cortex-M4 (QEMU), all checks included"),
        ("You test on a PC what you will flash",
         f"`build/host/iqfoc simulate --motor {MOTOR} --scenario data/scenarios/identification.toml -o build/recording.csv`",
         f"the firmware's own code against a drive with every switching edge; {effects} effects can be switched on"),
        ("You choose a method or a chip", f"`build/host/iqfoc sweep --motor {MOTOR} --rpm 8000`",
         f"the error of each method: at {errors['sffr']:.3g} PWM periods per electrical period a prediction errs by "
         f"{prediction['standard']} % (standard), {prediction['quasi_discrete']} % (quasi-discrete), {prediction['exact']} % (exact)"),
        ("You have a recording from the bench", f"`build/host/iqfoc diagnose {RECORDING}.csv.gz --motor {RECORDING}.toml`",
         f"the cause with its value: one hidden cause is named exactly in {single[1]} of {single[0]} simulated recordings"),
    ]
    return table(["who", "first command", "what you get"], rows)


def generate(program, arguments):
    kinds = {"users": users, "release": release}
    if len(arguments) != 1 or arguments[0] not in kinds:
        raise ValueError(f"expected one of {', '.join(kinds)}, got {arguments}")
    return kinds[arguments[0]](program)
