"""What `iqfoc tune` writes: the JSON's keys, the firmware's header through compilers, the page; and what it refuses, with the number."""

import json
import math
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import program

WARNINGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]

FIRMWARE = """#include "iqfoc_tuned.h"
#include <stdio.h>
static const iqfoc_tuned_law_t law = IQFOC_TUNED_LAW;
static const iqfoc_observer_config_t observer = IQFOC_TUNED_OBSERVER;
static const iqfoc_speed_control_config_t speed = IQFOC_TUNED_SPEED;
static const iqfoc_tracker_config_t tracker = IQFOC_TUNED_TRACKER;
int main(void)
{
    printf("%d %d %d %d %d %d", (int)law.machine.k_d_q26, (int)law.machine.q_to_d_q27, (int)law.keep, (int)law.follow,
           (int)law.learn, (int)law.learn_offset);
    printf(" %d %d %d %d %d", (int)observer.k1, (int)observer.k2, (int)observer.gain_max, (int)observer.speed_min,
           (int)observer.flux_max);
    printf(" %d %d %d %d %d %d", (int)speed.kp_q16, (int)speed.share, (int)speed.ramp_q32, (int)speed.i_ramp, (int)speed.cycles,
           (int)tracker.k1);
    return 0;
}
"""

WATCH = """#include "iqfoc_tuned.h"
#include <stdio.h>
static const iqfoc_watch_config_t config = IQFOC_TUNED_WATCH;
int main(void)
{
    printf("%d %d %d %d", (int)config.per_noise_q8, (int)config.unsure_q16[0], (int)config.unsure_q16[1], (int)config.unsure_q16[2]);
    return 0;
}
"""


