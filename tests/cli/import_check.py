"""`iqfoc import --check`: each mistake planted alone in the log of a small machine of this file's own, and presets."""

import math
import pathlib
import random
import re
import tempfile
import unittest

import foreign
import program

EXAMPLES = program.ROOT / "tests/import"
MOTOR = program.MOTOR  # three pole pairs, 0.9 ohm, 8 and 11 mH, 0.2 Wb, 4 kHz
R, L_D, L_Q, PSI, T, U_DC = 0.9, 0.008, 0.011, 0.2, 1 / 4000, 565.0
ROWS, STEPS = 3000, 8


def machine(shift=0.0, omega=200.0):
    """A log whose command of row k acts from cycle k + shift on; integrated by Heun's rule in small steps."""
    i_d = i_q = theta = 0.0
    commands, rec = [], {n: [] for n in ("t_s", *foreign.I_ABC, "theta_e_rad", "omega_e_rad_s", "d_a", "d_b", "d_c", "u_dc_V")}

    def slope(x, y, u_d, u_q):
        return (u_d - R * x + omega * L_Q * y) / L_D, (u_q - R * y - omega * L_D * x - omega * PSI) / L_Q

    for k in range(ROWS):
        # Voltages that hold the currents near a target which jumps, so that there is something to see.
        want_d, want_q = (-1.5 if k // 70 % 2 else 0.5), (4.0 if k // 110 % 2 else -2.0)
        u_d = R * want_d - omega * L_Q * want_q + 12 * (want_d - i_d)
        u_q = R * want_q + omega * (L_D * want_d + PSI) + 12 * (want_q - i_q)
        ahead = theta + omega * T * (0.5 + shift)
        alpha, beta = u_d * math.cos(ahead) - u_q * math.sin(ahead), u_q * math.cos(ahead) + u_d * math.sin(ahead)
        phases = [alpha, -alpha / 2 + foreign.ROOT3 / 2 * beta, -alpha / 2 - foreign.ROOT3 / 2 * beta]
        commands.append([0.5 + u / U_DC for u in phases])
        i_alpha, i_beta = i_d * math.cos(theta) - i_q * math.sin(theta), i_q * math.cos(theta) + i_d * math.sin(theta)
        currents = [i_alpha, -i_alpha / 2 + foreign.ROOT3 / 2 * i_beta, -i_alpha / 2 - foreign.ROOT3 / 2 * i_beta]
        for name, value in zip(rec, (k * T, *currents, theta, omega, *commands[k], U_DC)):
            rec[name].append(value)
        for step in range(STEPS):
            row = max(0, math.floor(k + step / STEPS - shift))
            x, y = foreign.clarke(*(U_DC * d for d in commands[row]))
            h = T / STEPS
            u_d, u_q = foreign.park(x, y, theta + 0.5 * omega * h)
            a = slope(i_d, i_q, u_d, u_q)
            b = slope(i_d + h * a[0], i_q + h * a[1], u_d, u_q)
            i_d, i_q, theta = i_d + h * (a[0] + b[0]) / 2, i_q + h * (a[1] + b[1]) / 2, theta + omega * h
    rec["theta_e_rad"] = [math.remainder(th, 2 * math.pi) for th in rec["theta_e_rad"]]
    return rec


MAP = "[columns]\n" + "".join(f'{n} = "{n}"\n' for n in ("t_s", *foreign.I_ABC, "theta_e_rad", "omega_e_rad_s", "d_a", "d_b",
                                                       "d_c", "u_dc_V"))


def negative(values):
    return [-x for x in values]


class Check(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rec = machine()

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        (self.folder / "motor.toml").write_text(MOTOR)

    def tearDown(self):
        self.scratch.cleanup()

    def check(self, changed=None, text=MAP, rec=None):
        (self.folder / "log.csv").write_text(foreign.table({**(rec or self.rec), **(changed or {})}))
        (self.folder / "map.toml").write_text(text)
        before = sorted(self.folder.iterdir())
        done = program.run(["import", "log.csv", "--map", "map.toml", "--motor", "motor.toml", "--check"], self.folder)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        self.assertEqual(before, sorted(self.folder.iterdir()))
        return done.stdout.decode()

    def lines(self, out):
        """(the list of what is wrong, the lines for the map)."""
        self.assertIn("In the map:", out)
        head, tail = out.split("In the map:")
        return [line.strip(" -") for line in head.splitlines() if line.startswith("  - ")], tail.split("\n")

    def corrected(self, text, out):
        """The map with the lines that the check printed for its columns."""
        for line in self.lines(out)[1]:
            old = [x for x in text.splitlines() if line and x.startswith(line.split()[0] + " =")]
            text = text.replace(old[0], line) if old else text
        return text

    def only(self, words, line, changed=None, **more):
        out = self.check(changed, **more)
        wrong, tail = self.lines(out)
        self.assertEqual(len(wrong), 1, out)
        self.assertIn(words, wrong[0])
        self.assertIn(line, tail, out)
        # The printed line corrects it.
        left = [float(x) for x in re.findall(r"(\S+) %", out)]
        self.assertLess(left[-1], 2.0, out)

    def test_nothing_wrong(self):
        self.assertIn("keep the map", self.check())

    def test_no_worse_map_is_recommended(self):
        """Currents that belong to no machine: what is printed as best misses less than the map, or the map stays."""
        for seed in range(6):
            drawn = random.Random(seed)
            out = self.check({n: [drawn.gauss(0.0, 5.0) for _ in self.rec[n]] for n in foreign.I_ABC})
            if "In the map:" in out and "negative" not in out:
                mapped, best = (float(re.search(words + r" (\S+) %", out)[1]) for words in ("misses", "arrangements:"))
                self.assertLess(best, mapped, out)
            else:
                self.assertTrue("keep the map" in out or "no arrangement" in out or "negative" in out, out)

    def test_polarity(self):
        self.only("the currents have the wrong sign", 'i_b_A = { from = "i_b_A", scale = -1 }',
                  {n: negative(self.rec[n]) for n in foreign.I_ABC})
        for n, phase in zip(foreign.I_ABC, "ABC"):
            self.only(f"column of phase {phase} has the wrong sign", f'{n} = {{ from = "{n}", scale = -1 }}',
                      {n: negative(self.rec[n])})

    def test_polarity_of_two_measured_phases(self):
        text = MAP.replace('i_c_A = "i_c_A"\n', "")
        self.assertIn("keep the map", self.check(text=text))
        self.only("column of phase B has the wrong sign", 'i_b_A = { from = "i_b_A", scale = -1 }',
                  {"i_b_A": negative(self.rec["i_b_A"])}, text=text)
        self.only("currents: phases A, B, C are in the columns of C, B, A", 'i_c_A = { from = "i_a_A" }',
                  {"i_a_A": self.rec["i_c_A"]}, text=text)

    def test_order(self):
        a, b, c = (self.rec[n] for n in foreign.I_ABC)
        self.only("columns of B, A, C", 'i_a_A = { from = "i_b_A" }', {"i_a_A": b, "i_b_A": a})
        self.only("columns of C, A, B", 'i_a_A = { from = "i_c_A" }', {"i_a_A": b, "i_b_A": c, "i_c_A": a})
        self.only("commands: phases A, B, C are in the columns of A, C, B", 'd_b = { from = "d_c" }',
                  {"d_b": self.rec["d_c"], "d_c": self.rec["d_b"]})

    def test_direction_and_zero(self):
        theta, omega = self.rec["theta_e_rad"], self.rec["omega_e_rad_s"]
        self.only("the angle counts against", 'theta_e_rad = { from = "theta_e_rad", scale = -1 }',
                  {"theta_e_rad": negative(theta), "omega_e_rad_s": negative(omega)})
        for off in (0.5, -1.2, 2.0):
            out = self.check({"theta_e_rad": [th + off for th in theta]})
            self.assertIn("degrees from where the angle says", out)
            self.assertAlmostEqual(float(re.search(r"zero = (\S+) ", out)[1]), off, delta=0.02)
        counts = [(5000 - th / 3 / (2 * math.pi) * 4096 + 300) % 4096 for th in theta]
        text = (MAP.replace('"theta_e_rad"', '{ from = "theta_e_rad", unit = "count", per_turn = 4096, mechanical = true }')
                .replace('omega_e_rad_s = "omega_e_rad_s"\n', ""))
        # An encoder that counts backwards, with a zero of its own: the printed line corrects both.
        out = self.check({"theta_e_rad": counts}, text=text)
        self.assertIn("keep the map", self.check({"theta_e_rad": counts}, text=self.corrected(text, out)), out)

    def test_mechanical_angle(self):
        theta = [math.remainder(th / 3, 2 * math.pi) for th in self.unwrapped()]
        omega = [w / 3 for w in self.rec["omega_e_rad_s"]]
        changed = {"theta_e_rad": theta, "omega_e_rad_s": omega}
        out = self.check(changed)
        self.assertIn("the angle is the rotor's mechanical one", out)
        self.assertIn('theta_e_rad = { from = "theta_e_rad", mechanical = true }', out)
        self.assertIn('omega_e_rad_s = { from = "omega_e_rad_s", mechanical = true }', out)
        self.assertIn("keep the map", self.check(changed, text=self.corrected(MAP, out)))

    def test_zero_of_the_converter(self):
        """Counts of a 12-bit converter, its middle left in; the printed lines correct it, whichever else is wrong."""
        ampere = 0.01
        counts = {n: [round(2048 + 5 * k + i / ampere) for i in self.rec[n]] for k, n in enumerate(foreign.I_ABC)}
        text = MAP
        for n in foreign.I_ABC:
            text = text.replace(f'{n} = "{n}"', f'{n} = {{ from = "{n}", scale = {ampere} }}')
        for sign in (1, -1):
            changed = counts if sign > 0 else {n: [4096 - c for c in v] for n, v in counts.items()}
            out = self.check(changed, text=text)
            self.assertIn("reads 20.", out)
            self.assertEqual(sign < 0, "wrong sign" in out, out)
            self.assertIn("keep the map", self.check(changed, text=self.corrected(text, out)), out)

    def test_power_invariant_values(self):
        """In d and q, sqrt(3/2) times the amplitude: currents alone, then voltages too."""
        i = foreign.dq(self.rec, foreign.I_ABC)
        rec = {n: v for n, v in self.rec.items() if n not in foreign.I_ABC}
        text = re.sub(r"i_._A = .*\n", "", MAP) + 'i_d_A = "d"\ni_q_A = "q"\n'
        rec.update(d=[x for x, _ in i], q=[y for _, y in i])
        self.assertNotIn("power-invariant", self.check(rec=rec, text=text))
        rec.update(d=[math.sqrt(1.5) * x for x, _ in i], q=[math.sqrt(1.5) * y for _, y in i])
        out = self.check(rec=rec, text=text)
        self.assertIn("the currents are 1.22 times too large: a power-invariant transform? Then scale = 0.816497", out)
        u = foreign.dq(rec, ("d_a", "d_b", "d_c"))
        rec.update(u_d=[math.sqrt(1.5) * U_DC * x for x, _ in u], u_q=[math.sqrt(1.5) * U_DC * y for _, y in u])
        text = re.sub(r"(?m)^d_. = .*\n", "", text) + 'u_d_V = "u_d"\nu_q_V = "u_q"\n'
        self.assertIn("currents and voltages are 1.22 times too large", self.check(rec=rec, text=text))

    def unwrapped(self):
        turns, out = 0, []
        for th in self.rec["theta_e_rad"]:
            while out and th + 2 * math.pi * turns < out[-1] - math.pi:
                turns += 1
            out.append(th + 2 * math.pi * turns)
        return out

    def test_inverted_counts(self):
        flipped = {n: [1 - d for d in self.rec[n]] for n in ("d_a", "d_b", "d_c")}
        self.only("the commands are inverted", "inverted = true", flipped)
        self.only("the commands are inverted", "inverted = false", text=MAP + "[pwm]\nframe = 1\ninverted = true\n")

    def test_shift(self):
        for shift in (0.5, 1, 1.5, 2):
            rec = machine(shift)
            self.only(f"a command acts {shift:g} cycle{'' if shift == 1 else 's'} after its row", f"shift_cycles = {shift:g}", rec=rec)
            self.assertIn("keep the map", self.check(rec=rec, text=MAP + f"[timing]\nshift_cycles = {shift}\n"))

    def test_currents_in_the_rotors_frame(self):
        i = foreign.dq(self.rec, foreign.I_ABC)
        rec = {n: v for n, v in self.rec.items() if n not in foreign.I_ABC}
        rec.update(d=[-x for x, _ in i], q=[-y for _, y in i])
        text = re.sub(r"i_._A = .*\n", "", MAP) + 'i_d_A = "d"\ni_q_A = "q"\n'
        self.only("the currents have the wrong sign", 'i_q_A = { from = "q", scale = -1 }', rec=rec, text=text)

    def test_without_a_turning_magnet_the_doubt_is_reported(self):
        rec = machine(omega=0.0)
        self.assertIn("keep the map", self.check(rec=rec))
        out = self.check({n: negative(rec[n]) for n in foreign.I_ABC}, rec=rec)
        self.assertIn("reversed currents and inverted commands look alike", out)

    def test_usage(self):
        for words, more in (("--check writes nothing", ["--map", "m", "--motor", "motor.toml", "-o", "r.csv"]),
                            ("--map MAP.toml is missing", ["--motor", "motor.toml"]), ("--motor M.toml is missing", ["--map", "m"])):
            done = program.run(["import", "log.csv", "--check", *more], self.folder)
            self.assertEqual((done.returncode, words in done.stderr.decode()), (2, True), done.stderr)


# What the import of each example needs in addition to its map.
PRESETS = {"vesc": ["--motor"], "odrive": [], "moteus": [], "simplefoc": ["--motor"], "ti-datalog": [], "freemaster": [],
           "motulator": []}


class Presets(unittest.TestCase):
    """The preset's map, given a rate where the log has no time, makes a recording of each example."""

    def test_each(self):
        self.assertEqual(sorted(p.stem for p in EXAMPLES.glob("*.csv")), sorted(PRESETS))
        for name, more in PRESETS.items():
            with self.subTest(preset=name), tempfile.TemporaryDirectory() as scratch:
                folder = pathlib.Path(scratch)
                text = program.run(["import", "--preset", name], folder).stdout.decode()
                self.assertTrue(text.startswith("# "), text)
                (folder / "map.toml").write_text(text.replace("# [timing]\n# rate_Hz", "[timing]\nrate_Hz"))
                (folder / "motor.toml").write_text(MOTOR)
                call = ["import", EXAMPLES / f"{name}.csv", "--map", "map.toml", "-o", "rec.csv"]
                done = program.run(call + (["--motor", "motor.toml"] if more else []), folder)
                if name == "vesc":
                    # Rows 20 ms apart are no cycles: without a motor's cycle nobody can know, with it they are refused.
                    self.assertEqual(done.returncode, 2)
                    self.assertIn("80 cycles of motor.toml", done.stderr.decode())
                    continue
                self.assertEqual(done.returncode, 0, done.stderr.decode())
                rec = foreign.whole(foreign.read_recording(folder / "rec.csv"))
                # All examples hold the same state of one machine: i_d = -1 A, i_q = 2 A.
                for i_d, i_q in foreign.dq(rec, foreign.I_ABC):
                    self.assertAlmostEqual(i_d, -1.0, delta=2e-3)
                    self.assertAlmostEqual(i_q, 2.0, delta=2e-3)
                for row, (first, second) in enumerate(zip(rec["theta_e_rad"], rec["theta_e_rad"][1:])):
                    self.assertAlmostEqual(math.remainder(second - first, 2 * math.pi), 0.03, delta=2e-3, msg=row)


if __name__ == "__main__":
    unittest.main(argv=["import_check"])
