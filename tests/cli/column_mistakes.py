"""Mistakes in a recording's columns are named in one line, and no known effect is taken for one.

Each mistake is written into good recordings: of a drive that is not ours (data/recordings/, two or three sensors), and of `iqfoc simulate`,
turning and at standstill, with a dead time as well. The other way round, every effect that `simulate --list-effects` lists, small and
large, must pass the checks (with all causes skipped, as the search is not what is tested). The binary is the first argument.
"""

import gzip
import itertools
import math
import pathlib
import re
import tempfile
import unittest

import program

MOTOR = program.ROOT / "data/motors/compressor_salient.toml"

SCENARIO = """name = "short"
[sensors]
current_bits = 12
current_full_scale_A = 25
current_noise_A = 0.025
[log]
duties = true
"""
TURNING = "".join(f"""[[run]]
duration_s = 0.2
speed_rpm = {rpm}
i_d_A = {{ value = {i_d}, square = {{ amplitude = 1.0, period_s = 0.023 }} }}
i_q_A = {{ value = {i_q}, square = {{ amplitude = 1.0, period_s = 0.037 }} }}
""" for rpm, i_d, i_q in ((300, 0, 3), (1500, -1, 6), (-1500, 0, -5), (3000, -2, 4)))
STANDING = "".join(f"""[[run]]
duration_s = 0.4
speed_rpm = 0
theta_mech_start_rad = {theta}
i_{axis}_A = {{ at_s = [0, 0.1, 0.2, 0.3], steps = [2, 5, -2, -5], square = {{ amplitude = 1.0, period_s = 0.008 }} }}
""" for theta, axis in ((0.0, "d"), (0.35, "d"), (0.7, "q"), (1.4, "q")))

# In addition to the typical size of each effect, the default of --list-effects' keys.
LARGE = ["resistance:R=3", "inductance:L=0.016", "flux_linkage:psi_f=0.15", "saliency:L_d=0.005,L_q=0.016", "saturation:I_sat=6",
         "dead_time:t_dead=6e-6,v_switch=1.5,v_diode=1", "voltage_gain:k_u=0.7", "voltage_gain:k_u=1.4",
         "current_offset:o_a=1,o_b=-1,o_c=0.5", "current_gain:g_a=0.6,g_b=1,g_c=1", "current_gain:g_a=1,g_b=1.6,g_c=1",
         "current_gain:g_a=0.6,g_b=0.6,g_c=1.6", "angle_offset:theta_0=0.6", "angle_offset:theta_0=-0.6",
         "angle_harmonic:order=2,amplitude=0.2", "angle_delay:t_delay=2.5e-4", "voltage_delay:cycles=2",
         "emf_harmonics:psi_5=0.02,psi_7=0.01", "phase_asymmetry:dR_a=3", "phase_inductance:dL_a=0.006", "current_noise:sigma=0.5",
         "current_quantisation:bits=5,full_scale=25", "current_bandwidth:f=700", "angle_noise:sigma=0.05",
         "u_dc_ripple:amplitude=100,frequency=300,logged=0", "iron_loss:R_fe=60,tau_fe=1e-4", "glitch:probability=0.1",
         "loose_sensor:probability=0.2,channel=1,gain=0", "loose_sensor:probability=0.05,channel=2,samples=20,step=5"]


class Table:
    """A recording as columns of text."""

    def __init__(self, path):
        data = path.read_bytes()
        text = (gzip.decompress(data) if path.suffix == ".gz" else data).decode()
        lines = [line for line in text.splitlines() if not line.startswith("#")]
        self.columns = dict(zip(lines[0].split(","), map(list, zip(*(line.split(",") for line in lines[1:])))))
        for name in [name for name in self.columns if name.endswith("_mid_A")]:
            del self.columns[name]

    def copy(self):
        other = object.__new__(Table)
        other.columns = {name: list(column) for name, column in self.columns.items()}
        return other

    def scale(self, by, *names):
        for name in names:
            self.columns[name] = [repr(by * float(x)) for x in self.columns[name]]

    def write(self, path):
        rows = zip(*self.columns.values())
        path.write_text("\n".join([",".join(self.columns), *map(",".join, rows)]) + "\n")


