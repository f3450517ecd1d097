"""`iqfoc export-fmu`, as a simulator meets it: FMPy loads the FMU, and its currents are those of `iqfoc simulate`.

Run by the Python that has FMPy (.cache/python/fmpy, which ./dev sets up)."""

import contextlib
import csv
import io
import pathlib
import subprocess
import tempfile
import unittest
import zipfile

import fmpy
import fmpy.fmi3
import fmpy.validation
import program

HEADERS = pathlib.Path(fmpy.__file__).parent / "c-code"
SOURCES = program.ROOT / "sim_host/fmu"
CYCLE_S = 1 / 4000  # of program.MOTOR
CURRENTS = ("i_a", "i_b", "i_c")

SCENARIO = """name = "two runs"
[sensors]
current_noise_A = 0.01
angle_noise_rad = 0.001
[log]
duties = true
[[run]]
cycles = 300
speed_rpm = 1000
i_q_A = { value = 3, square = { amplitude = 1, period_s = 0.02 } }
[[run]]
cycles = 300
speed_rpm = { at_s = [0.0, 0.08], ramp = [500, 2500] }
i_d_A = -1
i_q_A = 2
"""

INERTIA = """name = "run up"
[[run]]
cycles = 400
i_q_A = 5
shaft = { J_kgm2 = 0.002, friction_Nms = 0.001, load_Nm = { at_s = [0.0, 0.05], steps = [0.5, 2.0] } }
"""

# Without noise and without settling: duties alone make the currents.
PLAIN = """name = "plain"
[log]
duties = true
[[run]]
cycles = 300
settle_cycles = 0
speed_rpm = 1500
i_d_A = -2
i_q_A = { value = 4, square = { amplitude = 2, period_s = 0.03 } }
"""


class Instance:
    """An FMU in this process, with what it said."""

    def __init__(self, path, folder):
        self.about = fmpy.read_model_description(str(path))
        self.references = {v.name: v.valueReference for v in self.about.modelVariables}
        self.types = {v.name: v.type for v in self.about.modelVariables}
        self.said = []
        place = folder / (path.name + ".d")
        with zipfile.ZipFile(path) as archive:
            archive.extractall(place)
        self.fmu = fmpy.fmi3.FMU3Slave(guid=self.about.guid, unzipDirectory=str(place),
                                       modelIdentifier=self.about.coSimulation.modelIdentifier, instanceName="drive")
        self.log = fmpy.fmi3.fmi3LogMessageCallback(lambda _environment, _status, _category, text: self.said.append(text.decode()))
        self.fmu.instantiate(logMessage=self.log)
        self.time = 0.0

    def begin(self, **values):
        self.set(**values)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, **values):
        for name, value in values.items():
            {"Float64": self.fmu.setFloat64, "Int32": self.fmu.setInt32, "Boolean": self.fmu.setBoolean}[self.types[name]](
                [self.references[name]], [value])

    def get(self, *names):
        values = [{"Float64": self.fmu.getFloat64, "Int32": self.fmu.getInt32}[self.types[name]]([self.references[name]])[0]
                  for name in names]
        return values if len(names) > 1 else values[0]

    def step(self, step_s=CYCLE_S):
        self.fmu.doStep(self.time, step_s)
        self.time += step_s


