#!/usr/bin/python3
"""The diagnosis on a drive that no one here wrote: recordings of motulator's machines with effects hidden around them (third_plant.py).

    tests/blind/third.py            all 64; fails below nine tenths
    tests/blind/third.py --ci       a fixed part of them
    tests/blind/third.py --digits   with last-digit errors in every motor file (digits.py)
    tests/blind/third.py --group bench --count 8     recordings that look like a bench (bench, bench_half, steady, outside)

A recording takes some ten seconds to make, so they are kept in .cache/third until what makes them changes. Needs motulator in
.cache/python/motulator, which `./dev blind` installs.
"""

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, HERE)

import digits
import figure
import generate
import group_score
import run as blind
import score

PYTHON = os.path.join(ROOT, ".cache", "python", "motulator", "bin", "python")
ASKED = 0.9
GROUPS = ("bench", "bench_half", "steady", "outside")
FIRST_SEED = 400_000

ALONE = ["resistance", "inductance", "flux_linkage", "saliency", "dead_time", "voltage_gain", "current_offset", "current_gain",
         "angle_offset", "angle_delay"]
JOINED = ["resistance+angle_offset", "flux_linkage+dead_time", "inductance+angle_delay", "voltage_gain+current_offset",
          "resistance+current_gain", "flux_linkage+angle_offset", "saliency+resistance", "dead_time+current_offset"]
# A machine with a flux map, and the constants at no current in its file.
MAPPED = ["saturation_dq"] * 6 + [f"saturation_dq+{x}" for x in ("resistance", "resistance", "angle_offset", "dead_time", "voltage_gain",
                                                               "current_offset")]
SET = [(machine, kind) for machine in ("ipmsm", "spmsm") for kind in ["clean"] * 2 + ALONE + JOINED]
SET += [(machine, kind) for machine in ("pmsyrm", "syrm") for kind in MAPPED]
# Over the whole range of the map: up to twice the rated current.
WIDE = [("pmsyrm", "saturation_dq+wide"), ("syrm", "saturation_dq+wide")]
# In four runs of the last one the drive loses its operating point, and its currents the sensors' range.
CI = WIDE + [("ipmsm", "clean"), ("spmsm", "clean"), ("ipmsm", "angle_offset"), ("spmsm", "resistance"), ("ipmsm", "dead_time"),
      ("spmsm", "resistance+angle_offset"), ("pmsyrm", "saturation_dq+dead_time")]


def cases(only):
    """Every recording in the form that third_plant.py takes."""
    every = [{"machine": m, "kind": k, "seed": FIRST_SEED + n} for n, (m, k) in enumerate(SET + WIDE)]
    if not only:
        return every[:len(SET)]
    return [next(c for c in every if (c["machine"], c["kind"]) == wanted) for wanted in only]


def version():
    """Hash of the code that makes a recording: if it changes, kept recordings are made again."""
    text = b""
    for name in ("third_plant.py", "generate.py"):
        with open(os.path.join(HERE, name), "rb") as file:
            text += file.read()
    return hashlib.sha256(text).hexdigest()[:12]


def prepare(case, kept):
    """The folder of a recording, made unless it is there: under another name first, so that a cut one is not taken for whole."""
    folder = os.path.join(kept, "-".join([case["machine"], case["kind"], str(case["seed"])]))
    if not os.path.exists(os.path.join(folder, "truth.json")):
        with tempfile.TemporaryDirectory(dir=kept) as scratch:
            made = os.path.join(scratch, "made")
            one_thread = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
            done = subprocess.run([PYTHON, os.path.join(HERE, "third_plant.py"), made], input=json.dumps(case), text=True,
                                  capture_output=True, env=one_thread, timeout=1200)
            if done.returncode != 0:
                raise RuntimeError(f"third_plant.py: {done.stderr.strip()[-400:]}")
            shutil.rmtree(folder, ignore_errors=True)
            os.rename(made, folder)
    return folder


def write_digits(folder, truth):
    """A second motor file, with deviations within the tolerance in what is not hidden."""
    with open(os.path.join(folder, "motor.toml"), "rb") as file:
        tables = tomllib.load(file)
    motor = SimpleNamespace(name=tables["name"], **tables["motor"], **tables["inverter"])
    errors = digits.relative_errors(truth["seed"], motor, [e["id"] for e in truth["effects"]])
    generate.write_text(folder, "motor-digits.toml", generate.motor_text(digits.file_of(motor, errors)))