def two_sensors(table):
    table.columns.pop("i_c_A", None)


def negated(phase):
    return lambda table: table.scale(-1.0, f"i_{phase}_A")


def negated_of_two(phase):
    return lambda table: (two_sensors(table), negated(phase)(table))


def exchanged_of_two(table):
    """Phase C's sensor in B's column."""
    two_sensors(table)
    table.columns["i_b_A"] = [repr(-float(a) - float(b)) for a, b in zip(table.columns["i_a_A"], table.columns["i_b_A"])]


def exchanged(table):
    i = table.columns
    i["i_b_A"], i["i_c_A"] = i["i_c_A"], i["i_b_A"]


def reversed_currents(table):
    table.scale(-1.0, *(name for name in table.columns if re.fullmatch("i_[abc]_A", name)))


def inverted(table):
    if "d_a" in table.columns:
        for phase in "abc":
            table.columns.pop(f"u_{phase}_V", None)
            table.columns[f"d_{phase}"] = [repr(1.0 - float(d)) for d in table.columns[f"d_{phase}"]]
    else:
        table.scale(-1.0, "u_a_V", "u_b_V", "u_c_V")


def backwards(table):
    table.scale(-1.0, "theta_e_rad", "omega_e_rad_s")


def mechanical(pole_pairs, zero_rad):
    """Angle and speed of the shaft, whose zero need not be the magnet's."""

    def spoil(table):
        electrical = [float(x) for x in table.columns["theta_e_rad"]]
        turned = itertools.accumulate(math.remainder(b - a, 2.0 * math.pi) for a, b in itertools.pairwise(electrical))
        start = electrical[0] / pole_pairs + zero_rad
        table.columns["theta_e_rad"] = [repr((start + x / pole_pairs) % (2.0 * math.pi)) for x in (0.0, *turned)]
        table.scale(1.0 / pole_pairs, "omega_e_rad_s")

    return spoil


# (mistake, words that name it, needs a measured third current, can be seen at standstill)
MISTAKES = [
    (negated("a"), "current column of phase A looks negated", True, True),
    (negated("b"), "current column of phase B looks negated", True, True),
    (negated("c"), "current column of phase C looks negated", True, True),
    (negated_of_two("a"), "current column of phase A looks negated", False, True),
    (negated_of_two("b"), "current column of phase B looks negated", False, True),
    (exchanged, "current columns of phases B and C look swapped", True, True),
    (exchanged_of_two, "current columns of phases B and C look swapped", False, True),
    (reversed_currents, "the currents have the wrong sign", False, True),
    (inverted, "the voltages or duties look inverted", False, True),
    # What counts backwards at standstill shows in the saliency alone, and not together with a dead time.
    (backwards, "the angle counts against the phases", False, False),
    (lambda table: table.scale(0.0, "i_b_A"), "current column of phase B looks dead", True, True),
    (lambda table: table.scale(4.0, "i_c_A"), "current column of phase C looks scaled by 4", True, True),
]


