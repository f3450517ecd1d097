#!/usr/bin/env python3
"""
Study of the self-commissioning on drawn drives: how often an interval holds the truth, and how often it overlaps with the interval of
`iqfoc diagnose` on the recorder's dump of the same run.

    tests/commission/study.py --build build/host --drives 6            prints, exit status 1 if a property does not hold
    tests/commission/study.py --build build/host --drives 200 --compared 200 --rows rows.jsonl --json tests/commission/study.json

Properties: every run is done; no phase current exceeds 1.3 times the alignment's; of all intervals at least 85 % hold the truth, and of all
pairs of intervals at least 90 % overlap. docs/commissioning.md has the shares.
"""
import argparse
import concurrent.futures
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

DONE = 1
# By the diagnosis' name; offsets are parameters of a cause there.
NAMES = {"R": "R", "v_dead": "v_dead", "L_d": "L_d", "L_q": "L_q", "psi": "psi_f", "o_a": "o_a", "o_b": "o_b", "o_c": "o_c"}

# The sensors' gains scale every result of the commissioning, so the diagnosis may not change them: otherwise no current and no voltage
# determines the common factor of R, L_d, L_q, psi_f and v_dead.
SCALES = "voltage_gain,current_gain"


def diagnosed(found):
    """Name: interval, of what the diagnosis states."""
    values = {e["name"]: e["ci95"] for e in found["estimates"] if e["excited"] and e["ci95"]}
    for cause in found["causes"]:
        values.update({p["name"]: p["ci95"] for p in cause["parameters"] if p["name"].startswith("o_") and p["ci95"]})
    return values


def drive(build, number, compared):
    with tempfile.TemporaryDirectory(prefix="iqfoc-commission-") as name:
        folder = pathlib.Path(name)

        def run(*words):
            return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout

        words = run(build / "tests/commission_study", number, folder / "stream", folder / "motor.toml").split()
        other = {}
        if compared:
            run(build / "iqfoc", "record", "--port", folder / "stream", "-o", folder / "rec.csv")
            run(build / "iqfoc", "diagnose", folder / "rec.csv", "--motor", folder / "motor.toml", "--skip", SCALES,
                "--json", folder / "found.json")
            other = diagnosed(json.loads((folder / "found.json").read_text(encoding="utf-8")))
    row = {"number": number, "compared": compared, "end": int(words[0]), "cycles": int(words[1]), "highest": float(words[2]), "values": {}}
    for k in range(3, len(words), 4):
        truth, value, half = (float(x) for x in words[k + 1:k + 4])
        low, high = other.get(NAMES[words[k]], (None, None))
        row["values"][words[k]] = {
            "half": half / abs(truth), "miss": (value - truth) / half, "diagnosed": low is not None,
            "overlap": low is not None and low <= value + half and high >= value - half,
            "diagnosis_right": low is not None and low <= truth <= high,
            "diagnosis_miss": None if low is None else (0.5 * (low + high) - truth) / (0.5 * (high - low)),
            "diagnosis_half": None if low is None else 0.5 * (high - low) / abs(truth)}
    return row


def summary(rows):
    table = {}
    for name in NAMES:
        values = [row["values"][name] for row in rows if row["end"] == DONE]
        both = [v for v in values if v["diagnosed"]]
        table[name] = {"drives": len(values), "held": sum(abs(v["miss"]) <= 1.0 for v in values),
                       "median_half": statistics.median(v["half"] for v in values),
                       "worst": max(abs(v["miss"]) for v in values), "diagnosed": len(both), "overlap": sum(v["overlap"] for v in both),
                       "apart_held": sum(abs(v["miss"]) <= 1.0 for v in both if not v["overlap"]),
                       "apart_diagnosis_right": sum(v["diagnosis_right"] for v in both if not v["overlap"]),
                       "diagnosis_right": sum(v["diagnosis_right"] for v in both),
                       "diagnosis_median_half": statistics.median(v["diagnosis_half"] for v in both) if both else None}
    return {"drives": len(rows), "compared": sum(row["compared"] for row in rows), "done": sum(row["end"] == DONE for row in rows), "highest": max(row["highest"] for row in rows),
            "cycles": statistics.median(row["cycles"] for row in rows), "values": table}


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n", maxsplit=1)[0])
    parser.add_argument("--build", type=pathlib.Path, required=True, help="folder of the host's build")
    parser.add_argument("--drives", type=int, default=6)
    parser.add_argument("--first", type=int, default=0, help="number of the first drive")
    parser.add_argument("--compared", type=int, default=2, help="diagnose the first of them")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--rows", type=pathlib.Path, help="keep each drive's row in this file, and continue from it")
    parser.add_argument("--json", type=pathlib.Path, help="write the shares to this file")
    options = parser.parse_args()
    rows = []
    if options.rows and options.rows.exists():
        rows = [json.loads(line) for line in options.rows.read_text(encoding="utf-8").splitlines()]
    rows = [row for row in rows if row["compared"] >= (row["number"] < options.first + options.compared)]
    missing = sorted(set(range(options.first, options.first + options.drives)) - {row["number"] for row in rows})
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for row in pool.map(lambda number: drive(options.build, number, number < options.first + options.compared), missing):
            rows.append(row)
            if options.rows:
                with options.rows.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
    found = summary(rows)
    print(f"{found['done']} of {found['drives']} done, highest phase current {found['highest']:.3f} i_align")
    for name, v in found["values"].items():
        print(f"{name:7} {v['held']} of {v['drives']} hold the truth, median half width {100 * v['median_half']:.2f} %; "
              f"{v['overlap']} of {v['diagnosed']} overlap with the diagnosis")
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    values = found["values"].values()
    good = (found["done"] == found["drives"] and found["highest"] < 1.3
            and sum(v["held"] for v in values) >= 0.85 * sum(v["drives"] for v in values)
            and sum(v["overlap"] for v in values) >= 0.9 * sum(v["diagnosed"] for v in values))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
