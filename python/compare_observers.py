#!/usr/bin/env python3
"""The library's observer, an extended Kalman filter and motulator's observer over the same recordings: the error of the angle.

    python/compare_observers.py [--iqfoc PROGRAM]

The recordings come from motulator's machine and inverter, advanced from edge to edge (tests/blind/third_plant.py), with dead time and a
sensor of 12 bit. The machine is that of the 2019 paper at 8000 rpm; the carrier's frequency is the one that the ratio asks for. The
current goes between 25 and 75 % of the rated one within 20 cycles, by a voltage computed in advance: no observer is in the loop. Each observer gets the
true parameters and the recorded voltage without the loss of the legs. The filter and motulator's observer begin at the true angle.

Runs in the environment of `./dev tools motulator`. docs/sensorless.md has the table (tools/generators/observers.py).
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
from types import SimpleNamespace

import numpy as np
from motulator.common.model import CarrierComparison
from motulator.drive import model
from motulator.drive.control.sm import Observer, ObserverCfg
from motulator.drive.utils import SynchronousMachinePars

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "blind"))

from third_plant import half_period  # noqa: E402

RATIOS = (5, 8, 10, 12.5, 20)
MACHINES = {"L_q = L_d": 1.0, "L_q = 1.5 L_d": 1.5}
CYCLES, STEP_CYCLES, RAMP_CYCLES, LAST = 600, 100, 20, 400
LOW, HIGH = 0.25, 0.75  # of the rated current
POLE_PAIRS, R, L_D, PSI, RATED_A, LINK_V, RPM = 3, 0.75, 5.2e-3, 0.134, 10.5 * np.sqrt(2.0), 750.0, 8000.0
OMEGA = 2.0 * np.pi * RPM / 60.0 * POLE_PAIRS
NOISE_A, LSB_A, DEAD = 0.005 * RATED_A, 60.0 / 4096, 0.005
LOST_DEG = 60.0
LEGS = np.exp(2j * np.pi / 3 * np.arange(3))


def vector(phases):
    return 2.0 / 3.0 * np.dot(phases, LEGS)


def phases(x):
    return np.real(np.asarray(x)[..., None] * np.conj(LEGS))


def recorded(ratio, saliency):
    """Currents at the valleys and peaks, commanded voltages and true angles of one run."""
    T_s = 2.0 * np.pi / (OMEGA * ratio)
    L_q, rng = saliency * L_D, np.random.default_rng([31, round(10 * ratio), round(10 * saliency)])
    high = np.arange(-RAMP_CYCLES, CYCLES) // STEP_CYCLES % 2
    i_q = RATED_A * (LOW + (HIGH - LOW) * np.convolve(high, np.full(RAMP_CYCLES, 1.0 / RAMP_CYCLES), "valid"))
    theta = OMEGA * T_s * np.arange(CYCLES + 1)
    flux = (PSI + 1j * L_q * i_q) * np.exp(1j * theta)
    middle = 0.5 * (i_q[1:] + i_q[:-1]) * 1j * np.exp(1j * (theta[:-1] + 0.5 * OMEGA * T_s))
    u = (flux[1:] - flux[:-1]) / T_s + R * middle
    par = SynchronousMachinePars(n_p=POLE_PAIRS, R_s=R, L_d=L_D, L_q=L_q, psi_f=PSI)
    drive = model.Drive(model.VoltageSourceConverter(LINK_V), model.SynchronousMachine(par, None, PSI + 1j * L_q * i_q[0]),
                        model.ExternalRotorSpeed(lambda _: OMEGA / POLE_PAIRS))
    drive.pwm = CarrierComparison(N=2 ** 13, return_complex=False)
    drive.legs, drive.commanded, drive.late = np.zeros(3, int), np.zeros(3, int), []
    rows = SimpleNamespace(T_s=T_s, i=np.empty((CYCLES, 3)), i_mid=np.empty((CYCLES, 3)), u=np.empty(CYCLES, complex), theta=theta[:-1])
    for k in range(CYCLES):
        duty = phases(u[k]) / LINK_V
        duty = np.clip(np.round((duty + 0.5 - 0.5 * (duty.max() + duty.min())) * 2 ** 13) / 2 ** 13, 0.0, 1.0)
        rows.u[k] = LINK_V * vector(duty)
        for into in (rows.i, rows.i_mid):
            true_A = drive.machine.meas_currents()
            into[k] = np.round((true_A + NOISE_A * rng.standard_normal(3)) / LSB_A) * LSB_A
            half_period(drive, 0.5 * T_s, duty, DEAD * T_s)
    return rows


def acting(rows, saliency):
    """The voltage of each cycle less the loss of the legs at the current of their edges, as the firmware has it (sensorless.h)."""
    L, most = 0.5 * (1.0 + saliency) * L_D, DEAD * LINK_V
    u, (start, middle, end) = phases(rows.u[:-1]), (phases(vector(i)) for i in (rows.i[:-1], rows.i_mid[:-1], rows.i[1:]))
    duty = 0.5 + (u - 0.5 * (u.max(-1, keepdims=True) + u.min(-1, keepdims=True))) / LINK_V
    ripple_V = 0.5 * (sum(np.maximum(u - np.roll(u, n, -1), 0.0) for n in (1, 2)) / 3.0 - u * duty)
    bend = 0.5 * (start - 2.0 * middle + end) * duty * (1.0 - duty)
    lost = sum(np.clip(3.0 * (L / rows.T_s * (middle + (i - middle) * duty - bend) + sign * ripple_V), -most, most)
               for i, sign in ((start, -1.0), (end, 1.0)))
    return rows.u[:-1] - 0.5 * vector(lost)


def of_library(program, rows, saliency):
    """Rows, bias and rms of `iqfoc observe`, which begins without an angle."""
    motor = (f'name = "2019"\n[motor]\npole_pairs = {POLE_PAIRS}\nR_ohm = {R}\nL_d_H = {L_D}\nL_q_H = {saliency * L_D}\npsi_f_Wb = {PSI}\n'
             f'I_rated_A_rms = 10.5\nn_max_rpm = {RPM}\n[inverter]\nf_pwm_Hz = {1.0 / rows.T_s}\nu_dc_V = {LINK_V}\n'
             f'[extension.dead_time]\nv_dead_V = {DEAD * LINK_V}\ni_knee_A = 0.01\n')
    names = "t_s,i_a_A,i_b_A,i_c_A,i_a_mid_A,i_b_mid_A,i_c_mid_A,u_a_V,u_b_V,u_c_V,theta_e_rad,omega_e_rad_s"
    table = np.column_stack([rows.T_s * np.arange(CYCLES), rows.i, rows.i_mid, phases(rows.u), rows.theta, np.full(CYCLES, OMEGA)])
    with tempfile.TemporaryDirectory() as folder:
        files = [pathlib.Path(folder) / name for name in ("m.toml", "r.csv", "o.json")]
        files[0].write_text(motor, encoding="utf-8")
        np.savetxt(files[1], table, delimiter=",", header=names, comments="", fmt="%.12g")
        subprocess.run([program, "observe", files[1], "--motor", files[0], "--json", files[2]], check=True, capture_output=True)
        return json.loads(files[2].read_text(encoding="utf-8"))["error"]


def of_motulator(rows, saliency):
    """The angle of motulator's sensorless observer, its gains as they are by default."""
    par = SynchronousMachinePars(n_p=POLE_PAIRS, R_s=R, L_d=L_D, L_q=saliency * L_D, psi_f=PSI)
    observer, u, i, theta = Observer(ObserverCfg(par, True)), acting(rows, saliency), vector(rows.i), []
    observer.est.w_m, observer.est.theta_m = OMEGA, rows.theta[0]
    observer.est.psi_s = PSI + 1j * saliency * L_D * (i[0] * np.exp(-1j * rows.theta[0])).imag
    for k in range(CYCLES - 1):
        if not abs(observer.est.psi_s) < 100.0 * PSI:
            return np.full(CYCLES, np.nan)  # it diverges
        # Their voltage at a sample is the mean of the cycle that ends and the one that begins.
        now = observer.output(SimpleNamespace(u_ss=0.5 * (u[max(k - 1, 0)] + u[k]), i_ss=i[k]))
        theta.append(now.theta_m)
        observer.update(rows.T_s, now)
    return np.array(theta)


