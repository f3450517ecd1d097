#!/usr/bin/env python3
"""From a recording to firmware: what `iqfoc diagnose -o DIR` writes can be used.

For recordings of a drive that is not ours: the extended motor file makes the same recording clean, the header compiles without a
warning and holds the values found, the gain in firmware code follows that of the exact model, the plant with the named effect errs
as the machine did and is diagnosed alike, and the page holds its charts and where it comes from.

    diagnose_output.py PROGRAM [RECORDING...]
"""

import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
NAMES = sys.argv[2:] or ["dead_time", "flux_and_angle", "saliency", "sensor_gain", "clean"]
WARNINGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]

# Prints the constants as the compiler folded them.
FIRMWARE = """
#include "iqfoc_extension.h"
#include "iqfoc/current_control.h"
#include <stdio.h>
static const iqfoc_extension_t extension = IQFOC_DIAGNOSED_EXTENSION;
static const iqfoc_flux_predictor_t flux = IQFOC_DIAGNOSED_FLUX_PREDICTOR;
static const iqfoc_predictor_t predictor = IQFOC_DIAGNOSED_PREDICTOR;
static const iqfoc_current_control_gains_t gains = IQFOC_DIAGNOSED_GAINS(1256.0);
int main(void)
{
    if (iqfoc_extension_check(&extension) != IQFOC_OK || iqfoc_flux_predictor_check(&flux) != IQFOC_OK ||
        predictor.k_u <= 0 || gains.kp_d <= 0) {
        return 1;
    }
    printf("{\\"v_dead\\": %ld, \\"theta_0\\": %ld, \\"g_a\\": %ld, \\"l_d\\": %ld, \\"l_q\\": %ld, \\"psi\\": %ld}\\n", (long)extension.v_dead,
           (long)extension.theta_0, (long)extension.i_gain_inverse.a, (long)flux.l_d, (long)flux.l_q, (long)flux.psi);
    return 0;
}
"""


