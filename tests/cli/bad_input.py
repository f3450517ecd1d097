"""Bad input gives one clear line, exit status 2, and leaves no file behind: interfaces.md, "The command line".

A row of MOTOR_ROWS, SCENARIO_ROWS or RECORDING_ROWS spoils one good file and is tried with every command that reads it; a row of
USAGE_ROWS is a whole call. Add rows here when a command learns to refuse something else.
"""

import gzip
import os
import pathlib
import subprocess
import tempfile
import unittest

import program


def replaced(text, old, new):
    assert text.count(old) == 1, f"{old!r} occurs {text.count(old)} times"
    return text.replace(old, new)


def position(text, fragment):
    """line:column of a fragment that occurs once in a text."""
    assert text.count(fragment) == 1, f"{fragment!r} occurs {text.count(fragment)} times"
    at = text.index(fragment)
    return f"{text.count(chr(10), 0, at) + 1}:{at - (text.rfind(chr(10), 0, at) + 1) + 1}"


# (old text, new text, where the complaint points, words of the complaint). Where: a fragment that occurs once in the
# new file, or (line, column).
MOTOR_ROWS = [
    ("L_d_H = 0.008", "L_d_H = -0.008", "-0.008", "L_d_H must be a number > 0, not -0.008"),
    ("L_q_H = 0.011", "L_q_H = 0", "0\npsi", "L_q_H must be a number > 0"),
    ("R_ohm = 0.9", "R_ohm = -1", "-1", "R_ohm must be a number >= 0"),
    ("psi_f_Wb = 0.2", "psi_f_Wb = \"0.2 Wb\"", "\"0.2 Wb\"", "psi_f_Wb must be a number"),
    ("R_ohm = 0.9", "R_ohm = nan", "nan", "R_ohm must be a number"),
    ("u_dc_V = 565", "u_dc_V = inf", "inf", "u_dc_V must be a number"),
    ("pole_pairs = 3", "pole_pairs = 2.5", "2.5", "pole_pairs must be a whole number"),
    ("I_rated_A_rms = 6\n", "", "[motor]", "I_rated_A_rms is missing in [motor]"),
    ("psi_f_Wb = 0.2", "psi_f_wb = 0.2", "[motor]", "psi_f_Wb is missing"),
    ("R_ohm = 0.9", "R_ohm = 0.9\nR_omh = 0.9", "R_omh", "did you mean R_ohm?"),
    ("R_ohm = 0.9", "R_ohm = 0,9", ",9", "not TOML"),
    ("R_ohm = 0.9", "R_ohm = 0.9\nR_ohm = 0.9", (5, 9), "not TOML"),
    ("[inverter]", "[inverter", (10, 10), "not TOML"),
    # Deeper than the parser's stack: a value's key, a table's, one within an inline table.
    ("R_ohm = 0.9", ".".join(["a"] * 50000) + " = 1", (4, 32), "the key has more than 16 parts"),
    ("[inverter]", "[" + ".".join(["'a'"] * 50000) + "]", (10, 65), "the key has more than 16 parts"),
    ("R_ohm = 0.9", "x = {" + ".".join(["a"] * 50000) + " = 1}", (4, 37), "the key has more than 16 parts"),
]

SCENARIO_ROWS = [
    ("cycles = 400", "cycles = -1", "-1", "cycles must be a whole number"),
    ("cycles = 400\n", "", "[[run]]", "cycles or duration_s is missing"),
    ("feedback = \"midpoint\"", "feedback = \"mean\"", "\"mean\"", "feedback must be \"midpoint\""),
    ("speed_rpm = 1000", "speed_rpm = \"fast\"", "\"fast\"", "speed_rpm must be"),
    ("period_s = 0.02", "period_s = 0", "0 } }", "period_s must be a number > 0"),
    ("speed_rpm", "sped_rpm", "sped_rpm", "did you mean speed_rpm?"),
    ("current_noise_A = 0.01", "current_noise_A = nan", "nan", "current_noise_A must be"),
    ("feedback = \"midpoint\"", "feedback = \"midpoint\"\nupdates = 2", (4, 11), "updates = 2 needs feedback ="),
    ("feedback = \"midpoint\"", "updates = 3", (3, 11), "updates must be a whole number"),
    ("feedback = \"midpoint\"", "modulation = \"six_step\"\nangle = \"observed\"", (4, 9), "needs updates = 1"),
    ("feedback = \"midpoint\"", "angle = \"seen\"", (3, 9), "angle must be \"measured\" or \"observed\""),
]

