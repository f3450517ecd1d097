#!/usr/bin/python3
"""Dead time in recordings that have voltages only, by modulators that hold a leg at a rail: by the second plant.

A leg that does not switch has no dead time. Taken for one that does, it makes v_dead come out a third too small, and what is left looks
like something else.

Usage: tests/blind/modulators.py [--iqfoc PATH]
"""

import os
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import draw
import generate
import motors
import run as blind
import second_drive
from second_plant import Inverter, phases_from_vector

IQFOC = os.path.join(blind.ROOT, "build", "host", "iqfoc")


class Modulators(unittest.TestCase):
    def test_duties_are_those_of_the_voltage_with_a_leg_at_a_rail(self):
        u = 200.0 * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False))
        for name in second_drive.COMMON:
            duty = second_drive.duties(u, 560.0, 10 ** 9, name)
            made = 560.0 * (duty - duty.mean(axis=0))
            np.testing.assert_allclose(made, phases_from_vector(u), atol=1e-5)
            held = (np.minimum(duty, 1.0 - duty).min(axis=0) < 1e-8).mean()
            self.assertAlmostEqual(held, 1.0 if name in motors.DISCONTINUOUS else 0.0, places=2, msg=name)

    def test_a_leg_that_is_held_has_no_dead_time(self):
        inverter = Inverter(1, 1e-4, 2e-6)
        still, high = np.array([[0.0], [1.0], [0.3]]), np.array([[False], [True], [False]])
        for current in (-5.0, 5.0):
            i = np.full((3, 1), current)
            for at in (1e-6, 36e-6, 51e-6, 66e-6, 99e-6):
                v, off = inverter.leg_voltages(np.array([at]), still, still, i, 500.0, high)
                self.assertEqual((v[0, 0], v[1, 0], off[0, 0], off[1, 0]), (0.0, 500.0, False, False))
            # It goes there at a cycle's start, and comes back at one.
            _, off = inverter.leg_voltages(np.array([1e-6]), still, still, i, 500.0, np.zeros((3, 1), bool))
            self.assertEqual(list(off[:, 0]), [False, True, False])
            v, off = inverter.leg_voltages(np.array([1e-6]), 0.4 * still, 0.4 * still, i, 500.0, high)
            self.assertEqual((off[1, 0], v[1, 0]), (True, 500.0 if current < 0.0 else 0.0))

    def test_dead_time_is_not_underestimated(self):
        for name in ("dpwm_min", "dpwm_1", "dpwm_2"):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                drawn = self.draw(510, name)
                generate.write(drawn, folder)
                found = blind.diagnose(folder, IQFOC)
                self.assertEqual([c["id"] for c in found["causes"]], ["dead_time"])
                v_dead = found["causes"][0]["parameters"][0]
                true_V = drawn.truth["effects"][0]["parameters"][0]["value"]
                self.assertLess(abs(v_dead["value"] / true_V - 1.0), 0.05, f"{v_dead} for {true_V}")

    @staticmethod
    def draw(seed, name):
        kept, motors.DISCONTINUOUS = motors.DISCONTINUOUS, [name]
        try:
            return draw.draw(seed, "dead_time", [0.012], "discontinuous")
        finally:
            motors.DISCONTINUOUS = kept


if __name__ == "__main__":
    if "--iqfoc" in sys.argv:
        at = sys.argv.index("--iqfoc")
        IQFOC = os.path.abspath(sys.argv[at + 1])
        del sys.argv[at:at + 2]
    unittest.main(argv=sys.argv, verbosity=1)
