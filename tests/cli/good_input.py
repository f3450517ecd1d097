"""The same calls with good files: they succeed, write what they should, and say so by exit status 0.

Without this a test of bad input could pass because a call never works at all.
"""

import json
import pathlib
import tempfile
import unittest

import program


class GoodInput(unittest.TestCase):
    commands = program.commands_there()

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        program.write_files(self.folder)

    def tearDown(self):
        self.temporary.cleanup()

    def done(self, arguments):
        result = program.run(arguments, self.folder)
        self.assertEqual(0, result.returncode, result.stderr.decode(errors="replace"))
        return result

    def need(self, command):
        if command not in self.commands:
            self.skipTest(f"this build has no {command}")

    def simulate(self, name="out.csv", more=()):
        self.done(["simulate", "--motor", "motor.toml", "--scenario", "scenario.toml", "-o", name, *more])
        return (self.folder / name).read_text()

    def test_help_and_version(self):
        self.assertIn("usage: iqfoc <command>", self.done(["--help"]).stdout.decode())
        self.assertRegex(self.done(["--version"]).stdout.decode(), r"^iqfoc \d+\.\d+\.\d+( \(.*\))?\n$")
        for command in self.commands:
            with self.subTest(command=command):
                text = self.done([command, "--help"]).stdout.decode()
                self.assertTrue(text.startswith(f"usage: iqfoc {command} "), text)
                self.assertIn("--help", text)

    def test_simulate(self):
        self.need("simulate")
        lines = [line for line in self.simulate().splitlines() if not line.startswith("#")]
        self.assertEqual(1 + 400, len(lines))
        header = lines[0].split(",")
        for column in ("run", "t_s", "i_a_A", "i_b_A", "theta_e_rad", "omega_e_rad_s", "u_a_V"):
            self.assertIn(column, header)
        self.assertEqual({"motor.toml", "scenario.toml", "recording.csv", "out.csv"},
                         {path.name for path in self.folder.iterdir()})

    def test_simulate_is_reproducible(self):
        self.need("simulate")
        def rows(text):
            return [line for line in text.splitlines() if not line.startswith("#")]
        first = rows(self.simulate("a.csv", ["--seed", "7"]))
        self.assertEqual(first, rows(self.simulate("b.csv", ["--seed", "7"])))
        self.assertNotEqual(first, rows(self.simulate("c.csv", ["--seed", "8"])))

    def test_diagnose(self):
        self.need("simulate")
        self.need("diagnose")
        self.simulate("recording.csv")
        self.done(["diagnose", "recording.csv", "--motor", "motor.toml", "--json", "out.json"])
        verdict = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(3, verdict["schema"])
        self.assertEqual(400, verdict["rows"])
        status = {"clean": 0, "explained": 10, "partly": 11, "unexplained": 12}[verdict["verdict"]]
        done = program.run(["diagnose", "recording.csv", "-m=motor.toml", "--exit-verdict"], self.folder)
        self.assertEqual(status, done.returncode, done.stderr)

    def test_sweep(self):
        self.need("sweep")
        self.done(["sweep", "--motor", "motor.toml", "--rpm", "1000,2000", "--json", "out.json"])
        points = json.loads((self.folder / "out.json").read_text())["points"]
        self.assertEqual([1000, 2000], [point["rpm"] for point in points])
        still = self.done(["sweep", "--motor", "motor.toml", "--rpm", "0"]).stdout.decode()
        self.assertRegex(still, r"\n +0 +- ")
        self.assertNotRegex(still, "inf|nan")

    def test_loops_pulse_modes(self):
        self.need("loops")
        self.done(["loops", "--pulse-modes", "--json", "out.json", "-o", "out"])
        drives = json.loads((self.folder / "out.json").read_text())["pulse_modes"]
        self.assertEqual(["2019", "traction_400kw"], [drive["drive"] for drive in drives])
        page = (self.folder / "out" / "index.html").read_text()
        for drive in drives:
            self.assertIn(f"loops-pulse-modes-{drive['drive']}", page)
            self.assertEqual(8, len(drive["modes"]))
            self.assertEqual({mode["mode"] for mode in drive["modes"]}, {point["mode"] for point in drive["points"]})

    def test_loops_extended(self):
        self.need("loops")
        self.done(["loops", "--motor", "motor.toml", "--extended", "motor.toml", "--effect", "resistance:R=1.5", "--json", "out.json"])
        points = json.loads((self.folder / "out.json").read_text())["extended"]
        nominal = [point for point in points if point["belief"] == "nominal"]
        extended = [point for point in points if point["belief"] == "extended"]
        self.assertEqual(len(nominal), len(extended))
        for one, other in zip(nominal, extended):
            self.assertAlmostEqual(one["rms_percent"], other["rms_percent"], delta=0.05)

    def test_reproduce(self):
        self.need("reproduce")
        self.done(["reproduce", "--paper", "2019", "--json", "out.json"])
        rows = json.loads((self.folder / "out.json").read_text())["rows"]
        self.assertTrue(rows and all(row["paper"] == "2019" for row in rows))


if __name__ == "__main__":
    unittest.main(argv=[__file__, "-v"])
