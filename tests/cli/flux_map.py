#!/usr/bin/env python3
"""Machines that lose much inductance: their flux maps in firmware header, report and fixed-point error. A map of parts that saturate; one
whose inductances at no current are beyond the library's range; and one of terms, which the header has as parts.

    tests/cli/flux_map.py PROGRAM
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
WARNINGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
MOTOR = """name = "PM reluctance machine, invented"
[motor]
pole_pairs = 2
R_ohm = 0.7
L_d_H = 0.018
L_q_H = 0.035
psi_f_Wb = 0.3
I_rated_A_rms = 8.8
n_max_rpm = 3000
[inverter]
f_pwm_Hz = 8000
u_dc_V = 540
"""
SCENARIO = """name = "up to twice the rated current"
[sensors]
current_bits = 12
current_full_scale_A = 40
current_noise_A = 0.03
u_dc_noise_V = 0.2
[log]
duties = true
"""
RUN = """[[run]]
duration_s = 0.2
speed_rpm = {}
i_d_A = {{ value = {}, square = {{ amplitude = 2.0, period_s = 0.023 }} }}
i_q_A = {{ value = {}, square = {{ amplitude = 2.5, period_s = 0.037 }} }}
"""
POINTS = [(300, -1, 4), (900, -6, 12), (-900, -8, -16), (1200, -12, 10), (600, 0, -20), (-600, -3, 7)]
MAP = "saturation_dq:E_1=0.72,I_d1=14,I_q1=6,I_c1=-4"
STEEP = ("L_q_H = 0.035", "L_q_H = 0.055")
STEEP_MAP = "saturation_dq:E_1=1.44,I_d1=14,I_q1=6,I_c1=-4"
TERMS = {"I_sat_A": 35.0, "w_ddd_Wb_A2": 6e-5, "w_dqq_Wb_A2": -2e-5, "w_qqqq_Wb_A3": 1e-6}
# The constants as the compiler folded them.
FIRMWARE = """
#include "iqfoc_extension.h"
#include <stdio.h>
static const iqfoc_flux_map_t map = IQFOC_DIAGNOSED_FLUX_MAP;
int main(void)
{
    if (iqfoc_flux_map_check(&map) != IQFOC_OK) {
        return 1;
    }
    printf("[%ld, %ld, %ld, %ld, %ld, %ld, %ld]\\n", (long)map.l_d, (long)map.l_q, (long)map.part[0].e, (long)map.part[0].k_d,
           (long)map.part[0].k_q, (long)map.part[0].x_0, (long)map.part[1].e);
    return 0;
}
"""


def diagnosis(program, folder, motor, effect, known=""):
    """Of a drive with this effect, by a motor file that knows `known` of it."""
    (folder / "motor.toml").write_text(motor)
    (folder / "scenario.toml").write_text(SCENARIO + "".join(RUN.format(*point) for point in POINTS))
    for name, command in (("motor.toml", ["simulate", "--scenario", "scenario.toml", "-o", "run.csv", "--seed", "1", "--effect", effect]),
                          ("known.toml", ["diagnose", "run.csv", "-o", "."])):
        (folder / "known.toml").write_text(motor + known)
        done = subprocess.run([program, *command, "--motor", name], cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    return json.loads((folder / "diagnosis.json").read_text())


def compiled(folder):
    """The constants of the header, as a compiler without warnings has them."""
    (folder / "firmware.c").write_text(FIRMWARE)
    compiler = next(c for c in ("gcc", "clang", "cc") if shutil.which(c))
    sources = [ROOT / "src" / f"{x}.c" for x in ("extension", "flux_map", "iq24_math", "iq24_trig")]
    made = subprocess.run([compiler, *WARNINGS, "-I", ROOT / "include", "-I", folder, folder / "firmware.c", *sources, "-o", folder / "firmware"],
                          capture_output=True, text=True, check=False)
    assert made.returncode == 0 and not made.stderr, made.stderr
    return [x / 2**24 for x in json.loads(subprocess.run([folder / "firmware"], capture_output=True, check=True).stdout)]


def steep(program, folder):
    """The firmware holds the extended machine alone."""
    result = diagnosis(program, folder, MOTOR.replace(*STEEP), STEEP_MAP)
    assert [c["id"] for c in result["causes"]] == ["saturation_dq"], result["causes"]
    firmware = result["firmware"]
    assert firmware["nominal"] is None and firmware["gain"] is None, firmware
    assert firmware["extended"] < 1.05 * result["error"]["extended"] < 0.2 * result["error"]["nominal"], result
    assert "error reduction is not known" in (folder / "report.html").read_text()


def terms(program, folder):
    """Fitted parts take the place of the terms."""
    effect = "saturation_dq:" + ",".join(f"{key.rsplit('_Wb')[0].removesuffix('_A')}={value}" for key, value in TERMS.items())
    known = "[extension.saturation_dq]\nL_d0_H = 0.018\nL_q0_H = 0.035\n" + "".join(f"{key} = {value}\n" for key, value in TERMS.items())
    result = diagnosis(program, folder, MOTOR, effect, known)
    assert result["verdict"] == "clean", result["verdict"]
    assert result["firmware"]["extended"] < 1.2 * result["error"]["extended"], (result["firmware"], result["error"])
    header = (folder / "iqfoc_extension.h").read_text()
    assert "IQFOC_DIAGNOSED_FLUX_MAP" in header and "Fitted to the map" in header and "no correction" not in header
    assert "holds the flux map as parts" in (folder / "report.html").read_text()
    assert compiled(folder)[2] > 0.0


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    for part in (steep, terms):
        with tempfile.TemporaryDirectory() as name:
            part(program, pathlib.Path(name))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        result = diagnosis(program, folder, MOTOR, MAP)
        found = {p["name"]: p["value"] for c in result["causes"] for p in c["parameters"]}
        assert [c["id"] for c in result["causes"]] == ["saturation_dq"] and found["E_1"] > 0.0, result["causes"]
        # The firmware's error is that of double precision.
        assert result["firmware"]["extended"] < 1.02 * result["error"]["extended"], result
        assert result["firmware"]["gain"] > 2.0, result["firmware"]
        page = (folder / "report.html").read_text()
        assert '<figure id="flux-d"' in page and '<figure id="flux-q"' in page and "no correction for saturation_dq" not in page
        assert "no correction" not in (folder / "iqfoc_extension.h").read_text()
        held = compiled(folder)
    base_A, base_Wb = 8.8 * 2**0.5, 540.0 / 8000.0
    x_0 = found["I_c1"] / found["I_d1"]
    root = (1.0 + x_0 * x_0) ** 0.5
    assert "E_2" not in found or found["E_2"] == 0.0, found
    want = [(found["L_d0"] - found["E_1"] / found["I_d1"] ** 2 / root**3) * base_A / base_Wb,
            (found["L_q0"] - found["E_1"] / found["I_q1"] ** 2 / root) * base_A / base_Wb, found["E_1"] / base_A / base_Wb,
            base_A / found["I_d1"], base_A / found["I_q1"], x_0, 0.0]
    assert all(abs(a - b) < 1e-5 for a, b in zip(held, want, strict=True)), (held, want)


if __name__ == "__main__":
    main()
