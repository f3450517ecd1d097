#!/usr/bin/env python3
"""Sensor errors of a drive that reads the two shunts of the lower duties: which sensor is missing changes with the sector.

    two_shunts.py PROGRAM

Simulated with three unequal gains, and with three offsets that have a common part; the diagnosis must find each value.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOTOR = ROOT / "data" / "motors" / "compressor_salient.toml"
HIDDEN = {"current_gain": {"g_a": 1.01, "g_b": 1.03, "g_c": 0.97}, "current_offset": {"o_a": 0.1, "o_b": -0.05, "o_c": 0.15}}


def main():
    program, failures = pathlib.Path(sys.argv[1]).resolve(), 0
    text = (ROOT / "data" / "scenarios" / "identification.toml").read_text(encoding="utf-8")
    assert text.count("[sensors]\n") == 1
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "two.toml").write_text(text.replace("[sensors]\n", '[sensors]\nshunts = "two_lowest"\n'), encoding="utf-8")
        for cause, true in HIDDEN.items():
            effect = cause + ":" + ",".join(f"{key}={value}" for key, value in true.items())
            subprocess.run([program, "simulate", "--motor", MOTOR, "--scenario", "two.toml", "--effect", effect, "--seed", "3", "-o", "r.csv"],
                           cwd=folder, check=True, capture_output=True, timeout=100)
            done = subprocess.run([program, "diagnose", "r.csv", "--motor", MOTOR, "--json", "-"], cwd=folder, check=True,
                                  capture_output=True, timeout=200)
            d = json.loads(done.stdout)
            found = {p["name"]: p for c in d["causes"] for p in c["parameters"]}
            good = d["verdict"] == "explained" and [c["id"] for c in d["causes"]] == [cause]
            good = good and all(found[key]["ci95"][0] <= value <= found[key]["ci95"][1] for key, value in true.items())
            failures += not good
            print("ok   " if good else "FAIL ", effect, d["verdict"], {key: (p["value"], p["ci95"]) for key, p in found.items()})
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