class Tune(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        program.write_files(self.folder)

    def tearDown(self):
        self.temporary.cleanup()

    def refused(self, *arguments):
        result = program.run(["tune", *arguments], self.folder)
        self.assertEqual(2, result.returncode)
        lines = result.stderr.decode().splitlines()
        self.assertEqual(1, len(lines), lines)
        return lines[0]

    def test_what_it_writes(self):
        done = program.run(["tune", "--motor", "motor.toml", "--method", "deadbeat", "--drives", "4", "--inertia", "1e-3", "-o", "tuned", "--json",
                            "tuned/tune.json"], self.folder)
        self.assertEqual(0, done.returncode, done.stderr.decode())
        tuned = self.folder / "tuned"
        result = json.loads((tuned / "tune.json").read_text())
        self.assertEqual("deadbeat", result["method"])
        self.assertGreater(result["bandwidth_rad_s"], 100.0)
        self.assertIn("disk margin", result["limited_by"])
        for point in result["points"]:
            for key in ("rpm", "sffr", "disk_margin", "gain_margin_dB", "phase_margin_deg", "delay_margin_cycles", "poles"):
                self.assertIn(key, point)
            self.assertGreaterEqual(point["disk_margin"], 0.499)
            self.assertTrue(all(re * re + im * im < 1.0 for re, im in point["poles"]))
        self.assertEqual(0, result["trial"]["unstable"])
        self.check_observer(result)
        self.check_speed(result["speed"])
        self.check_header(tuned, result)
        page = (tuned / "index.html").read_text()
        for text in (re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL), done.stdout.decode()):
            self.assertNotRegex(text, r"(?<![a-z.])(nan|inf)(?![a-z])")
        self.assertEqual(5, page.count('class="charts'))
        self.assertIn("Speed control", page)

    def check_observer(self, result):
        """The bandwidth is that of the run-up's lag; a lower one has the larger margin and less noise; the plant has the same angle error."""
        observer = result["observer"]
        turns = max(point["rpm"] for point in result["points"]) / 60 * 3 / result["f_pwm_Hz"]
        acceleration = turns / (observer["run_up_s"] * result["f_pwm_Hz"])
        self.assertAlmostEqual(2 / 360, acceleration / (observer["bandwidth_rad_s"] / result["f_pwm_Hz"]) ** 2, places=6)
        self.assertEqual(16, len(observer["points"]))
        for point in observer["points"]:
            self.assertLess(point["disk_margin"], point["disk_margin_nominal"])
            self.assertGreater(point["angle_noise_deg"], 0)
            self.assertRegex(point["worst_machine"], "R .*psi_f .*voltage [+-]2 %")
        noise = [choice["angle_noise_deg"] for choice in observer["choices"]]
        self.assertEqual(sorted(noise), noise)
        run_up = [choice["run_up_s"] * choice["bandwidth_rad_s"] ** 2 for choice in observer["choices"]]
        self.assertLess(max(run_up) / min(run_up), 1 + 1e-9)
        trial = observer["trial"]
        self.assertEqual((4, 0, 0), (trial["drives"], trial["unstable"], trial["lost"]))
        self.assertLess(trial["off_deg"], 0.3)
        self.assertGreater(trial["predicted_deg"], 0.3)

    def check_speed(self, speed):
        """The margin is the wanted one, and the plant has the predicted dip."""
        self.assertAlmostEqual(0.5, speed["disk_margin"], places=3)
        self.assertAlmostEqual(1.0, speed["trial"][1]["dip_rpm"] / speed["dip_rpm"], delta=0.05)
        self.assertEqual([(0, False)] * 3, [(one["status"], one["lost"]) for one in speed["trial"]])

    def check_header(self, folder, result):
        (folder / "firmware.c").write_text(FIRMWARE)
        compilers = [name for name in ("gcc", "clang", "cc") if shutil.which(name)]
        self.assertTrue(compilers)
        for compiler in compilers:
            made = subprocess.run([compiler, *WARNINGS, "-I", program.ROOT / "include", folder / "firmware.c", "-o",
                                   folder / "firmware"], capture_output=True, text=True, check=False)
            self.assertEqual((0, ""), (made.returncode, made.stderr))
        held = [int(word) for word in subprocess.run([folder / "firmware"], capture_output=True, check=True).stdout.split()]
        machine, controller = result["machine"], result["controller"]
        k_d = 565.0 / 4000.0 / (machine["L_d_H"] * 6.0 * 2.0 ** 0.5)
        want = [k_d * 2 ** 26, machine["L_q_H"] / machine["L_d_H"] * 2 ** 27,
                *(controller[key] * 2 ** 24 for key in ("keep", "follow", "learn", "learn_offset"))]
        observer = result["observer"]
        pole = 1 / (1 + observer["bandwidth_rad_s"] / 4000.0)
        psi = machine["psi_f_Wb"] * 4000.0 / 565.0
        want += [value * 2 ** 24 for value in (1 - pole ** 2, (1 - pole) ** 2, observer["gain_max"], observer["turns_min"],
                                               observer["flux_max"] * psi)]
        speed = result["speed"]
        pole = 1 / (1 + speed["bandwidth_rad_s"] * speed["cycles"] / 4000.0)
        a = 1.5 * 9 * machine["psi_f_Wb"] * 6.0 * 2.0 ** 0.5 / (2 * math.pi * 1e-3) / 4000.0 ** 2
        ramp = speed["ramp_rpm_s"] / 60 * 3 / 4000.0 ** 2
        want += [2 * (1 - pole) / (a * speed["cycles"]) * 2 ** 16, (1 - pole) / 2 * 2 ** 24, ramp * speed["cycles"] * 2 ** 32,
                 ramp / a * 2 ** 24, speed["cycles"], (1 - 1 / (1 + speed["tracker_rad_s"] / 4000.0) ** 3) * 2 ** 24]
        self.assertEqual(len(want), len(held))
        for got, value in zip(held, want):
            self.assertAlmostEqual(value, got, delta=1.0)

    def test_no_magnet_no_observer(self):
        (self.folder / "weak.toml").write_text(program.MOTOR.replace("psi_f_Wb = 0.2", "psi_f_Wb = 0.001"))
        done = program.run(["tune", "--motor", "weak.toml", "--drives", "1", "-o", "weak", "--json", "weak/t.json"], self.folder)
        self.assertEqual(0, done.returncode, done.stderr.decode())
        self.assertIn("no observer, as the magnet's flux is too small", done.stdout.decode())
        self.assertIsNone(json.loads((self.folder / "weak/t.json").read_text())["observer"])
        self.assertIn("No observer (iqfoc/observer.h)", (self.folder / "weak/iqfoc_tuned.h").read_text())
        self.assertIn("No observer", (self.folder / "weak/index.html").read_text())

    def test_a_diagnosis_brings_the_watch(self):
        """Noise and region of the diagnosis are the watch's constants in the header; without them it says why it has none."""
        variances = [0.9e-2, 0.8e-4, 1.1e-4, 0.2e-2]
        told = {"verdict": "clean", "causes": [], "error": {"sensor_noise_A": 0.02},
                "covariance": {"names": ["R", "L_d", "L_q", "psi_f"],
                               "matrix": [[value ** 2 if k == n else 0.0 for n in range(4)] for k, value in enumerate(variances)]}}
        (self.folder / "d.json").write_text(json.dumps(told))
        (self.folder / "watch.c").write_text(WATCH)
        done = program.run(["tune", "--motor", "motor.toml", "--diagnosis", "d.json", "--drives", "1", "-o", "tuned"], self.folder)
        self.assertEqual(0, done.returncode, done.stderr.decode())
        subprocess.run(["gcc", *WARNINGS, "-I", program.ROOT / "include", "-I", self.folder / "tuned", self.folder / "watch.c", "-o",
                        self.folder / "watch"], check=True)
        per_noise, *unsure = [int(word) for word in subprocess.run([self.folder / "watch"], capture_output=True, check=True).stdout.split()]
        self.assertAlmostEqual(256 * 6.0 * 2 ** 0.5 / (0.02 * (5 / 3) ** 0.5), per_noise, delta=1.0)
        # Of three parameters the ellipsoid goes to 2.796 deviations, of psi_f alone 1.96.
        for got, want in zip(unsure, (0.01 * 2.796 / 0.1, 0.01 * 2.796 / 0.05, 0.01 * 1.96 / 0.02)):
            self.assertAlmostEqual(want * 65536, got, delta=70.0)
        done = program.run(["watch", "--motor", "motor.toml", "--diagnosis", "d.json", "--trials", "1", "--cycles", "1e3"], self.folder)
        self.assertEqual(0, done.returncode, done.stderr.decode())
        self.assertNotIn("nan", done.stdout.decode())
        program.run(["tune", "--motor", "motor.toml", "--drives", "1", "-o", "untold"], self.folder)
        self.assertIn("No change detector", (self.folder / "untold" / "iqfoc_tuned.h").read_text())
        (self.folder / "mute.json").write_text('{"verdict": "clean", "causes": []}')
        done = program.run(["watch", "--motor", "motor.toml", "--diagnosis", "mute.json"], self.folder)
        self.assertEqual((2, 1), (done.returncode, len(done.stderr.decode().splitlines())))
        self.assertIn("noise of the current sensors is unknown", done.stderr.decode())

    def test_a_diagnosis_without_a_covariance_is_named_so(self):
        (self.folder / "d.json").write_text('{"verdict": "clean", "causes": []}')
        done = program.run(["tune", "--motor", "motor.toml", "--diagnosis", "d.json", "--drives", "1"], self.folder)
        self.assertEqual(0, done.returncode, done.stderr.decode())
        self.assertIn("has neither covariance nor intervals", done.stdout.decode())

    def test_what_cannot_be_had_is_said_with_the_number(self):
        slow = program.MOTOR.replace("f_pwm_Hz = 4000", "f_pwm_Hz = 850")
        (self.folder / "slow.toml").write_text(slow)
        self.assertIn("at least 3 are needed: f_pwm_Hz = 900", self.refused("--motor", "slow.toml"))
        self.assertRegex(self.refused("--motor", "motor.toml", "--ratio", "4", "--tolerance", "30,60,5"), r"the best is 0\.\d\d")

    def test_bad_usage(self):
        self.assertIn("expected pi or deadbeat", self.refused("--motor", "motor.toml", "--method", "fast"))
        self.assertIn("needs three numbers, for R, L and psi_f; it has 2", self.refused("--motor", "motor.toml", "--tolerance", "30,30"))
        self.assertIn("motor.toml", self.refused("--motor", "motor.toml", "--diagnosis", "motor.toml"))


if __name__ == "__main__":
    unittest.main(argv=["tune.py"])