class Kalman:
    """
    Extended Kalman filter on the exact step of the flux. State: flux in the stationary frame over psi_f, angle, angle per cycle.

        flux += (u T - R T mean of i)/psi_f,  theta += turn        exact for a voltage that is constant over the cycle
        i = current of the flux in the rotor's frame               two outputs, with the noise of the sensor
    """

    FLUX_NOISE, TURN_NOISE = 1e-3, 2e-4

    def __init__(self, saliency, T_s, i, theta):
        self.L_q, self.T_s = saliency * L_D, T_s
        flux = np.exp(1j * theta) * (1.0 + 1j * self.L_q * (i * np.exp(-1j * theta)).imag / PSI)
        self.x = np.array([flux.real, flux.imag, theta, OMEGA * T_s])
        self.P = np.diag([1e-4, 1e-4, 1e-4, 1e-6])
        self.Q = np.diag([self.FLUX_NOISE ** 2] * 2 + [0.0, self.TURN_NOISE ** 2])
        # Two thirds of a phase's variance in each component.
        self.noise = (2.0 / 3.0 * (NOISE_A ** 2 + LSB_A ** 2 / 12.0)) * np.eye(2)
        self.F = np.eye(4)
        self.F[2, 3] = 1.0

    def output(self):
        """The current and its slopes by the state."""
        turn = np.exp(1j * self.x[2])
        dq = complex(self.x[0], self.x[1]) / turn * PSI

        def current(flux):
            return flux.real / L_D + 1j * flux.imag / self.L_q

        i_dq = current(dq - PSI)
        slopes = [turn * current(PSI / turn), turn * current(1j * PSI / turn), turn * (1j * i_dq + current(-1j * dq)), 0.0]
        return turn * i_dq, np.array([[x.real for x in slopes], [x.imag for x in slopes]])

    def step(self, u, i_mean, i):
        moved = self.T_s * (u - R * i_mean) / PSI
        self.x = self.F @ self.x + np.array([moved.real, moved.imag, 0.0, 0.0])
        P = self.F @ self.P @ self.F.T + self.Q
        expected, H = self.output()
        gain = np.linalg.solve(H @ P @ H.T + self.noise, H @ P).T
        self.x = self.x + gain @ np.array([(i - expected).real, (i - expected).imag])
        self.P = (np.eye(4) - gain @ H) @ P
        return self.x[2]