RECORDING_ROWS = [
    ("theta_e_rad,", "", (2, 1), "missing column: theta_e_rad; found t_s,i_a_A"),
    ("u_b_V", "u_x_V", (2, 1), "missing columns: u_a_V, u_b_V, u_c_V (or d_a"),
    ("i_b_A", "i_a_A", (2, 11), "column i_a_A is twice in the header"),
    ("1.1,", "1.1A,", "1.1A", "i_a_A \"1.1A\" is not a number"),
    ("1.1,", "nan,", "nan", "i_a_A \"nan\" is not finite"),
    ("1.1,", "inf,", "inf", "i_a_A \"inf\" is not finite"),
    ("0.125,", ",", (4, 23), "theta_e_rad is empty"),
    ("10.5,-5.0,-5.5\n", "10.", (4, 1), "the row has 7 fields, the header has 9; is the file cut off?"),
    ("-5.5\n", "-5.5,0\n", (4, 48), "the row has 10 fields, the header has 9"),
    ("0.00025", "0.00000", (4, 1), "t_s = 0 does not rise"),
    (program.RECORDING, "", (1, 1), "the file is empty"),
    ("0.00000,1.0,-0.5,-0.5,0.10,100,10.0,-5.0,-5.0\n0.00025,1.1,-0.5,-0.6,0.125,100,10.5,-5.0,-5.5\n", "", (3, 1),
     "expected rows"),
]

