#!/usr/bin/env python3
"""Control cycles a second of the plant and of motulator's simulation, on one core, in one run.

    python/compare_plant_speed.py [--plant PROGRAM] [--write]

Both simulate the drive of the 2019 paper at one speed with carrier comparison; motulator without any effect, under its own current
controller. PROGRAM is plant_cycles, which the build of all tests makes. --write puts the table into docs/plant.md. Needs motulator,
pinned in packages/python/motulator.txt.
"""

import argparse
import math
import pathlib
import re
import subprocess
import sys
import time

import motulator.drive.control.sm as control
from motulator.drive import model
from motulator.drive.utils import SynchronousMachinePars

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))

from marked import with_table  # noqa: E402

DOCUMENT = ROOT / "docs" / "plant.md"

F_PWM_HZ, U_DC_V, OMEGA_E_RAD_S, POLE_PAIRS = 5000.0, 750.0, 942.0, 3
SIMULATED_S, RUNS = 0.1, 5


def motulator_rate():
    """PWM periods in a second of processor time, the best of some runs."""
    best = 0.0
    for _ in range(RUNS):
        par = SynchronousMachinePars(n_p=POLE_PAIRS, R_s=0.75, L_d=5.2e-3, L_q=5.2e-3, psi_f=0.134)
        shaft = model.ExternalRotorSpeed(w_M=lambda t: OMEGA_E_RAD_S / POLE_PAIRS)
        drive = model.Drive(model.VoltageSourceConverter(u_dc=U_DC_V), model.SynchronousMachine(par), shaft)
        drive.pwm = model.CarrierComparison()
        limits = control.CurrentReferenceCfg(par, max_i_s=math.sqrt(2.0) * 10.5, nom_w_m=OMEGA_E_RAD_S)
        controller = control.CurrentVectorControl(par, limits, T_s=0.5 / F_PWM_HZ, sensorless=False)
        controller.ref.tau_M = lambda t: 5.0
        begin = time.process_time()
        model.Simulation(drive, controller).simulate(t_stop=SIMULATED_S)
        best = max(best, SIMULATED_S * F_PWM_HZ / (time.process_time() - begin))
    return best


def plant_rates(program):
    """Name of the drive and its cycles a second, in the program's order."""
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    return {name: float(rate) for name, rate in re.findall(r"^(\S.*?) +(\d+) cycles/s$", printed, re.MULTILINE)}


def table(program):
    theirs = motulator_rate()
    lines = ["| drive | cycles a second | times motulator |", "| --- | ---: | ---: |", f"| motulator 0.5.0, no effect | {theirs:.0f} | 1 |"]
    lines += [f"| {name} | {1e3 * round(rate / 1e3):.0f} | {rate / theirs:.0f} |" for name, rate in plant_rates(program).items()]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plant", default=ROOT / "build" / "host" / "bench" / "plant_cycles")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    made = table(options.plant)
    print(made)
    if options.write:
        DOCUMENT.write_text(with_table(DOCUMENT.read_text(encoding="utf-8"), "speed", made), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