def of_kalman(rows, saliency):
    u, i, middle = acting(rows, saliency), vector(rows.i), vector(rows.i_mid)
    mean = (i[:-1] + 4.0 * middle[:-1] + i[1:]) / 6.0
    kalman = Kalman(saliency, rows.T_s, i[0], rows.theta[0])
    return np.array([rows.theta[0]] + [kalman.step(u[k], mean[k], i[k + 1]) for k in range(CYCLES - 1)])


def error_of(theta, rows):
    """Bias and rms about it of the last rows, degrees."""
    off = np.degrees(np.angle(np.exp(1j * (theta - rows.theta[:len(theta)]))))[-LAST:]
    return {"bias_deg": off.mean(), "rms_deg": off.std(), "most_deg": np.abs(off).max()}


def cells(error):
    if error["most_deg"] is None or not error["most_deg"] <= LOST_DEG:
        return ["lost", "lost"]
    return [f"{error['bias_deg'] + 0.0:.2f}".replace("-0.00", "0.00"), f"{error['rms_deg']:.2f}"]


def table(program):
    heads = ["machine", "SFFR"]
    for name in ("this library", "Kalman filter", "motulator"):
        heads += [f"{name}: bias, degrees", "rms"]
    lines = ["| " + " | ".join(heads) + " |", "| --- |" + " ---: |" * (len(heads) - 1)]
    for machine, saliency in MACHINES.items():
        for ratio in RATIOS:
            rows = recorded(ratio, saliency)
            errors = (of_library(program, rows, saliency), error_of(of_kalman(rows, saliency), rows), error_of(of_motulator(rows, saliency), rows))
            lines.append(f"| {machine} | {ratio:g} | " + " | ".join(cell for error in errors for cell in cells(error)) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--iqfoc", default=os.environ.get("IQFOC", ROOT / "build" / "host" / "iqfoc"))
    print(table(str(parser.parse_args().iqfoc)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
