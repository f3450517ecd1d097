#!/usr/bin/python3
"""Recordings that have voltages only, by other modulators than space vectors: by the second plant.

A leg that does not switch has no dead time. Taken for one that does, it makes v_dead come out a third too small, and what is left looks
like something else. A filter of the currents still sees the last edges: taken for those of another modulator, it is not found at all.

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
                v, off = inverter.leg_voltages(inverter.pulses(still, still, high), np.array([at]), i, 500.0)
                self.assertEqual((v[0, 0], v[1, 0], off[0, 0], off[1, 0]), (0.0, 500.0, False, False))
            # It goes there at a cycle's start, and comes back at one.
            _, off = inverter.leg_voltages(inverter.pulses(still, still, np.zeros((3, 1), bool)), np.array([1e-6]), i, 500.0)
            self.assertEqual(list(off[:, 0]), [False, True, False])
            v, off = inverter.leg_voltages(inverter.pulses(0.4 * still, 0.4 * still, high), np.array([1e-6]), i, 500.0)
            self.assertEqual((off[1, 0], v[1, 0]), (True, 500.0 if current < 0.0 else 0.0))

    def finds_alone(self, drawn, tolerance):
        """The one effect that was drawn, its value to so much of itself, and no other cause."""
        with tempfile.TemporaryDirectory() as folder:
            generate.write(drawn, folder)
            found = blind.diagnose(folder, IQFOC)
        effect = drawn.truth["effects"][0]
        self.assertEqual([c["id"] for c in found["causes"]], [effect["id"]])
        value, true = found["causes"][0]["parameters"][0], effect["parameters"][0]["value"]
        self.assertLess(abs(value["value"] / true - 1.0), tolerance, f"{value} for {true}")

    def test_dead_time_is_not_underestimated(self):
        for name in ("dpwm_min", "dpwm_1", "dpwm_2"):
            with self.subTest(name):
                self.finds_alone(self.draw(510, name), 0.05)

    def test_a_filter_sees_the_edges_that_were(self):
        for name in ("sine", "dpwm_min"):
            with self.subTest(name):
                self.finds_alone(self.draw(511, name, "sensor_lag", 0.15), 0.03)

    @staticmethod
    def draw(seed, name, effect="dead_time", size=0.012):
        kept, motors.DISCONTINUOUS = motors.DISCONTINUOUS, [name]
        try:
            return draw.draw(seed, effect, [size], "discontinuous")
        finally:
            motors.DISCONTINUOUS = kept


if __name__ == "__main__":
    if "--iqfoc" in sys.argv:
        at = sys.argv.index("--iqfoc")
        IQFOC = os.path.abspath(sys.argv[at + 1])
        del sys.argv[at:at + 2]
    unittest.main(argv=sys.argv, verbosity=1)