def diagnose(recording, motor, *more):
    done = subprocess.run([PROGRAM, "diagnose", recording, "--motor", motor, *map(str, more)], cwd=ROOT, capture_output=True,
                          timeout=1200, check=False, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def values(result):
    return {p["name"]: p["value"] for c in result["causes"] for p in c["parameters"]}


def check_header(folder, result):
    """Compiled by what is there; both compilers must be silent."""
    (folder / "firmware.c").write_text(FIRMWARE)
    compilers = [c for c in ("gcc", "clang", "cc") if shutil.which(c)]
    assert compilers, "no C compiler"
    sources = [ROOT / "src" / name for name in ("extension.c", "flux_predictor.c", "iq24_math.c", "iq24_trig.c")]
    for compiler in compilers:
        made = subprocess.run([compiler, *WARNINGS, "-I", ROOT / "include", "-I", folder, folder / "firmware.c", *sources, "-o",
                               folder / "firmware"], capture_output=True, text=True, check=False)
        assert made.returncode == 0 and not made.stderr, made.stderr
        # The example's header out of the way: -I is searched after the source's own folder.
        shutil.copy(ROOT / "examples/corrected_drive/corrected_drive.c", folder)
        shutil.copy(ROOT / "examples/corrected_drive/corrected_drive.h", folder)
        made = subprocess.run([compiler, *WARNINGS, "-I", ROOT / "include", "-c", folder / "corrected_drive.c",
                               "-o", folder / "corrected_drive.o"], capture_output=True, text=True, check=False)
        assert made.returncode == 0 and not made.stderr, made.stderr
    held = json.loads(subprocess.run([folder / "firmware"], capture_output=True, check=True).stdout)
    found = values(result)
    base = 6.0 * 2 ** 0.5
    flux = 565.0 / 4000.0
    want = {"v_dead": found.get("v_dead", 0.0) / 565.0, "theta_0": found.get("theta_0", 0.0) / 6.283185307179586,
            "g_a": 1.0 / found.get("g_a", 1.0), "psi": found.get("psi_f", 0.2) / flux}
    for name, axis in (("l_d", "L_d"), ("l_q", "L_q")):
        if axis in found:
            want[name] = found[axis] * base / flux
    for name, value in want.items():
        assert abs(held[name] - value * 2 ** 24) <= 1.0, (name, held[name], value * 2 ** 24)
    text = (folder / "iqfoc_extension.h").read_text()
    assert text.count("95 %") == sum(p["ci95"][0] < p["ci95"][1] for c in result["causes"] for p in c["parameters"]), text


def check_page(folder, result):
    page = (folder / "report.html").read_text()
    assert sorted(file.name for file in folder.glob("*.svg")) == [], "the page needs no other pictures"
    assert page.count('class="charts') >= 8, page.count('class="charts')
    ids = re.findall(r'<figure id="([^"]+)"', page)
    assert len(set(ids)) == page.count("<figure"), "a figure's id occurs twice"
    assert not re.search(r"(src|href)=", page[:page.index("<body>")]) and "<img" not in page, "the page needs another file"
    assert not re.search(r">-?nan<", page), "a cell that is no number"
    for data in re.findall(r'<script type="application/json">(.*?)</script>', page, re.DOTALL):
        told = json.loads(data)
        assert told["charts"] and told["columns"], data[:200]
    for file, path in (("recording", result["recording"]), ("motor file", result["motor"])):
        digest = hashlib.sha256((ROOT / path).read_bytes()).hexdigest()
        assert f"<dt>{file}</dt>\n<dd>{path}, sha256 {digest}</dd>" in page, (file, digest)
    for estimate in result["estimates"]:
        assert f"<td>{estimate['name']}</td>" in page and (not estimate["excited"] or f">{estimate['value']:.5g}<" in page), estimate
    assert f"<td class=\"n\">{result['causes'][0]['probability']:.3g}</td>" in page if result["causes"] else True
    for row in re.findall(r'^CAUSE\(\w+, "(\w+)"', (ROOT / "sim_host/data/causes.def").read_text(), re.MULTILINE):
        assert f"<dt>{row}</dt>" in page, f"{row} is not in the glossary"


def keys_of(value):
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return set(value if isinstance(value, dict) else ()).union(*map(keys_of, inner))


def check_reference(result):
    """The page has every key of the JSON, every cause and every option."""
    page = (ROOT / "docs/diagnosis_reference.md").read_text()
    code = "\n".join(re.findall(r"```json.*?```|`[^`\n]+`", page, re.DOTALL))
    helped = subprocess.run([PROGRAM, "diagnose", "--help"], capture_output=True, check=True, text=True).stdout
    options = set(re.findall(r"--[a-z-]+", helped)) - {"--help"}
    causes = set(re.findall(r'^CAUSE\(\w+, "(\w+)"', (ROOT / "sim_host/data/causes.def").read_text(), re.MULTILINE))
    assert len(options) >= 7 and len(causes) >= 24, (options, causes)
    missing = {name for name in options | causes | keys_of(result) if not re.search(rf"(?<![\w-]){name}(?![\w-])", code)}
    assert not missing, f"docs/diagnosis_reference.md does not have {sorted(missing)}"


def check_plant(result):
    plant = result["plant"]
    if not result["causes"]:
        assert plant["simulated"] is False
        return
    assert plant["simulated"], plant
    assert set(plant["causes"]) == {c["id"] for c in result["causes"]}, plant
    assert 0.85 < plant["beyond_noise_plant_over_machine"] < 1.15, plant
    for run in plant["runs"]:
        assert abs(run["nominal_on_plant"] - run["nominal_on_machine"]) < 0.15 * run["nominal_on_machine"] + 0.1, run


def check_fixed_date(folder):
    """The page is the same for the same input but for the date, which SOURCE_DATE_EPOCH sets; and text of the user's stays text."""
    evil = "<img src=x onerror=alert(1)>'\"&.csv"
    shutil.copy(ROOT / "data/recordings/clean.csv.gz", folder / evil)
    motor = (ROOT / "data/recordings/clean.toml").read_text()
    (folder / "motor.toml").write_text(re.sub(r'^name = .*', "name = '</script><script>alert(2)</script>'", motor, flags=re.MULTILINE))
    pages = []
    for n in range(2):
        time.sleep(1.1 * n)
        command = [PROGRAM, "diagnose", evil, "--motor", "motor.toml", "-o", "out"]
        done = subprocess.run(command, cwd=folder, env={**os.environ, "SOURCE_DATE_EPOCH": "86400"}, capture_output=True, check=False)
        assert done.returncode == 0, done.stderr
        pages.append((folder / "out/report.html").read_text())
    assert pages[0] == pages[1], "two runs give two pages"
    assert "<dd>1970-01-02 00:00:00 UTC</dd>" in pages[0]
    assert "<img" not in pages[0] and "<script>alert" not in pages[0]
    assert pages[0].count("&lt;img src=x onerror=alert(1)&gt;") >= 3 and "&lt;/script&gt;" in pages[0]


def check(name, folder):
    recording = pathlib.Path("data", "recordings", f"{name}.csv.gz")
    motor = pathlib.Path("data", "recordings", f"{name}.toml")
    diagnose(recording, motor, "-o", folder)
    result = json.loads((folder / "diagnosis.json").read_text())
    firmware, error = result["firmware"], result["error"]
    # IQ24 has no noise of its own to speak of; its predictor's formula and its plain law of dead time cost a little.
    assert firmware["gain"] > 0.9 * error["gain"], (firmware, error)
    assert firmware["extended"] < 1.1 * error["extended"] + 0.01, (firmware, error)
    check_reference(result)
    check_plant(result)
    check_header(folder, result)
    check_page(folder, result)
    again = json.loads(diagnose(recording, folder / "motor_extended.toml", "--json", "-"))
    assert again["verdict"] == "clean" and not again["causes"], again
    assert abs(again["error"]["nominal"] - error["extended"]) < 0.05 * error["extended"], (again["error"], error)
    print(f"{name}: {result['verdict']}, gain {error['gain']:.2f}, in firmware code {firmware['gain']:.2f}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        check_fixed_date(pathlib.Path(folder))
    for name in NAMES:
        with tempfile.TemporaryDirectory() as folder:
            check(name, pathlib.Path(folder))


if __name__ == "__main__":
    main()