class Fmu(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        for name, text in {"motor.toml": program.MOTOR, "scenario.toml": SCENARIO, "inertia.toml": INERTIA,
                           "plain.toml": PLAIN}.items():
            (cls.folder / name).write_text(text)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def export(self, name, *more):
        done = program.run(["export-fmu", "--motor", "motor.toml", "-o", name, *more], self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        return self.folder / name

    def open(self, name, *more):
        instance = Instance(self.export(name, *more), self.folder)
        self.addCleanup(instance.fmu.freeInstance)
        return instance

    def simulate(self, scenario, *more):
        done = program.run(["simulate", "--motor", "motor.toml", "--scenario", scenario, "-o", "rec.csv", *more], self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "rec.csv", encoding="utf-8") as file:
            return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(r for r in file if r[0] != "#")]

    def refused(self, instance, call, said):
        with contextlib.redirect_stdout(io.StringIO()), self.assertRaises(Exception):
            call()
        self.assertIn(said, instance.said[-1])

    def assert_row(self, instance, row, tolerance=1e-9):
        """What the sensors read in the cycle that has just ended."""
        for name in CURRENTS:
            for mine, its in (("_A", "_valley_A"), ("_mid_A", "_mid_A")):
                self.assertAlmostEqual(instance.get(name + its), row[name + mine], delta=tolerance)

    def test_fmpy_validates_without_complaint(self):
        for path in (self.export("v1.fmu"), self.export("v2.fmu", "--kind", "plant", "--scenario", "inertia.toml")):
            self.assertEqual(fmpy.validation.validate_fmu(str(path)), [])

    def test_our_interface_is_the_standards(self):
        for source in SOURCES.glob("fmu_*.c"):
            if "fmi3Status" in source.read_text():
                done = subprocess.run(["gcc", "-std=c11", "-fsyntax-only", "-DFMI3_STANDARD_HEADERS", "-I", HEADERS, "-I",
                                       program.ROOT / "sim_host", "-I", program.ROOT / "port/host", "-I", program.ROOT / "include",
                                       "-I", program.ROOT / "tests/target/golden", source], capture_output=True, check=False)
                self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_it_needs_nothing_but_the_c_library(self):
        self.export("w.fmu")
        with zipfile.ZipFile(self.folder / "w.fmu") as archive:
            binary = archive.extract(next(n for n in archive.namelist() if n.endswith(".so")), self.folder)
        dynamic = subprocess.run(["objdump", "-p", binary], capture_output=True, text=True, check=True).stdout
        needed = [line.split()[1].split(".")[0] for line in dynamic.splitlines() if "NEEDED" in line]
        self.assertTrue(needed)
        self.assertLessEqual(set(needed), {"libc", "libm", "ld-linux-x86-64", "ld-linux-aarch64"})

    def test_fmpy_follows_a_scenario_as_simulate_does(self):
        effect = ["--effect", "dead_time", "--seed", "7"]
        rows = self.simulate("scenario.toml", *effect)
        for run in (1, 2):
            path = self.export("s.fmu", "--scenario", "scenario.toml", "--run", run, *effect)
            wanted = [row for row in rows if row["run"] == run]
            got = fmpy.simulate_fmu(str(path), stop_time=len(wanted) * CYCLE_S, step_size=CYCLE_S, output_interval=CYCLE_S,
                                    output=[name + "_valley_A" for name in CURRENTS])
            for k, row in enumerate(wanted):
                for name in CURRENTS:
                    self.assertAlmostEqual(got[name + "_valley_A"][k + 1], row[name + "_A"], delta=1e-9)

    def test_a_shaft_with_inertia_and_load(self):
        fmu = self.open("i.fmu", "--scenario", "inertia.toml")
        fmu.begin()
        for row in self.simulate("inertia.toml"):
            fmu.step()
            self.assert_row(fmu, row)
        self.assertGreater(fmu.get("shaft_rpm"), 50)

    def test_the_plant_makes_the_currents_of_the_duties(self):
        fmu = self.open("p.fmu", "--kind", "plant")
        fmu.begin(speed_rpm=1500.0)
        for row in self.simulate("plain.toml"):
            fmu.set(d_a=row["d_a"], d_b=row["d_b"], d_c=row["d_c"])
            fmu.step()
            self.assert_row(fmu, row)

    def test_references_and_speed_from_outside(self):
        (self.folder / "constant.toml").write_text("[log]\nduties = true\n[[run]]\ncycles = 200\nspeed_rpm = 800\ni_q_A = 4\n")
        fmu = self.open("c.fmu")
        fmu.begin(speed_rpm=800.0, i_q_ref_A=4.0)
        for row in self.simulate("constant.toml"):
            fmu.step()
            self.assert_row(fmu, row)
            self.assertEqual(fmu.get("d_a_force"), row["d_a"])
        self.assertEqual(fmu.get("status") & ~256, 0)
        self.assertAlmostEqual(fmu.get("i_q_mean_A"), 4, delta=0.02)
        # 1.5 p psi i_q, and the part of the saliency at i_d = 0.
        i_d, i_q = fmu.get("i_d_A", "i_q_A")
        self.assertAlmostEqual(fmu.get("torque_Nm"), 1.5 * 3 * (0.2 + (0.008 - 0.011) * i_d) * i_q, delta=1e-9)

    def test_a_ramp_from_outside(self):
        fmu = self.open("r.fmu", "--kind", "plant")
        fmu.begin(speed_rpm=500.0)
        for k in range(100):
            fmu.set(speed_rpm=500.0 + 10 * k, accel_rpm_s=10 / CYCLE_S)
            fmu.step()
        self.assertAlmostEqual(fmu.get("shaft_rpm"), 1500, delta=1e-6)

    def test_any_step_will_do(self):
        fmu = self.open("n.fmu")
        fmu.begin(speed_rpm=800.0, i_q_ref_A=4.0, settle_cycles=20)
        other = self.open("m.fmu")
        other.begin(speed_rpm=800.0, i_q_ref_A=4.0, settle_cycles=20)
        for _ in range(70):
            fmu.step(CYCLE_S / 7)
        for _ in range(4):
            other.step(2.5 * CYCLE_S)
        for name in ("i_a_A", "i_q_A", "theta_e_rad", "i_a_valley_A"):
            self.assertAlmostEqual(fmu.get(name), other.get(name), delta=1e-6)

    def test_parameters_are_the_truths(self):
        by_file = self.open("e.fmu", "--effect", "resistance:R=2.5", "--kind", "plant")
        by_hand = self.open("h.fmu", "--kind", "plant")
        later = self.open("l.fmu", "--kind", "plant")
        by_file.begin(d_a=0.55)
        by_hand.begin(d_a=0.55, R_ohm=2.5)
        later.begin(d_a=0.55)
        self.assertEqual(by_file.get("R_ohm"), 2.5)
        for k in range(300):
            if k == 100:
                later.set(R_ohm=2.5)
            for fmu in (by_file, by_hand, later):
                fmu.step()
            if k == 50:
                self.assertGreater(later.get("i_a_A") - by_hand.get("i_a_A"), 0.2)
        self.assertEqual(by_file.get("i_a_A"), by_hand.get("i_a_A"))
        self.assertAlmostEqual(later.get("i_a_A"), by_hand.get("i_a_A"), delta=1e-3)

    def test_a_state_is_taken_back(self):
        fmu = self.open("k.fmu", "--scenario", "scenario.toml")
        fmu.begin()
        for _ in range(10):
            fmu.step(0.7 * CYCLE_S)
        state, time = fmu.fmu.getFMUState(), fmu.time
        ends = []
        for _ in range(2):
            fmu.fmu.setFMUState(state)
            fmu.time = time
            for _ in range(10):
                fmu.step(0.7 * CYCLE_S)
            ends.append(fmu.get("i_a_A", "i_b_valley_A", "theta_valley_rad"))
        self.assertEqual(*ends)
        fmu.fmu.freeFMUState(state)

    def test_a_reset_starts_from_the_beginning(self):
        fmu = self.open("a.fmu", "--scenario", "scenario.toml")
        ends = []
        for _ in range(2):
            fmu.begin()
            for _ in range(20):
                fmu.step()
            ends.append(fmu.get("i_a_valley_A", "i_b_A"))
            fmu.fmu.reset()
            fmu.time = 0.0
        self.assertEqual(*ends)

    def test_what_no_drive_can_have_is_refused(self):
        fmu = self.open("x.fmu")
        self.refused(fmu, lambda: fmu.set(i_q_ref_A=float("nan")), "i_q_ref_A must be a finite number")
        self.refused(fmu, lambda: fmu.set(follow_scenario=True), "exported without a scenario")
        self.refused(fmu, lambda: fmu.set(cycle_s=1.0), "cycle_s cannot be set now")
        self.refused(fmu, lambda: fmu.fmu.getFloat64([999]), "value reference 999")
        self.refused(fmu, lambda: fmu.fmu.setFloat64([fmu.references["seed"]], [1.0]), "no variable of this type")
        fmu.begin(i_q_ref_A=3.0)
        self.refused(fmu, lambda: fmu.set(L_d_H=-1.0), "L_d")
        self.refused(fmu, lambda: fmu.set(seed=3), "seed cannot be set now")
        fmu.step()
        fmu.set(i_q_ref_A=1e3, u_dc_V=5e4)
        self.refused(fmu, lambda: [fmu.step() for _ in range(200)], "the firmware stopped the drive")

    def test_a_call_that_would_not_return_is_refused(self):
        fmu = self.open("e.fmu")
        endless = (float("inf"), float("nan"), 1e300, 1e9 * CYCLE_S)
        for start in endless[:2]:
            self.refused(fmu, lambda at=start: fmu.fmu.enterInitializationMode(startTime=at), "the start time must be a finite number")
        self.refused(fmu, lambda: fmu.set(settle_cycles=20000000), "settle_cycles must be at most ten million")
        fmu.begin(i_q_ref_A=3.0)
        fmu.step()
        for step in endless:
            self.refused(fmu, lambda by=step: fmu.fmu.doStep(fmu.time, by), "a step must")
            self.refused(fmu, lambda at=step: fmu.fmu.doStep(at, CYCLE_S), "a step must")
        before = fmu.get("i_a_A")
        fmu.step()
        self.assertNotEqual(before, fmu.get("i_a_A"))

    def test_another_fmus_token_is_refused(self):
        path = self.export("t.fmu")
        about = fmpy.read_model_description(str(path))
        self.assertNotEqual(about.guid, fmpy.read_model_description(str(self.export("u.fmu", "--seed", "2"))).guid)
        said = []
        log = fmpy.fmi3.fmi3LogMessageCallback(lambda _environment, _status, _category, text: said.append(text.decode()))
        place = self.folder / "t.d"
        with zipfile.ZipFile(path) as archive:
            archive.extractall(place)
        fmu = fmpy.fmi3.FMU3Slave(guid="{other}", unzipDirectory=str(place), modelIdentifier="iqfoc", instanceName="drive")
        with contextlib.redirect_stdout(io.StringIO()), self.assertRaises(Exception):
            fmu.instantiate(logMessage=log)
        self.assertIn("token", said[-1])

    def test_the_golden_hash(self):
        fmu = self.open("g.fmu")
        reference = fmu.references["golden_hash"]
        self.assertEqual(f"golden {fmu.fmu.getUInt64([reference])[0]:016x}", program.run(["golden"], self.folder).stdout.decode().strip())
        self.refused(fmu, lambda: fmu.fmu.setUInt64([reference], [1]), "golden_hash cannot be set now")
        self.refused(fmu, lambda: fmu.fmu.getUInt64([fmu.references["seed"]]), "no variable of this type")

    def test_the_same_input_makes_the_same_file(self):
        self.assertEqual(self.export("one.fmu").read_bytes(), self.export("two.fmu").read_bytes())

    def test_to_a_pipe(self):
        done = program.run(["export-fmu", "--motor", "motor.toml", "-o", "/dev/stdout"], self.folder)
        self.assertEqual((0, self.export("file.fmu").read_bytes()), (done.returncode, done.stdout), done.stderr)

    def test_bad_usage(self):
        for arguments, said in (
                (["--kind", "bus", "-o", "z.fmu"], "--kind expects plant or drive"),
                (["--scenario", "scenario.toml", "--run", "3", "-o", "z.fmu"], "there is no run 3; the last is 2"),
                (["--run", "2", "-o", "z.fmu"], "--run 2 selects a run of a scenario"),
                (["--effect", "dead_tim", "-o", "z.fmu"], "dead_tim")):
            done = program.run(["export-fmu", "--motor", "motor.toml", *arguments], self.folder)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertIn(said, done.stderr.decode())
            self.assertEqual(len(done.stderr.splitlines()), 1)
            self.assertFalse((self.folder / "z.fmu").exists())


if __name__ == "__main__":
    unittest.main(argv=["fmu"])
