"""iqfoc observe: the observer over recordings of the simulated drive, its errors, and what it refuses. observe.py IQFOC"""
import json
import math
import pathlib
import sys
import tempfile

import program

SCENARIO = """name = "observed"
[control]
feedback = "midpoint"
[sensors]
current_noise_A = 0.03
[[run]]
cycles = 3000
speed_rpm = {speed}
i_q_A = {{ value = 6, square = {{ amplitude = 5, period_s = 0.05 }} }}
"""
MOTORS = {name: program.ROOT / f"data/motors/{name}.toml" for name in ("jarzebowicz2019", "compressor_salient")}

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def refuses(arguments, words, folder, what):
    done = program.run(arguments, folder)
    lines = done.stderr.decode().strip().split("\n")
    check(done.returncode == 2 and len(lines) == 1 and words in lines[0] and done.stdout == b"", f"{what}: {lines}")


def simulated(motor, speed, folder, *more):
    (folder / "s.toml").write_text(SCENARIO.format(speed=speed))
    done = program.run(["simulate", "--motor", motor, "--scenario", "s.toml", *more, "-o", "r.csv"], folder)
    assert done.returncode == 0, done.stderr


def observed(motor, folder):
    done = program.run(["observe", "r.csv", "--motor", motor, "--json", "-"], folder)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def measure(folder):
    """The plant switches every edge, and has no line in common with the observer."""
    for name, motor in MOTORS.items():
        for speed in (-5000, 2000, 5000):
            simulated(motor, speed, folder)
            got = observed(motor, folder)
            error = got["error"]
            check(got["rows"] == 2999 and got["pull_in_rows"] <= 120 and got["locked"] >= got["rows"] - got["pull_in_rows"],
                  f"{name} at {speed} rpm: locked in {got['locked']} rows, after {got['pull_in_rows']}")
            check(abs(error["bias_deg"]) <= 0.05 and error["rms_deg"] <= 0.15 and error["most_deg"] <= 2,
                  f"{name} at {speed} rpm: {error}")
            check(sum(part["error"]["rows"] for part in got["by_speed"]) == error["rows"]
                  == sum(part["error"]["rows"] for part in got["by_current"]), "the parts are the whole")
            full = [part for part in got["by_speed"] if part["error"]["rows"] > 0]
            check(len(full) == 1 and full[0]["low_rpm"] <= abs(speed) and (full[0]["high_rpm"] or 1e9) >= abs(speed),
                  f"{name} at {speed} rpm: in its part")


def measure_wrong(folder):
    """A dead time that the motor file does not contain turns the angle; with its table in the file it does not."""
    motor = MOTORS["compressor_salient"]
    simulated(motor, 1500, folder, "--effect", "dead_time:t_dead=1.5e-6")
    plain = observed(motor, folder)["error"]
    (folder / "known.toml").write_text(motor.read_text() + "\n[extension.dead_time]\nv_dead_V = 3.39\ni_knee_A = 0.5\n")
    known = observed("known.toml", folder)["error"]
    check(abs(plain["bias_deg"]) + plain["rms_deg"] > 3 * (abs(known["bias_deg"]) + known["rms_deg"]),
          f"a dead time: {plain} without, {known} with its table")


def measure_slow(folder):
    simulated(MOTORS["compressor_salient"], 100, folder)
    got = observed(MOTORS["compressor_salient"], folder)
    check(got["locked"] == 0 and got["pull_in_rows"] == -1 and got["error"] == {"rows": 0, "bias_deg": None, "rms_deg": None, "most_deg": None},
          f"below the least speed it does not lock: {got['error']}")
    done = program.run(["observe", "r.csv", "--motor", MOTORS["compressor_salient"]], folder)
    check(done.returncode == 0 and b"no settled row above 300 rpm" in done.stdout, done.stdout.decode())


OUTRUNNER = """name = "outrunner"
[motor]
pole_pairs = 7
R_ohm = 0.05
L_d_H = 40e-6
L_q_H = 40e-6
psi_f_Wb = 0.003
I_rated_A_rms = 20
n_max_rpm = 6000
[inverter]
f_pwm_Hz = 5000
u_dc_V = 24
"""
HARMONICS = """[extension.angle_offset]
theta_0_rad = -0.2
[[extension.angle_harmonic]]
order = 1
amplitude_rad = 0.05
phase_rad = 1.0
[[extension.angle_harmonic]]
order = 2
amplitude_rad = 0.06
phase_rad = 0.5
"""
OUTRUNNER_SCENARIO = """name = "outrunner"
[control]
feedback = "midpoint"
bandwidth_Hz = 150
[pwm]
periods_per_cycle = 8
held = "{held}"
[sensors]
current_noise_A = 0.08
[log]
mechanical_angle = {mechanical}
mid_currents = false
""" + "".join(f"""[[run]]
cycles = 1500
speed_rpm = {{{{ at_s = [0, 0.3], ramp = [{first}, {last}] }}}}
i_q_A = {{{{ value = 6, square = {{{{ amplitude = 3, period_s = 0.06 }}}} }}}}
""" for first, last in ((1500, 3000), (3000, 2000), (-2500, -2500)))


