"""What the tests of the command line share: the binary, a folder of good input files, and the commands that read them."""

import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT / "build/host/iqfoc"

MOTOR = """name = "Compressor 2.2 kW"
[motor]
pole_pairs = 3
R_ohm = 0.9
L_d_H = 0.008
L_q_H = 0.011
psi_f_Wb = 0.2
I_rated_A_rms = 6
n_max_rpm = 6000
[inverter]
f_pwm_Hz = 4000
u_dc_V = 565
"""

SCENARIO = """name = "short"
[control]
feedback = "midpoint"
[sensors]
current_noise_A = 0.01
[[run]]
cycles = 400
speed_rpm = 1000
i_q_A = { value = 3, square = { amplitude = 1, period_s = 0.02 } }
"""

# Two rows are a recording; whether they suffice for a diagnosis is another matter.
RECORDING = """# a comment
t_s,i_a_A,i_b_A,i_c_A,theta_e_rad,omega_e_rad_s,u_a_V,u_b_V,u_c_V
0.00000,1.0,-0.5,-0.5,0.10,100,10.0,-5.0,-5.0
0.00025,1.1,-0.5,-0.6,0.125,100,10.5,-5.0,-5.5
"""

FILES = {"motor.toml": MOTOR, "scenario.toml": SCENARIO, "recording.csv": RECORDING}

# A complete call of each command that reads files, and the files it reads and writes.
CALLS = {
    "simulate": {
        "arguments": ["--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "out.csv"],
        "reads": ["motor.toml", "scenario.toml"],
        "writes": ["out.csv"],
    },
    "export-fmu": {
        "arguments": ["--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "out.fmu"],
        "reads": ["motor.toml", "scenario.toml"],
        "writes": ["out.fmu"],
    },
    "diagnose": {
        "arguments": ["recording.csv", "--motor", "motor.toml", "--json", "out.json"],
        "reads": ["motor.toml", "recording.csv"],
        "writes": ["out.json"],
    },
    "sweep": {
        "arguments": ["--motor", "motor.toml", "--rpm", "1000", "--json", "out.json"],
        "reads": ["motor.toml"],
        "writes": ["out.json"],
    },
    "tune": {
        "arguments": ["--motor", "motor.toml", "--drives", "1", "--json", "out.json"],
        "reads": ["motor.toml"],
        "writes": ["out.json"],
    },
}


def run(arguments, folder, stdin=None):
    """Runs the program in a folder; a call that hangs is a failure of the test."""
    return subprocess.run([str(PROGRAM), *map(str, arguments)], cwd=folder, input=stdin, capture_output=True,
                          timeout=120, check=False)


def commands_there():
    """The commands that this build has, from its own overview."""
    lines = run(["--help"], ROOT).stdout.decode().splitlines()
    return [line.split()[0] for line in lines if line.startswith("  ")]


def write_files(folder, changed=None):
    """The good files, and in place of some of them others (bytes or text); None: the file is missing."""
    for name, content in {**FILES, **(changed or {})}.items():
        if content is not None:
            (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
