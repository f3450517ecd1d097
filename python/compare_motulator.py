#!/usr/bin/env python3
"""motulator's current controller, the library's plain PI and the tuned controllers on one plant, side by side.

    python/compare_motulator.py [--iqfoc PROGRAM] [--write]

At 5, 8, 10 and 20 control cycles a turn the drive of the 2019 paper turns at one speed, and i_q steps from 30 % to 70 % of the rated peak:
what `iqfoc tune` compares its controllers by. motulator's CurrentVectorControl keeps its own gains and its own compensation of the delay;
the currents asked for are given to it, and the bandwidth is its default, and once that of the design. Gain and phase margin: by how much
the voltage may be more, or turned, until the current leaves its place by a quarter of rated; of the plain PI and of motulator tried in the
plant, of the tuned controllers by their loop's poles.

--write puts the table into docs/tune.md. Needs the package with its extra: ./python[motulator].
"""

import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import iqfoc
from iqfoc.motulator import drive_plant, machine_parameters

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))

from marked import with_table  # noqa: E402

MOTOR = ROOT / "data" / "motors" / "jarzebowicz2019.toml"
DOCUMENT = ROOT / "docs" / "tune.md"

RATIOS = (5, 8, 10, 20)
# As sim_host/loops/closed_loop.h and sim_host/tune/tune_trial.c have them.
SETTLE_CYCLES, TRANSIENT_CYCLES, SETTLED = 200, 120, 0.05
STEP_FROM, STEP_TO = 0.3, 0.7
SHARES = {"nominal": 1.0, "L low": 0.7, "L high": 1.3}
# motulator's CurrentVectorControl: 2 pi 200 rad/s where nothing is said.
THEIR_BANDWIDTH = 2 * math.pi * 200
TRIPS = 3.0
# Of the margins: cycles until the current is judged, of them the last, and how far it may be from where it usually is, of rated.
MARGIN_CYCLES, MARGIN_WINDOW, LEAVES = 700, 100, 0.25


def motor_at(ratio, rpm, share):
    """The drive with the switching frequency of this ratio at this speed, its inductances times a share."""
    base = iqfoc.Motor(MOTOR)
    return base.replace(n_max_rpm=rpm, f_pwm_Hz=ratio * rpm / 60.0 * base.pole_pairs, L_d_H=share * base.L_d_H, L_q_H=share * base.L_q_H)


class Inverter:
    """A plant whose inverter scales or rotates the commanded voltage."""

    def __init__(self, plant, gain=1.0, angle=0.0):
        self.plant, self.motor, self._factor = plant, plant.motor, gain * np.exp(1j * angle)

    def cycle(self, duties):
        if self._factor != 1.0:
            turn = np.exp(2j * math.pi / 3.0 * np.arange(3))
            vector = self._factor * 2.0 / 3.0 * np.dot(duties, turn)
            legs = np.real(vector * np.conj(turn))
            duties = np.clip(legs - 0.5 * (legs.max() + legs.min()) + 0.5, 0.0, 1.0)
        return self.plant.cycle(duties)


def under_motulator(inverter, believed, bandwidth, i_q_A, cycles):
    """Mean currents of each cycle under their control system, its current reference given: i_q_A(k)."""
    from motulator.drive.control.sm import CurrentVectorControl

    control = CurrentVectorControl(machine_parameters(believed), None, T_s=believed.T_s, alpha_c=bandwidth, sensorless=False)

    class Given:
        """In place of their torque's reference."""

        def output(self, _, ref):
            ref.i_s = 1j * i_q_A(round(ref.t / believed.T_s))
            return ref

        def update(self, *_):
            pass

    control.current_reference, control.ref.tau_M = Given(), lambda t: 0.0
    run = drive_plant(control, inverter, cycles)
    return run["i_d_A"] + 1j * run["i_q_A"]


