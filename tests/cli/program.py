"""What the tests of the command line share: the binary, a folder of good input files, and the commands that read them."""

import pathlib
import struct
import subprocess
import sys
import zlib

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

MAP = "[columns]\n" + "".join(f'{name} = "{name}"\n' for name in (
    "run", "t_s", "i_a_A", "i_b_A", "i_c_A", "theta_e_rad", "omega_e_rad_s", "u_a_V", "u_b_V", "u_c_V"))

# One small call of every command in a folder of write_small_inputs; what it writes is below out.
MOTOR_FILE = ["--motor", "motor.toml"]
SMALL = {
    "reproduce": ["reproduce", "--paper", "2016", "-o", "out", "--json", "out/x.json"],
    "simulate": ["simulate", *MOTOR_FILE, "--scenario", "scenario.toml", "-o", "out/rec.csv"],
    "export-fmu": ["export-fmu", *MOTOR_FILE, "--scenario", "scenario.toml", "-o", "out/drive.fmu"],
    "record": ["record", "--port", "line.uart", "-o", "out/rec.csv"],
    "sweep": ["sweep", *MOTOR_FILE, "--rpm", "1000", "-o", "out", "--json", "out/x.json"],
    "loops": ["loops", *MOTOR_FILE, "--extended", "motor.toml", "--json", "out/x.json"],
    "import": ["import", "recording.csv", "--map", "map.toml", "-o", "out/rec.csv"],
    "diagnose": ["diagnose", "recording.csv", *MOTOR_FILE, "-o", "out", "--json", "out/x.json"],
    "plan": ["plan", *MOTOR_FILE, "--seconds", "1.6", "-o", "out/plan.toml", "--firmware", "out/plan.h", "--json", "out/x.json"],
    "tune": ["tune", *MOTOR_FILE, "--drives", "1", "-o", "out", "--json", "out/x.json"],
    "observe": ["observe", "recording.csv", *MOTOR_FILE, "-o", "out", "--json", "out/x.json"],
    "motor": ["motor", "--pole-pairs", "3", "--resistance", "1", "--inductance", "0.01", "--flux", "0.1", "--current", "6", "--u-dc", "500",
              "--f-pwm", "4000", "-o", "out/m.toml"],
    "info": ["info", "recording.csv", *MOTOR_FILE],
    "plot": ["plot", "recording.csv", *MOTOR_FILE, "-o", "out/page.html"],
    "patterns": ["patterns", *MOTOR_FILE, "--pulses", "3", "-o", "out", "--json", "out/x.json"],
    "watch": ["watch", *MOTOR_FILE, "--change", "magnet", "-o", "out"],
    "golden": ["golden"],
    "version": ["version"],
    "help": ["help", "diagnose"],
}


def run(arguments, folder, stdin=None):
    """Runs the program in a folder; a call that hangs is a failure of the test."""
    return subprocess.run([str(PROGRAM), *map(str, arguments)], cwd=folder, input=stdin, capture_output=True,
                          timeout=1200, check=False)


def recorder_line():
    """What the firmware's recorder sends (docs/recorder-format.md): a header, rows, an end."""
    def frame(kind, sequence, *words):
        octets = struct.pack(f"<{1 + len(words)}I", 1 | kind << 8 | sequence << 16, *words)
        octets += struct.pack("<I", zlib.crc32(octets))
        return b"\xc0" + octets.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc") + b"\xc0"

    columns = (4, 5, 6, 7, 11, 12)
    channels = [word for column in columns for word in (column, 1 << 30, 54)]
    stream = frame(1, 0, 7, 1759218604, 43, 1, len(columns), *channels)
    for cycle in range(300):
        stream += frame(2, 1 + cycle, 7, 0, 1, cycle, *(cycle * (k + 1) for k in range(len(columns))))
    return stream + frame(3, 301, 7, 0, 300)


def commands_there():
    """The commands that this build has, from its own overview."""
    lines = run(["--help"], ROOT).stdout.decode().splitlines()
    return [line.split()[0] for line in lines if line.startswith("  ")]


def write_files(folder, changed=None):
    """The good files, and in place of some of them others (bytes or text); None: the file is missing."""
    for name, content in {**FILES, **(changed or {})}.items():
        if content is not None:
            (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def write_small_inputs(folder):
    """What the calls of SMALL read, and their folder out."""
    write_files(folder)
    made = run(["simulate", *MOTOR_FILE, "--scenario", "scenario.toml", "-o", "recording.csv"], folder)
    assert made.returncode == 0, made.stderr
    (folder / "map.toml").write_text(MAP)
    (folder / "line.uart").write_bytes(recorder_line())
    (folder / "out").mkdir()