class ColumnMistakes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.place.name)

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def simulate(self, runs, effect=None, motor=MOTOR):
        (self.folder / "scenario.toml").write_text(SCENARIO + runs)
        more = ["--effect", effect] if effect else []
        result = program.run(["simulate", "--motor", motor, "--scenario", "scenario.toml", "-o", "made.csv", *more], self.folder)
        self.assertEqual(0, result.returncode, result.stderr)
        return self.folder / "made.csv"

    def refused(self, words, path, motor):
        result = program.run(["diagnose", path, "--motor", motor], self.folder)
        error = result.stderr.decode()
        self.assertEqual(2, result.returncode, error + result.stdout.decode())
        self.assertEqual(1, error.count("\n"), error)
        self.assertTrue(error.startswith(f"iqfoc: {path}"), error)
        self.assertIn(words, error)

    def try_mistakes(self, good, motor, turning):
        for mistake, words, needs_third, at_standstill in MISTAKES:
            if (needs_third and "i_c_A" not in good.columns) or not (turning or at_standstill):
                continue
            with self.subTest(words=words, third=needs_third):
                spoiled = good.copy()
                mistake(spoiled)
                spoiled.write(self.folder / "spoiled.csv")
                self.refused(words, "spoiled.csv", motor)

    def test_recordings_of_another_drive(self):
        for name in ("clean", "dead_time", "saliency", "flux_and_angle", "sensor_gain"):
            with self.subTest(recording=name):
                path = program.ROOT / "data" / "recordings" / name
                self.try_mistakes(Table(path.with_suffix(".csv.gz")), path.with_suffix(".toml"), True)

    def test_simulated(self):
        for runs in (TURNING, STANDING):
            for effect in (None, "dead_time", "resistance"):
                with self.subTest(turning=runs is TURNING, effect=effect):
                    self.try_mistakes(Table(self.simulate(runs, effect)), MOTOR, runs is TURNING)

    def test_shaft_instead_of_rotor(self):
        words = "theta_e_rad and omega_e_rad_s look mechanical"
        for motor, scenario, pole_pairs in (("jarzebowicz2019", "run_up", 3), ("traction_400kw", "identification", 6)):
            path = program.ROOT / "data" / "motors" / f"{motor}.toml"
            made = program.run(["simulate", "--motor", path, "--scenario", program.ROOT / "data" / "scenarios" / f"{scenario}.toml",
                                "--effect", "current_noise:sigma=0.06", "-o", "made.csv"], self.folder)
            self.assertEqual(0, made.returncode, made.stderr)
            good = Table(self.folder / "made.csv")
            for zero_rad in (0.0, 0.7):
                with self.subTest(motor=motor, zero_rad=zero_rad):
                    spoiled = good.copy()
                    mechanical(pole_pairs, zero_rad)(spoiled)
                    spoiled.write(self.folder / "spoiled.csv")
                    self.refused(words, "spoiled.csv", path)

    def test_effects_are_no_mistakes(self):
        listed = program.run(["simulate", "--list-effects"], self.folder).stdout.decode()
        ids = re.findall(r"^  (\w+)", listed, re.MULTILINE)
        self.assertTrue(set(ids) >= {effect.split(":")[0] for effect in LARGE} and len(ids) >= 24)
        causes = re.findall(r"^\| `(\w+)` \|.*\| `", (program.ROOT / "docs/diagnosis_reference.md").read_text(), re.MULTILINE)
        skip = ",".join(sorted(set(causes) & set(ids)))
        for runs in (TURNING, STANDING):
            for effect in [None, *ids, *LARGE]:
                with self.subTest(turning=runs is TURNING, effect=effect):
                    path = self.simulate(runs, effect)
                    result = program.run(["diagnose", path, "--motor", MOTOR, "--skip", skip], self.folder)
                    self.assertEqual(0, result.returncode, result.stderr.decode())

    def test_no_value_is_beyond_a_drive(self):
        good = Table(program.ROOT / "data/recordings/saliency.csv.gz")
        good.columns = {name: column[:200] for name, column in good.columns.items()}
        motor = program.ROOT / "data/recordings/saliency.toml"
        for name in good.columns:
            for value in ("1e300", "-1e300", "1e-300", "4.9e-324", "1e100"):
                if name == "run":
                    continue
                with self.subTest(column=name, value=value):
                    spoiled = good.copy()
                    spoiled.columns[name][40] = value
                    spoiled.write(self.folder / "spoiled.csv")
                    self.refused(f"{name} \"{value}\" is absurd; expected", "spoiled.csv", motor)
        text = MOTOR.read_text()
        for key in ("R_ohm", "L_d_H", "L_q_H", "psi_f_Wb", "I_rated_A_rms", "n_max_rpm", "f_pwm_Hz", "u_dc_V"):
            for value in ("1e300", "1e-300", "5e-324"):
                with self.subTest(key=key, value=value):
                    (self.folder / "spoiled.toml").write_text(re.sub(rf"^{key} = .*", f"{key} = {value}", text, flags=re.MULTILINE))
                    good.write(self.folder / "good.csv")
                    result = program.run(["diagnose", "good.csv", "--motor", "spoiled.toml"], self.folder)
                    self.assertEqual(2, result.returncode)
                    self.assertRegex(result.stderr.decode(), rf"^iqfoc: spoiled.toml:\d+:\d+: {key} = .* is absurd; expected .*\n$")

    def test_nothing_is_printed_that_is_no_number(self):
        """Columns without a signal, one row that has one, a run of zeros."""
        good = Table(program.ROOT / "data/recordings/clean.csv.gz")
        good.columns = {name: column[:3000] for name, column in good.columns.items()}
        currents, voltages = ["i_a_A", "i_b_A"], ["u_a_V", "u_b_V", "u_c_V"]
        currents += ["i_c_A"] if "i_c_A" in good.columns else []
        still = [(currents, 0, 3000), (voltages, 0, 3000), (currents + voltages, 0, 3000), (currents, 0, 1500), (voltages, 0, 1500),
                 (currents + voltages, 1, 3000), (currents + voltages + ["theta_e_rad", "omega_e_rad_s"], 0, 3000),
                 (["theta_e_rad", "omega_e_rad_s"], 0, 3000)]
        for names, first, last in still:
            with self.subTest(names=names, first=first, last=last):
                spoiled = good.copy()
                for name in names:
                    spoiled.columns[name][first:last] = [spoiled.columns[name][first]] * (last - first) if first == 0 and \
                        "theta_e_rad" in names else ["0"] * (last - first)
                spoiled.write(self.folder / "spoiled.csv")
                result = program.run(["diagnose", "spoiled.csv", "--motor", program.ROOT / "data/recordings/clean.toml", "--json", "out.json"],
                                     self.folder)
                told = result.stdout.decode() + result.stderr.decode()
                self.assertIn(result.returncode, (0, 2), told)
                if result.returncode == 0:
                    told += (self.folder / "out.json").read_text()
                self.assertIsNone(re.search(r"(?<![A-Za-z])(nan|inf)(?![A-Za-z])", told, re.IGNORECASE), told)

    def test_stamps_of_few_decimals(self):
        """The same verdict and nearly the same errors with rounded stamps; where a stamp repeats, a clear line."""
        for f_pwm, decimals in ((4000, 4), (7000, 4), (7000, 5), (8000, 4), (10000, 4), (16000, 5)):
            with self.subTest(f_pwm=f_pwm, decimals=decimals):
                motor = self.folder / "fast.toml"
                motor.write_text(re.sub("f_pwm_Hz = .*", f"f_pwm_Hz = {f_pwm}", MOTOR.read_text()))
                table = Table(self.simulate(TURNING, None, motor))
                told = []
                for rounded in (False, True):
                    if rounded:
                        table.columns["t_s"] = [f"{float(t):.{decimals}f}" for t in table.columns["t_s"]]
                    table.write(self.folder / "stamped.csv")
                    result = program.run(["diagnose", "stamped.csv", "--motor", motor], self.folder)
                    self.assertEqual(0, result.returncode, result.stderr.decode())
                    text = result.stdout.decode()
                    told.append((re.search(r"^  (\w+): ", text, re.MULTILINE)[1], float(re.search(r"extended (\S+)", text)[1])))
                self.assertEqual(told[0][0], told[1][0])
                self.assertAlmostEqual(told[0][1], told[1][1], delta=0.02 * told[0][1])
                table.columns["t_s"] = [f"{float(t):.3f}" for t in table.columns["t_s"]]
                table.write(self.folder / "spoiled.csv")
                self.refused("too few decimals", "spoiled.csv", motor)


if __name__ == "__main__":
    unittest.main(argv=[__file__, "-v"])