def under_firmware(inverter, believed, feedback, i_q_A, cycles):
    """The same under the library's cycle."""
    cycle, duties, mean = iqfoc.Cycle(believed, feedback=feedback), (0.5, 0.5, 0.5), []
    for k in range(cycles):
        cycle.reference(0.0, i_q_A(k))
        # The cycle's samples are those of the cycle that its duties act in: as they come.
        valley, peak, means = inverter.cycle(duties)
        cycle.valley(valley)
        duties = cycle.peak(peak).duties
        mean.append(complex(*means.i_dq_A))
    return np.array(mean)


def started(truth, rpm, gain=1.0, angle=0.0):
    plant = iqfoc.Drive(truth).plant()
    plant.set_speed(2.0 * math.pi * rpm / 60.0 * truth.pole_pairs)
    return Inverter(plant, gain, angle)


def step(controller, truth, rpm, ratio):
    """(rms error, overshoot, settling): percent of rated, percent of the step, cycles or None; None where a drive would trip."""
    rated = truth.I_base_A
    turns = 1.0 / ratio
    cycles = SETTLE_CYCLES + TRANSIENT_CYCLES + round(max(1, round(100 * turns)) / turns)

    def asked(k):
        return rated * (STEP_FROM if k < SETTLE_CYCLES else STEP_TO)

    mean = controller(started(truth, rpm), asked, cycles) / rated
    if np.abs(mean).max() > TRIPS:
        return None
    error = mean[SETTLE_CYCLES:] - 1j * STEP_TO
    off, steady = np.abs(error), error[TRANSIENT_CYCLES:]
    outside = np.flatnonzero(off[:TRANSIENT_CYCLES] > SETTLED)
    settling = int(outside[-1]) + 1 if len(outside) else 0
    return (100.0 * math.sqrt(np.mean(np.abs(steady) ** 2)), 100.0 * max(0.0, error.imag[:TRANSIENT_CYCLES].max() / (STEP_TO - STEP_FROM)),
            settling if settling < TRANSIENT_CYCLES else None)


def settled(controller, truth, rpm, gain=1.0, angle=0.0):
    """The last cycles' currents at half of the rated one, over it."""
    asked_A = 0.5 * truth.I_base_A
    return controller(started(truth, rpm, gain, angle), lambda _: asked_A, MARGIN_CYCLES)[-MARGIN_WINDOW:] / truth.I_base_A


def border(is_beyond, low, high):
    """Where it begins: low is not, high is taken to be."""
    for _ in range(7):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if is_beyond(middle) else (middle, high)
    return 0.5 * (low + high)


def margins(controller, truth, rpm):
    """(gain in dB upwards, degrees to the nearer side) in words; a loop that does not hold has none."""
    usual = settled(controller, truth, rpm)
    usual_mean = usual.mean()

    def leaves(gain, angle):
        return float(np.abs(settled(controller, truth, rpm, gain, angle) - usual_mean).max()) > LEAVES

    if np.abs(usual - usual_mean).max() > LEAVES:
        return "-", "-"
    gain_dB = border(lambda dB: leaves(10.0 ** (dB / 20.0), 0.0), 0.0, 20.0)
    angle = min(border(lambda degrees: leaves(1.0, sign * math.radians(degrees)), 0.0, 120.0) for sign in (-1.0, 1.0))
    return f"{gain_dB:.1f}", f"{angle:.0f}"


def tuned(program, motor, *more):
    """The JSON of `iqfoc tune`."""
    with tempfile.TemporaryDirectory() as folder:
        path, out = pathlib.Path(folder) / "motor.toml", pathlib.Path(folder) / "tune.json"
        motor.write(path)
        subprocess.run([program, "tune", "--motor", path, "--drives", "1", "--json", out, *more], check=True, capture_output=True)
        return json.loads(out.read_text(encoding="utf-8"))


