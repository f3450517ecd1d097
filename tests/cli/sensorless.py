"""
The drive on the observed angle, in closed loop, next to the same drive on the measured one. sensorless.py IQFOC [--table]

The machine of the 2019 paper at 8000 rpm, EMF 0.45 of the link; the carrier's frequency is the one that the ratio asks for. 12 bit, noise
of 0.5 % of the rated current, dead time of 0.5 % of a period that the motor file knows, with the ripple 0.1 U T/L as its knee. --table
prints what docs/sensorless.md shows.
"""
import csv
import json
import math
import pathlib
import sys
import tempfile

import program

F_ELECTRICAL_HZ = 400.0
RATED_A = 10.5 * math.sqrt(2.0)
RATIOS = (3.5, 5, 6, 8, 10, 12.5, 20, 50)
LOADS = (0.0, 0.5, 1.0)

MOTOR = """name = "2019"
[motor]
pole_pairs = 3
R_ohm = 0.75
L_d_H = 0.0052
L_q_H = 0.0052
psi_f_Wb = 0.134
I_rated_A_rms = 10.5
n_max_rpm = 8000
[inverter]
f_pwm_Hz = {f_pwm}
u_dc_V = 750
[extension.dead_time]
v_dead_V = 3.75
i_knee_A = {knee}
"""
SCENARIO = """name = "sensorless"
[control]
feedback = "quasi_discrete_mean"
angle = "{angle}"
[sensors]
current_bits = 12
current_full_scale_A = 30
current_noise_A = {noise}
[log]
duties = true
[[run]]
cycles = {cycles}
speed_rpm = 8000
i_q_A = {{ at_s = [0, {step}], steps = [{low}, {high}] }}
"""
CYCLES, STEP = 1500, 1000

failures = []


def check(good, what):
    if "--table" not in sys.argv[2:]:
        print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def simulated(folder, sffr, angle, low, high):
    """The recording's file: `low` of the rated current, and `high` from cycle STEP on."""
    f_pwm = F_ELECTRICAL_HZ * sffr
    (folder / "m.toml").write_text(MOTOR.format(f_pwm=f_pwm, knee=0.1 * 750.0 / (0.0052 * f_pwm)))
    (folder / "s.toml").write_text(SCENARIO.format(angle=angle, noise=0.005 * RATED_A, cycles=CYCLES, step=STEP / f_pwm, low=low * RATED_A,
                                                   high=high * RATED_A))
    file = f"{angle}.csv"
    done = program.run(["simulate", "--motor", "m.toml", "--scenario", "s.toml", "--effect", f"dead_time:t_dead={0.005 / f_pwm}", "-o", file],
                       folder)
    assert done.returncode == 0, done.stderr
    check(b"ANGLE_LOST" not in done.stderr, f"SFFR {sffr}, {angle}: the lock is kept")
    return file


def replayed(folder, file):
    done = program.run(["observe", file, "--motor", "m.toml", "--json", "-"], folder)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def currents(path):
    """i_d + j i_q of each row over the rated current."""
    with path.open(newline="") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            a, b, c = (float(row[f"i_{x}_A"]) for x in "abc")
            angle = -float(row["theta_e_rad"])
            yield complex((2 * a - b - c) / 3, (b - c) / math.sqrt(3)) * complex(math.cos(angle), math.sin(angle)) / RATED_A


def measured(folder, sffr):
    """Worst of the loads: bias and rms of the angle in degrees, rms of the speed in %; the step's distance from the same with an encoder."""
    worst = {"bias": 0.0, "rms": 0.0, "speed": 0.0}
    for load in LOADS:
        got = replayed(folder, simulated(folder, sffr, "observed", load, load))
        check(got["locked"] >= got["rows"] - got["pull_in_rows"], f"SFFR {sffr}, load {load}: locked in {got['locked']} rows")
        worst["bias"] = max(worst["bias"], abs(got["error"]["bias_deg"]))
        worst["rms"] = max(worst["rms"], got["error"]["rms_deg"])
        worst["speed"] = max(worst["speed"], got["speed_rms_rpm"] / 80.0)
    traces = [list(currents(folder / simulated(folder, sffr, angle, 0.0, 1.0))) for angle in ("measured", "observed")]
    after = range(STEP - 10, STEP + 200)
    return worst | {"step": max(abs(traces[0][k] - traces[1][k]) for k in after)}


def main():
    with tempfile.TemporaryDirectory() as name:
        results = {sffr: measured(pathlib.Path(name), sffr) for sffr in RATIOS}
    if "--table" in sys.argv[2:]:
        lines = ["| SFFR | angle: bias, degrees | angle: rms | speed: rms, % | step, % |",
                 "| ---: | ---: | ---: | ---: | ---: |"]
        lines += [f"| {sffr:g} | {r['bias']:.2f} | {r['rms']:.2f} | {r['speed']:.3f} | {100 * r['step']:.1f} |" for sffr, r in results.items()]
        print("\n".join(lines))
        return 1 if failures else 0
    for sffr, r in results.items():
        check(r["bias"] <= 0.45 and 0.02 <= r["rms"] <= 0.2 and r["speed"] <= 0.0205 and r["step"] <= 0.1, f"SFFR {sffr}: {r}")
    print("all good" if not failures else f"{len(failures)} FAILED: " + "; ".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