def measure_outrunner(folder):
    """Eight PWM periods a cycle that turn the command on or hold it, and an eccentric angle sensor: the motor file contains all of it."""
    (folder / "o.toml").write_text(OUTRUNNER)
    (folder / "known.toml").write_text(OUTRUNNER + HARMONICS)
    effects = ["--effect", "angle_offset:theta_0=-0.2", "--effect", "angle_harmonic:order=1,amplitude=0.05,phase=1.0",
               "--effect", "angle_harmonic:order=2,amplitude=0.06,phase=0.5"]
    for held, mechanical in (("rotor", "true"), ("rotor", "false"), ("stator", "true")):
        (folder / "s.toml").write_text(OUTRUNNER_SCENARIO.format(held=held, mechanical=mechanical))
        done = program.run(["simulate", "--motor", "o.toml", "--scenario", "s.toml", *effects, "-o", "r.csv"], folder)
        assert done.returncode == 0, done.stderr
        plain, known = observed("o.toml", folder)["error"], observed("known.toml", folder)["error"]
        what = f"command held by the {held}, mechanical angle {mechanical}"
        check(abs(plain["bias_deg"] - math.degrees(0.2)) < 0.5 and plain["rms_deg"] > 2.9, f"{what}: the sensor's error: {plain}")
        check(abs(known["bias_deg"]) < 0.2 and known["rms_deg"] < 0.6, f"{what}: removed by its tables: {known}")
    text = (folder / "r.csv").read_text()
    (folder / "r.csv").write_text(text.replace('held = "stator"', 'held = "rotor"'))
    wrong = observed("known.toml", folder)["error"]
    check(abs(wrong["bias_deg"]) > 1, f"a command that does not turn, taken as one that does: {wrong}")


def choose_bandwidth(folder):
    """On a ramp the error before a step is the acceleration over k2 = (1 - p)^2; the step leaves 1 - k1 = p^2 of it."""
    motor = MOTORS["jarzebowicz2019"]
    (folder / "s.toml").write_text(SCENARIO.format(speed="{ at_s = [0, 0.6], ramp = [2000, 6000] }"))
    done = program.run(["simulate", "--motor", motor, "--scenario", "s.toml", "-o", "r.csv"], folder)
    assert done.returncode == 0, done.stderr
    accelerated = 4000 / 60 * 3 / 0.6 / 5000**2  # turns per cycle^2
    for bandwidth in (None, 1500.0):
        options = [] if bandwidth is None else ["--bandwidth", str(bandwidth)]
        done = program.run(["observe", "r.csv", "--motor", motor, *options, "--json", "-"], folder)
        got = json.loads(done.stdout)
        w_T = 0.65 * (400 / 5000) ** (2 / 3) if bandwidth is None else bandwidth / 5000  # 8000 rpm are 400 Hz
        lag = 360 * accelerated / w_T**2  # p^2/(1 - p)^2 with p = 1/(1 + w T)
        check(abs(got["bandwidth_rad_s"] - 5000 * w_T) < 1e-6 and abs(-got["error"]["bias_deg"] - lag) < 0.02,
              f"bandwidth {got['bandwidth_rad_s']:g} rad/s lags {-got['error']['bias_deg']:.3f} degrees, by the formula {lag:.3f}")
        check(got["fast_rpm"] == 800 and got["fast"] == got["error"], f"all rows are above a tenth of the top speed: {got['fast']}")
    refuses(["observe", "r.csv", "--motor", motor, "--bandwidth", "6000"], "--bandwidth 6000 is above 1/T", folder, "too high a bandwidth")


def show(folder):
    simulated(MOTORS["jarzebowicz2019"], 5000, folder)
    done = program.run(["observe", "r.csv", "--motor", MOTORS["jarzebowicz2019"]], folder)
    for words in ("locked in", "longest pull-in", "angle, observed minus recorded", "speed, rpm", "current, A"):
        check(done.returncode == 0 and words.encode() in done.stdout, f"the text has: {words}")
    done = program.run(["observe", "r.csv", "--motor", MOTORS["jarzebowicz2019"], "-o", "out", "--json", "out/x.json"], folder)
    page = (folder / "out/index.html").read_text()
    check(done.returncode == 0 and b"page: out/index.html" in done.stdout, "with a folder it says where the page is")
    check("observed minus recorded" in page and page.rstrip().endswith("</html>"), "the page is whole")
    check(json.loads((folder / "out/x.json").read_text())["locked"] > 2900, "the JSON is in the folder")
    simulated(MOTORS["compressor_salient"], 100, folder)
    done = program.run(["observe", "r.csv", "--motor", MOTORS["compressor_salient"], "-o", "out"], folder)
    check(done.returncode == 0 and "No settled row" in (folder / "out/index.html").read_text(), "a page without an error to show")


def refuse(folder):
    program.write_files(folder)
    motor = ["--motor", "motor.toml"]
    refuses(["observe", "r.csv"], "--motor M.toml is missing", folder, "no motor")
    refuses(["observe", *motor], "no recording is given", folder, "no recording")
    refuses(["observe", "r.csv", "r.csv", *motor], "r.csv", folder, "two recordings")
    refuses(["observe", "none.csv", *motor], "none.csv", folder, "a recording that is not there")
    (folder / "magnetless.toml").write_text(program.MOTOR.replace("psi_f_Wb = 0.2", "psi_f_Wb = 0"))
    simulated("motor.toml", 1000, folder)
    refuses(["observe", "r.csv", "--motor", "magnetless.toml"], "the observer needs a magnet", folder, "no magnet")
    rows = [line for line in (folder / "r.csv").read_text().split("\n") if not line.startswith("#")]
    (folder / "one.csv").write_text("\n".join(rows[:2]) + "\n")
    refuses(["observe", "one.csv", *motor], "no two rows are consecutive", folder, "a single row")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for part in (measure, measure_wrong, measure_slow, measure_outrunner, choose_bandwidth, show, refuse):
            part(folder)
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
