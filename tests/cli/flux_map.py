#!/usr/bin/env python3
"""A machine that loses much inductance: its flux map in firmware header, report and fixed-point error.

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


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "motor.toml").write_text(MOTOR)
        (folder / "scenario.toml").write_text(SCENARIO + "".join(RUN.format(*point) for point in POINTS))
        for command in (["simulate", "--scenario", "scenario.toml", "-o", "run.csv", "--seed", "1", "--effect", MAP], ["diagnose", "run.csv", "-o", "."]):
            done = subprocess.run([program, *command, "--motor", "motor.toml"], cwd=folder, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
        result = json.loads((folder / "diagnosis.json").read_text())
        found = {p["name"]: p["value"] for c in result["causes"] for p in c["parameters"]}
        assert [c["id"] for c in result["causes"]] == ["saturation_dq"] and found["E_1"] > 0.0, result["causes"]
        # The firmware's error is that of double precision.
        assert result["firmware"]["extended"] < 1.02 * result["error"]["extended"], result
        assert result["firmware"]["gain"] > 2.0, result["firmware"]
        page = (folder / "report.html").read_text()
        assert '<figure id="flux-d"' in page and '<figure id="flux-q"' in page and "no correction for saturation_dq" not in page
        assert "no correction" not in (folder / "iqfoc_extension.h").read_text()
        (folder / "firmware.c").write_text(FIRMWARE)
        compiler = next(c for c in ("gcc", "clang", "cc") if shutil.which(c))
        sources = [ROOT / "src" / f"{x}.c" for x in ("extension", "flux_map", "iq24_math", "iq24_trig")]
        made = subprocess.run([compiler, *WARNINGS, "-I", ROOT / "include", "-I", folder, folder / "firmware.c", *sources, "-o", folder / "firmware"],
                              capture_output=True, text=True, check=False)
        assert made.returncode == 0 and not made.stderr, made.stderr
        held = [x / 2**24 for x in json.loads(subprocess.run([folder / "firmware"], capture_output=True, check=True).stdout)]
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