def group_cases(group, count, first):
    """So many recordings of a group: the two machines without a flux map take turns, shifted where four effects do, too."""
    return [{"machine": ("ipmsm", "spmsm")[(n + n // 4) % 2], "kind": group, "seed": first + n} for n in range(count)]


def one_case(case, kept, iqfoc, with_digits):
    """The judged recording, or the words in which it failed."""
    try:
        folder = prepare(case, kept)
        with open(os.path.join(folder, "truth.json"), encoding="utf-8") as file:
            truth = json.load(file)
        if truth["kind"] == "clean":
            truth["effects"] = []
        write_digits(folder, truth)
        judge = group_score.judge if case["kind"] in GROUPS else score.judge
        return judge(truth, blind.diagnose(folder, iqfoc, motor="motor-digits.toml" if with_digits else "motor.toml"))
    except Exception as problem:  # a refusal, a crash or a hang: counted as not right
        return f"{case['machine']} {case['kind']}: {type(problem).__name__}: {problem}"


def table(judged):
    """Right ones and all of each machine, in Markdown."""
    lines = ["| machine | recordings | named exactly |", "|---|---|---|"]
    for machine in dict.fromkeys(r["plant"] for r in judged):
        mine = [r["exact"] for r in judged if r["plant"] == machine]
        lines.append(f"| {machine} | {len(mine)} | {sum(mine)} |")
    low, high = score.confidence(sum(r["exact"] for r in judged), len(judged))
    lines.append(f"| all | {len(judged)} | {sum(r['exact'] for r in judged)} ({100.0 * low:.0f} to {100.0 * high:.0f} %) |")
    inside = [p["inside"] for r in judged for p in r["parameters"] if p["counted"]]
    lines += ["", f"{sum(inside)} of {len(inside)} true parameters lie inside their 95 % interval."]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ci", action="store_true", help="the fixed part")
    parser.add_argument("--group", choices=GROUPS, help="recordings of this group (groups.py) instead")
    parser.add_argument("--count", type=int, default=8, help="how many of --group")
    parser.add_argument("--first", type=int, default=FIRST_SEED + 1_000, help="first seed of --group")
    parser.add_argument("--digits", action="store_true", help="with last-digit errors in every motor file")
    parser.add_argument("--iqfoc", default=os.path.join(ROOT, "build", "host", "iqfoc"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--keep", default=os.path.join(ROOT, ".cache", "third"), help="where the recordings are kept")
    parser.add_argument("--docs", action="store_true", help="write the results into docs/blind_tests.md")
    args = parser.parse_args()
    if not os.access(PYTHON, os.X_OK):
        parser.error("no motulator in .cache/python/motulator; ./dev blind installs it")
    if args.docs and (args.ci or args.group):
        parser.error("--docs: the page holds the whole set, without --ci and --group")
    kept = os.path.join(os.path.abspath(args.keep), version())
    os.makedirs(kept, exist_ok=True)
    chosen = group_cases(args.group, args.count, args.first) if args.group else cases(CI if args.ci else None)
    with ThreadPoolExecutor(args.jobs) as pool:
        told = list(pool.map(lambda case: one_case(case, kept, os.path.abspath(args.iqfoc), args.digits), chosen))
    judged = [r for r in told if not isinstance(r, str)]
    failures = [r for r in told if isinstance(r, str)]
    if args.group:
        for line in group_score.report(judged, []) + [f"failed: {words}" for words in failures]:
            print(line)
        return 1 if failures else 0
    for r in judged:
        if not r["exact"]:
            print(f"miss: {r['plant']} seed {r['seed']}: hidden {'+'.join(r['hidden']) or 'nothing'}, "
                  f"named {'+'.join(r['named']) or 'nothing'} ({r['verdict']})")
        for p in r["parameters"]:
            if not p["inside"]:
                print(f"outside: {r['plant']} seed {r['seed']}: {p['id']}.{p['name']} true {p['true']:.6g}, interval {p['ci95']}")
    for words in failures:
        print(f"failed: {words}")
    print(table(judged), end="")
    if args.docs:
        figure.fill_page("third", table(judged))
    right = sum(r["exact"] for r in judged)
    reached = right >= ASKED * len(chosen)
    print(f"third plant: {right} of {len(chosen)} right, {'as asked' if reached else f'below {100.0 * ASKED:.0f} %'}")
    return 0 if reached else 1


if __name__ == "__main__":
    sys.exit(main())
