#!/usr/bin/env python3
"""What a control cycle of the plant costs in instructions, which no slow or busy machine changes.

    bench/plant/cost.py PLANT_CYCLES

PLANT_CYCLES is the program made of plant_cycles.c, optimised. Valgrind counts; of two runs of different length the difference is the
cycles' own.
"""

import re
import subprocess
import sys
import unittest

CYCLES = 500


def instructions(drive, cycles):
    run = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", sys.argv[1], drive, str(cycles)],
                         check=True, capture_output=True, text=True)
    return int(re.search(r"Collected : (\d+)", run.stderr).group(1))


def per_cycle(drive):
    cost = (instructions(drive, 2 * CYCLES) - instructions(drive, CYCLES)) / CYCLES
    print(f"{drive:28} {cost:8.0f} instructions a cycle")
    return cost


class Cost(unittest.TestCase):
    """Measured 14941 and 264716, and 1.36 times the cost with a filter."""

    def test_linear_path(self):
        self.assertLess(per_cycle("given speed"), 18000)

    def test_the_slowest(self):
        """It is what the blind tests take longest for."""
        self.assertLess(per_cycle("dead time, drops, saturation"), 320000)

    def test_current_filter_is_an_exact_step(self):
        """The drive stays on the linear path, whatever the bandwidth."""
        without = per_cycle("given speed")
        for drive in ("current filter, 20 kHz", "current filter, 1 MHz"):
            self.assertLess(per_cycle(drive), 1.6 * without)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