# A file that is not there, a folder, bytes that are no text; tried in each reader's place.
def file_rows():
    packed = gzip.compress(program.RECORDING.encode() * 2000, mtime=0)
    return [
        ("motor.toml", None, "motor.toml: cannot be read: No such file or directory"),
        ("scenario.toml", None, "scenario.toml: cannot be read: No such file or directory"),
        ("recording.csv", None, "recording.csv: cannot be read: No such file or directory"),
        ("motor.toml", bytes(range(256)) * 16, "motor.toml:1:1: not TOML"),
        ("motor.toml", b"", "motor.toml:1:1: motor is missing"),
        ("motor.toml", program.RECORDING, "motor.toml:2:4: not TOML"),
        ("recording.csv", bytes(range(255, -1, -1)) * 16, "recording.csv:"),
        ("recording.csv", program.MOTOR, "recording.csv:"),
        ("recording.csv", packed[:len(packed) // 2], "the gzip data is cut or damaged"),
    ]


KNOWN = ("reproduce", "simulate", "sweep", "diagnose", "loops")

# Calls that cannot be understood.
USAGE_ROWS = [
    ([], "expected a command"),
    (["simulat"], "unknown command \"simulat\""),
    (["--motor"], "unknown option --motor"),
    (["simulate", "--motr", "motor.toml"], "did you mean --motor?"),
    (["simulate", "--scenario", "scenario.toml", "-o", "out.csv"], "--motor M.toml is missing"),
    (["record", "--port", "motor.toml", "-o", "out.csv"], "motor.toml: no row received: 0 frames"),
    (["simulate", "--motor", "motor.toml", "-o", "out.csv"], "--scenario S.toml is missing"),
    (["simulate", "--motor"], "--motor needs a value"),
    (["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "out.csv", "more"], "\"more\""),
    (["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "none/out.csv"], "none/out.csv"),
    (["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "out.csv", "--seed", "x"], "--seed"),
    (["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "out.csv", "--effect", "nonsense"],
     "nonsense"),
    (["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "out.csv", "--effect",
      "dead_time:t_dead=late"], "t_dead"),
    (["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "out.csv", "--effect",
      "dead_time:t_ded=1e-6"], "t_ded"),
    (["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "."], "is a directory"),
    (["sweep", "--motor", "motor.toml", "--rpm", "fast", "--json", "out.json"], "--rpm"),
    (["sweep", "--rpm", "1000", "--json", "out.json"], "--motor"),
    (["sweep", "--motor", "motor.toml", "--json", "out.json"], "--rpm N[,N...] is missing"),
    (["sweep", "--motor", "motor.toml", "--rpm", "1e99", "--json", "out.json"], "--rpm must be"),
    (["sweep", "--motor", "motor.toml", "--rpm", "500", "--current-rms", "-1", "--json", "out.json"], "--current-rms"),
    (["sweep", "--motor", "motor.toml", "--rpm", "500", "--map", "--json", "out.json"], "--map and --rpm exclude each other"),
    (["sweep", "--motor", "motor.toml", "--induction", "--json", "out.json"], "--induction has its own machine"),
    (["sweep", "--motor", "motor.toml", "--rpm", "500", "--json", "."], "is a directory"),
    (["reproduce", "--paper", "2017"], "--paper"),
    (["reproduce", "--paper"], "--paper needs a value"),
    (["reproduce", "more"], "\"more\""),
    (["loops", "more"], "\"more\""),
    (["loops", "--json"], "--json needs a value"),
    (["loops", "--extended", "motor.toml"], "--motor M.toml is missing"),
    (["loops", "--effect", "dead_time"], "--motor M.toml is missing"),
    (["loops", "--motor", "motor.toml"], "--extended X.toml is missing"),
    (["loops", "--motor", "motor.toml", "--extended", "motor.toml", "-o", "out"], "--extended draws no page"),
    (["loops", "--motor", "motor.toml", "--extended", "motor.toml", "--effect", "nonsense"], "nonsense"),
    (["loops", "--pulse-modes", "--motor", "motor.toml", "--extended", "motor.toml"], "remove --extended"),
    (["loops", "--pulse-modes", "--effect", "dead_time"], "--motor M.toml is missing"),
    (["loops", "--motor", "motor.toml", "--extended", "none.toml"], "none.toml: cannot be read"),
    (["diagnose", "recording.csv"], "--motor"),
    (["diagnose", "--motor", "motor.toml"], "iqfoc: diagnose: "),
    (["diagnose", "recording.csv", "other.csv", "--motor", "motor.toml", "-o", "out"], "one recording; \"other.csv\" is a second one"),
    (["diagnose", "recording.csv", "--motor", "motor.toml", "-o", ""], "an output directory needs a name"),
    (["diagnose", "recording.csv", "--motor", "motor.toml", "-o", "motor.toml"], "motor.toml: is not a directory"),
]


class BadInput(unittest.TestCase):
    commands = program.commands_there()

    def refused(self, arguments, changed, start, words):
        """Runs once into an empty place and once over files that exist already."""
        for precious in (False, True):
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                program.write_files(folder, changed)
                if precious:
                    for file in ("out.csv", "out.json"):
                        (folder / file).write_text("precious")
                before = {path.name: path.read_bytes() for path in folder.iterdir()}
                result = program.run(arguments, folder)
                error = result.stderr.decode(errors="replace")
                self.assertEqual(2, result.returncode, error)
                self.assertEqual(1, error.count("\n"), error)
                self.assertTrue(error.endswith("\n"), error)
                self.assertTrue(error.startswith("iqfoc: " + start), f"expected 'iqfoc: {start}', got: {error}")
                self.assertIn(words, error)
                self.assertTrue(all(c.isprintable() for c in error[:-1]), repr(error))
                self.assertEqual(before, {path.name: path.read_bytes() for path in folder.iterdir()})

    def try_spoiled(self, file, rows):
        for command, call in program.CALLS.items():
            if command not in self.commands or file not in call["reads"]:
                continue
            for old, new, where, words in rows:
                with self.subTest(command=command, new=new, words=words):
                    text = replaced(program.FILES[file], old, new)
                    if isinstance(where, str):
                        where = position(text, where)
                    else:
                        where = "{}:{}".format(*where)
                    self.refused([command, *call["arguments"]], {file: text}, f"{file}:{where}:", words)

    def test_motor(self):
        self.try_spoiled("motor.toml", MOTOR_ROWS)

    def test_scenario(self):
        self.try_spoiled("scenario.toml", SCENARIO_ROWS)

    def test_recording(self):
        self.try_spoiled("recording.csv", RECORDING_ROWS)

    def test_files(self):
        for file, content, words in file_rows():
            for command, call in program.CALLS.items():
                if command in self.commands and file in call["reads"]:
                    with self.subTest(command=command, words=words):
                        self.refused([command, *call["arguments"]], {file: content}, file, words)

    def test_files_without_an_end(self):
        """Each far larger than it may be: one clear line, within seconds and 200 MB."""
        header = program.RECORDING.splitlines(keepends=True)[1].encode()
        with_runs = header.replace(b"t_s", b"run,t_s")
        row = b"%d,0.%05d,1,-0.5,-0.5,0.1,100,10,-5,-5\n"

        def packed(*parts):
            return [gzip.compress(part) * times for part, times in parts]

        def two_runs():
            return b"".join(row % (run, k) for run in (1, 2) for k in range(100)) * 2000

        # Pieces of a file, or how many zero bytes it holds; the words of the complaint.
        large = {"a line of 1 GB": (1 << 30, b"recording.csv:1: the line is longer"),
                 "10,000,000 columns": (lambda: (b"a," * 10_000 for _ in range(1000)), b"recording.csv:1: the line is longer"),
                 "5,000 columns": (lambda: [b"a," * 5_000], b"recording.csv:1:2049: more than 1024 columns"),
                 "1,000,000 runs": (lambda: (row % (run, 0) if run else with_runs for run in range(1_000_000)), b"more than 100000 runs"),
                 "a packed line of 1 GB": (lambda: packed((bytes(1 << 24), 64)), b"recording.csv:1: the line is longer"),
                 "1 GB of packed rows": (lambda: packed((with_runs, 1), (two_runs(), 64)), b"unpacks to more than 100 times its size"),
                 "1 GB of packed blank lines": (lambda: packed((header, 1), (b"\n" * (1 << 24), 64)), b"more than a million lines"),
                 "1 GB of packed comments": (lambda: packed((b"#\n" * (1 << 23), 64)), b"more than a million lines")}
        for title, (content, words) in large.items():
            with self.subTest(title), tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                program.write_files(folder, {"recording.csv": b""})
                with open(folder / "recording.csv", "wb") as file:
                    file.writelines([] if isinstance(content, int) else content())
                    file.truncate(content if isinstance(content, int) else None)
                with open(folder / "messages", "wb") as messages:
                    child = subprocess.Popen([program.PROGRAM, "diagnose", "recording.csv", "--motor", "motor.toml"], cwd=folder,
                                             stdout=subprocess.DEVNULL, stderr=messages)
                    _, status, used = os.wait4(child.pid, 0)
                    child.returncode = os.waitstatus_to_exitcode(status)
                error = (folder / "messages").read_bytes()
                self.assertEqual(2, child.returncode, error)
                self.assertIn(words, error)
                self.assertEqual(1, error.count(b"\n"), error)
                self.assertLess(used.ru_utime + used.ru_stime, 2.0)
                self.assertLess(used.ru_maxrss, 200_000)

    def test_usage(self):
        for arguments, words in USAGE_ROWS:
            if arguments and arguments[0] in KNOWN and arguments[0] not in self.commands:
                continue
            with self.subTest(arguments=arguments):
                self.refused(arguments, {}, "", words)

    def test_a_motor_whose_current_follows_at_once(self):
        """Its time constant is a nanosecond: solved step by step a plan would not end."""
        motor = replaced(program.MOTOR, "L_d_H = 0.008", "L_d_H = 1e-9")
        for command in (["plan", "--motor", "motor.toml", "--seconds", "2", "-o", "plan.toml"],
                        ["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", "out.csv"]):
            with self.subTest(command=command):
                self.refused(command, {"motor.toml": motor}, "", "drive: L is 1e-09 H, expected at least 2.25e-07 H")

    def test_a_motor_that_does_not_fit_the_number_format(self):
        """R of 1 Gohm at 10 A and 565 V is far beyond what IQ24 holds per unit: refused by name, not clipped."""
        text = replaced(program.MOTOR, "R_ohm = 0.9", "R_ohm = 1e9")
        for command in ("simulate", "sweep"):
            if command in self.commands:
                with self.subTest(command=command):
                    self.refused([command, *program.CALLS[command]["arguments"]], {"motor.toml": text},
                                 "motor.toml:" + position(text, "1e9") + ":", "R_ohm")

    def test_a_corrected_mean_that_would_trip(self):
        """Below an SFFR of some 7.5 no bandwidth is stable; above, the message has the highest that is."""
        scenario = replaced(program.SCENARIO, "feedback = \"midpoint\"", "feedback = \"corrected_mean\"")
        scenario = replaced(scenario, "speed_rpm = 1000", "speed_rpm = -6000")
        arguments = ["simulate", *program.CALLS["simulate"]["arguments"]]
        files = {"motor.toml": replaced(program.MOTOR, "f_pwm_Hz = 4000", "f_pwm_Hz = 1500"), "scenario.toml": scenario}
        self.refused(arguments, files, "", "at 6000 rpm (SFFR 5) with any bandwidth")
        files = {"scenario.toml": replaced(scenario, "corrected_mean\"", "corrected_mean\"\nbandwidth_Hz = 500")}
        self.refused(arguments, files, "", "expected bandwidth_Hz of at most ")


if __name__ == "__main__":
    unittest.main(argv=[__file__, "-v"])