def designed(program, motor):
    """What `iqfoc tune` says of the tuned controllers: bandwidth, and the nominal loop's margins at n_max."""
    found = tuned(program, motor)
    nominal = found["points"][-1]["nominal"]
    return found["bandwidth_rad_s"], (nominal["gain_margin_dB"], nominal["phase_margin_deg"])


def compared(program):
    """`iqfoc tune`'s own comparison, by ratio, controller and truth; and its speed."""
    comparison = tuned(program, iqfoc.Motor(MOTOR), "--ratio", "5")["comparison"]
    return comparison["rpm"], {(round(loop["sffr"]), loop["controller"], loop["truth"]): loop for loop in comparison["loops"]}


def cells(measured):
    if measured is None:
        return ["trips", "-", "-"]
    rms, overshoot, settling = measured
    return [f"{rms:.3g}", f"{overshoot:.0f}", "-" if settling is None else str(settling)]


def of_program(loop):
    if loop["outcome"] == "trips":
        return ["trips", "-", "-"]
    unstable = " unstable" if loop["outcome"] == "unstable" else ""
    settling = loop["settling_cycles"]
    return [f"{loop['rms_percent']:.3g}{unstable}", f"{loop['overshoot_percent']:.0f}", "-" if settling is None else str(settling)]


def rows_at(ratio, program, rpm, loops):
    """The table's rows at a ratio: controller, three cells for each truth, two margins."""
    truths = {truth: motor_at(ratio, rpm, share) for truth, share in SHARES.items()}
    believed = truths["nominal"]
    bandwidth, tuned_margins = designed(program, believed)

    def motulator(wide):
        return lambda inverter, asked, cycles: under_motulator(inverter, believed, wide, asked, cycles)

    def firmware(feedback):
        return lambda inverter, asked, cycles: under_firmware(inverter, believed, feedback, asked, cycles)

    rows = []
    for words, controller in ((f"motulator, {THEIR_BANDWIDTH:.0f} rad/s", motulator(THEIR_BANDWIDTH)),
                              (f"motulator, {bandwidth:.0f} rad/s", motulator(bandwidth))):
        measured = [cell for truth in truths.values() for cell in cells(step(controller, truth, rpm, ratio))]
        rows.append([words, *measured, *margins(controller, believed, rpm)])
    for key, words, controller in (("pi_midpoint", "PI, mid-point sample", firmware("midpoint")),
                                   ("pi_mean", "PI, quasi-discrete mean", firmware("quasi_discrete_mean"))):
        measured = [cell for truth in truths for cell in of_program(loops[ratio, key, truth])]
        rows.append([words, *measured, *margins(controller, believed, rpm)])
    for key, words in (("tuned_pi", "tuned PI"), ("tuned_deadbeat", "tuned deadbeat")):
        measured = [cell for truth in truths for cell in of_program(loops[ratio, key, truth])]
        rows.append([words, *measured, f"{tuned_margins[0]:.1f}", f"{tuned_margins[1]:.0f}"])
    return rows


def table(program):
    heads = ["SFFR", "controller"]
    for truth in SHARES:
        heads += [f"{truth}: rms error, %", "overshoot, %", "settling, cycles"]
    heads += ["gain margin, dB", "phase margin, deg"]
    lines = ["| " + " | ".join(heads) + " |", "| " + " | ".join("---" if head == "controller" else "---:" for head in heads) + " |"]
    rpm, loops = compared(program)
    for ratio in RATIOS:
        lines += [f"| {ratio} | " + " | ".join(row) + " |" for row in rows_at(ratio, program, rpm, loops)]
    return f"All turn at {rpm:g} rpm.\n\n" + "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--iqfoc", default=os.environ.get("IQFOC", ROOT / "build" / "host" / "iqfoc"))
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    made = table(str(options.iqfoc))
    print(made)
    if options.write:
        DOCUMENT.write_text(with_table(DOCUMENT.read_text(encoding="utf-8"), "motulator", made), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
