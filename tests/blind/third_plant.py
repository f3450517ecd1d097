"""The third plant: a drive of motulator, by people who know nothing of this project, with effects hidden around it.

motulator (PyPI) has the machine in flux linkages, the inverter's switching states by carrier comparison, the current controller, the
modulator and the computational delay. It has ideal sensors and an ideal inverter: what is hidden is put between its parts (a sensor's
error, a link that is measured wrongly, switching edges that are late by the sign of the current) or into the motor file. Its own solver
calls a general integrator for each switching state; here the same right-hand side is advanced by the classical Runge-Kutta rule from
edge to edge, which is as exact at these step lengths and ten times as quick.

Runs in motulator's own environment (tools/setup.sh); third.py calls it: third_plant.py OUTPUT_FOLDER < case.json
"""

import json
import os
import sys
from types import SimpleNamespace

import numpy as np
from motulator.common.model import CarrierComparison, Delay
from motulator.common.utils import complex2abc
from motulator.drive import model
from motulator.drive.control import DriveControlSystem
from motulator.drive.control.sm import CurrentController
from motulator.drive.utils import SynchronousMachinePars

import generate

WARM_UP = 80
RUNS, ROWS = 8, 420
STEADY_ROWS = 1_800
GROUPS = ("bench", "bench_half", "steady", "outside")
STEP_MOST = 0.25  # of half a carrier period: how long a step of the integration may be


class Baldor:
    """Current of a 5.6 kW PM synchronous reluctance machine: Lelli, Hinkkanen and Giulii Capponi, ICEM 2024, fitted to its measured map.

    Self and cross saturation of both axes, and an iron bridge next to the magnet that saturates with both.
    """

    def __call__(self, psi):
        d, q = psi.real, psi.imag
        in_d = 3.96 + 28.5 * abs(d) ** 4 + 41.5 / 3.0 * abs(d) * abs(q) ** 3
        in_q = 5.89 + 2.67 * abs(q) ** 6 + 41.5 / 3.0 * abs(d) ** 3 * abs(q)
        bridge = d - 0.804
        square = bridge ** 2 + 0.1 * q ** 2
        share = 81.75 * square / (1.0 + square)
        return in_d * d + share * bridge + 1j * (in_q + 0.1 * share) * q


class Syrm:
    """Current of a 6.7 kW synchronous reluctance machine: Hinkkanen et al., IEEE Trans. Ind. Appl. 2017, fitted to its measured map."""

    def __call__(self, psi):
        d, q = psi.real, psi.imag
        in_d = 17.4 + 373.0 * abs(d) ** 5 + 560.0 * abs(d) * q ** 2
        in_q = 52.1 + 658.0 * abs(q) + 1120.0 / 3.0 * abs(d) ** 3
        return in_d * d + 1j * in_q * q


# What the motor file says of each where nothing is hidden, and next to it the flux map of those that have one. f_Hz: the top speed.
MACHINES = {
    "ipmsm": SimpleNamespace(name="IPMSM 2.2 kW", pole_pairs=3, R_ohm=3.6, L_d_H=0.036, L_q_H=0.051, psi_f_Wb=0.545, I_A=4.3, f_Hz=75.0,
                             u_dc_V=540.0, f_pwm_Hz=4000.0, map=None, plane=(-0.5, 0.2)),
    "spmsm": SimpleNamespace(name="SPMSM 2.2 kW", pole_pairs=3, R_ohm=3.6, L_d_H=0.036, L_q_H=0.036, psi_f_Wb=0.545, I_A=4.3, f_Hz=75.0,
                             u_dc_V=540.0, f_pwm_Hz=5000.0, map=None, plane=(-0.4, 0.2)),
    "pmsyrm": SimpleNamespace(name="PM-SyRM 5.6 kW", pole_pairs=2, R_ohm=0.63, I_A=8.8, f_Hz=90.0, u_dc_V=540.0, f_pwm_Hz=4000.0,
                              map=Baldor(), plane=(-0.8, 0.1)),
    "syrm": SimpleNamespace(name="SyRM 6.7 kW", pole_pairs=2, R_ohm=0.54, I_A=15.5, f_Hz=106.0, u_dc_V=540.0, f_pwm_Hz=5000.0,
                            map=Syrm(), plane=(0.3, 0.8)),
}


def flux_of(current_of, i):
    """The flux linkage at which a map gives a current: Newton's method, the slopes by differences."""
    psi = 0.5 + 0.1j * np.sign(i.imag)
    for _ in range(60):
        left = i - current_of(psi)
        in_d = (current_of(psi + 1e-6) - current_of(psi - 1e-6)) / 2e-6
        in_q = (current_of(psi + 1e-6j) - current_of(psi - 1e-6j)) / 2e-6
        size = in_d.real * in_q.imag - in_q.real * in_d.imag
        step = complex((left.real * in_q.imag - left.imag * in_q.real) / size, (in_d.real * left.imag - in_d.imag * left.real) / size)
        psi += step * min(1.0, 0.2 / max(abs(step), 1e-12))
    return psi


def constants_of(machine):
    """Constant inductances and magnet flux that a user would have of a machine with a map: those at no current."""
    if machine.map is None:
        return machine
    small = 0.05 * np.sqrt(2.0) * machine.I_A
    file = SimpleNamespace(**vars(machine))
    file.psi_f_Wb = flux_of(machine.map, 0j).real if isinstance(machine.map, Baldor) else 0.0
    file.L_d_H = float((flux_of(machine.map, small + 0j) - flux_of(machine.map, -small + 0j)).real / (2.0 * small))
    file.L_q_H = float(flux_of(machine.map, 1j * small).imag / small)
    return file


class Sensors:
    """Between drive and control: what is measured, and recorded."""

    def __init__(self, hidden, I_pk, T_s, rng):
        self.hidden, self.rng, self.T_s = hidden, rng, T_s
        self.full_A, self.noise_A, self.I_pk = 2.2 * I_pk, 0.0012 * I_pk, I_pk
        self.cycle, self.held = 0, None

    def strange(self, x):
        """What an effect outside the catalogue makes of the currents."""
        if not self.hidden["outside"]:
            return x
        name, size, phase = self.hidden["outside"]
        self.cycle += 1
        if name == "crosstalk":
            return x + size * np.array([0.0, x[0], x[1]])
        if name == "sensor_hysteresis":
            width = size * self.I_pk
            self.held = x if self.held is None else np.clip(self.held, x - width, x + width)
            return self.held
        here = np.ones(3) if name == "common_hum" else np.eye(3)[phase]
        return x + size * self.I_pk * np.sin(2.0 * np.pi * 50.0 * self.cycle * self.T_s) * here

    def currents(self, true_A):
        h, lsb = self.hidden, 2.0 * self.full_A / 4096
        true_A = self.strange(true_A)
        x = np.array(h["gain"]) * true_A + np.array(h["offset_A"]) + self.noise_A * self.rng.standard_normal(3)
        return np.clip(np.round(x / lsb) * lsb, -self.full_A, self.full_A)

    def angle(self, true_rad, omega):
        step = 2.0 * np.pi / 2 ** 15
        return np.round((true_rad + self.hidden["theta_0_rad"] + omega * self.hidden["t_delay_s"]) / step) * step


class References:
    """The current reference: an operating point, with small steps of both axes about it."""

    def __init__(self, rng, point, size_A, cycles):
        self.at, self.values = 0, np.empty(cycles + 2, complex)
        steps = [np.repeat(rng.uniform(-1.0, 1.0, cycles), rng.integers(15, 90, cycles))[:cycles + 2] for _ in range(2)]
        self.values = point + size_A * (steps[0] + 1j * steps[1])

    def output(self, _fbk, ref):
        ref.i_s = self.values[self.at]
        return ref

    def update(self, _fbk, _ref):
        self.at += 1


class Control(DriveControlSystem):
    """motulator's current controller and modulator on what the sensors tell."""

    def __init__(self, par, T_s, sensors, references, bandwidth):
        super().__init__(par, T_s, False)
        self.sensors, self.references, self.rows = sensors, references, []
        self.current_ctrl = CurrentController(par, bandwidth)
        self.applied = np.zeros(3)

    def get_feedback_signals(self, mdl):
        s, true = self.sensors, mdl.machine.state
        omega = mdl.machine.par.n_p * mdl.mechanics.w_M(mdl.t0)
        theta = s.angle(np.angle(true.exp_j_theta_m), omega)
        i_abc = s.currents(mdl.machine.meas_currents())
        rotor = np.exp(-1j * theta)
        fbk = SimpleNamespace(u_dc=mdl.converter.par.u_dc / s.hidden["k_u"], i_ss=2.0 / 3.0 * np.dot(i_abc, np.exp(2j * np.pi / 3 * np.arange(3))),
                              w_m=omega, w_s=omega, theta_m=theta, i_abc=i_abc)
        fbk.i_s, fbk.u_s = rotor * fbk.i_ss, rotor * self.pwm.get_realized_voltage()
        return fbk

    def output(self, fbk):
        ref = self.references.output(fbk, super().output(fbk))
        ref.u_s = self.current_ctrl.output(ref.i_s, fbk.i_s)
        ref.d_abc = self.pwm(ref.T_s, ref.u_s * np.exp(1j * fbk.theta_m), fbk.u_dc, fbk.w_s)
        return ref

    def update(self, fbk, ref):
        super().update(fbk, ref)
        self.references.update(fbk, ref)
        self.current_ctrl.update(ref.T_s, fbk.u_s, fbk.w_s)
        self.rows.append((fbk.i_abc, fbk.theta_m, fbk.w_m, fbk.u_dc))

    def save(self, **_data):
        """What is recorded is in rows."""


def step(drive, q, h_s):
    """One Runge-Kutta step of the drive's own right-hand side with the switching state q."""
    drive.converter.inp.q_cs = q
    t, x = drive.t0, np.array(drive.get_initial_values())
    k1 = np.array(drive.rhs(t, x))
    k2 = np.array(drive.rhs(t + 0.5 * h_s, x + 0.5 * h_s * k1))
    k3 = np.array(drive.rhs(t + 0.5 * h_s, x + 0.5 * h_s * k2))
    k4 = np.array(drive.rhs(t + h_s, x + h_s * k3))
    drive.set_states(x + h_s / 6.0 * (k1 + 2.0 * (k2 + k3) + k4))
    drive.t0 = t + h_s


def half_period(drive, half_s, duty, t_dead_s):
    """Half a carrier period: the edges by carrier comparison, late by the dead time where the leg's diode holds the old voltage."""
    durations, states = drive.pwm(half_s, duty)
    at = drive.t0 + np.concatenate([[0.0], np.cumsum(durations)])
    now = drive.legs.copy()
    # (instant, leg, state), and whether it has waited already.
    commanded = [(at[n], leg, states[n][leg]) for n in range(4) for leg in range(3)
                 if states[n][leg] != (states[n - 1][leg] if n else drive.commanded[leg])]
    end = at[-1]
    waiting = commanded + drive.late
    drive.commanded = np.array(states[-1])
    drive.late = []
    while True:
        edges = sorted(waiting, key=lambda e: e[0])
        until = min(edges[0][0], end) if edges else end
        while until - drive.t0 > 1e-15:
            step(drive, 2.0 / 3.0 * np.dot(now, np.exp(2j * np.pi / 3 * np.arange(3))), min(until - drive.t0, STEP_MOST * half_s))
        drive.t0 = until
        if not edges or edges[0][0] > end:
            break
        waiting = edges[1:]
        instant, leg, state, *is_late = edges[0]
        # Both switches are off: a current into the motor flows through the lower diode, one out of it through the upper.
        into_motor = drive.machine.meas_currents()[leg] > 0.0
        if t_dead_s > 0.0 and not is_late and bool(state) == bool(into_motor):
            waiting.append((instant + t_dead_s, leg, state, True))
        else:
            now[leg] = state
    drive.late, drive.legs = waiting, now


def simulate(machine, file, hidden, seed, kinds):
    """Runs at operating points; `steady`: one alone. `wide`: up to twice the currents, at speeds that the link's voltage reaches there."""
    """All runs: the recording's columns, one array over rows for each run. A steady recording has one, at one speed."""
    rng = np.random.default_rng([seed, 31])
    I_pk, T_s = np.sqrt(2.0) * machine.I_A, 1.0 / machine.f_pwm_Hz
    runs = []
    for n in range(RUNS):
        speed = [0.0, 0.1, 0.25, -0.35, 0.5, -0.7, 0.85, 1.0][n] * rng.uniform(0.9, 1.0) * 2.0 * np.pi * machine.f_Hz
        low, high = machine.plane
        i_d = rng.uniform(low, high) * I_pk * 0.7
        i_q = rng.choice([-1.0, 1.0]) * rng.uniform(0.25, 0.85) * I_pk
        if "steady" in kinds and n != 3 + seed % 5:
            continue
        if "wide" in kinds:
            i_d, i_q = 2.0 * i_d, 2.0 * i_q
            most = 0.37 * machine.u_dc_V / abs(flux_of(machine.map, complex(i_d, i_q)))
            speed = min(max(speed, -most), most)
        runs.append(one_run(machine, file, hidden, rng, speed, complex(i_d, i_q), I_pk, T_s, STEADY_ROWS if "steady" in kinds else ROWS))
    return runs


def one_run(machine, file, hidden, rng, speed, point, I_pk, T_s, rows):
    true = SynchronousMachinePars(n_p=machine.pole_pairs, R_s=hidden["R_ohm"], L_d=hidden["L_d_H"], L_q=hidden["L_q_H"],
                                  psi_f=hidden["psi_f_Wb"])
    psi = flux_of(machine.map, point) if machine.map else hidden["psi_f_Wb"] + hidden["L_d_H"] * point.real + 1j * hidden["L_q_H"] * point.imag
    swing, rate = 0.01 * speed * rng.uniform(0.0, 1.0), 2.0 * np.pi * rng.uniform(1.0, 4.0)
    drive = model.Drive(model.VoltageSourceConverter(machine.u_dc_V), model.SynchronousMachine(true, machine.map, psi),
                        model.ExternalRotorSpeed(lambda t: (speed + swing * np.sin(rate * t)) / machine.pole_pairs))
    drive.pwm, drive.delay = CarrierComparison(N=2 ** 13, return_complex=False), Delay(1)
    drive.legs, drive.commanded, drive.late = np.zeros(3, int), np.zeros(3, int), []
    guess = SynchronousMachinePars(n_p=machine.pole_pairs, R_s=file.R_ohm, L_d=file.L_d_H, L_q=file.L_q_H, psi_f=file.psi_f_Wb)
    control = Control(guess, T_s, Sensors(hidden, I_pk, T_s, rng), References(rng, point, 0.08 * I_pk, WARM_UP + rows), 0.12 / T_s)
    # It starts near its operating point, as a bench that runs; the first command too.
    first = hidden["R_ohm"] * point + 1j * speed * psi
    control.current_ctrl.u_i = 1j * speed * psi + hidden["R_ohm"] * point + control.current_ctrl.k_t * (guess.L_d * point.real + 1j * guess.L_q * point.imag)
    drive.delay.data = [control.pwm.duty_ratios(first * np.exp(0.5j * speed * T_s), machine.u_dc_V)]
    duties = []
    for _ in range(WARM_UP + rows):
        _, command = control(drive)
        duty = drive.delay(command)
        for _half in range(2):
            half_period(drive, 0.5 * T_s, duty, hidden["t_dead_s"])
        duties.append(np.round(duty * 2 ** 13) / 2 ** 13)
    keep = slice(WARM_UP, None)
    kept = control.rows[keep]
    return {"i": np.array([r[0] for r in kept]), "theta": np.array([r[1] for r in kept]), "omega": np.array([r[2] for r in kept]),
            "u_dc": np.array([r[3] for r in kept]), "duty": np.array(duties[keep])}


def recording_text(runs, T_s, with_u):
    names = ["run", "t_s", "i_a_A", "i_b_A", "i_c_A", "theta_e_rad", "omega_e_rad_s"]
    names += ["u_a_V", "u_b_V", "u_c_V"] if with_u else ["d_a", "d_b", "d_c", "u_dc_V"]
    lines, start = [",".join(names)], 0.0
    for n, r in enumerate(runs, 1):
        u = (r["duty"] - r["duty"].mean(axis=1, keepdims=True)) * r["u_dc"][:, None]
        for k in range(len(r["theta"])):
            last = [f"{x:.4f}" for x in u[k]] if with_u else [f"{x:.7f}" for x in r["duty"][k]] + [f"{r['u_dc'][k]:.3f}"]
            lines.append(",".join([str(n), f"{start + k * T_s:.7f}", *(f"{x:.5f}" for x in r["i"][k]), f"{r['theta'][k] % (2.0 * np.pi):.6f}",
                                   f"{r['omega'][k]:.4f}", *last]))
        start += T_s * (len(r["theta"]) + 1000)
    return "\n".join(lines) + "\n"


# How large each effect is where it is alone or one of two: a range, or one size along a drawn direction.
SIZES = {"resistance": (0.15, 0.4), "inductance": (0.05, 0.25), "flux_linkage": (0.02, 0.1), "dead_time": (0.005, 0.012),
         "voltage_gain": (0.02, 0.08), "angle_offset": (0.02, 0.08), "angle_delay": (0.1, 0.3), "current_offset": 0.025, "current_gain": 0.04}
# On a bench everything is a little off, and one or two are 3 to 10 times larger, these too (groups.py has the same of the other plants).
SMALL = {"resistance": 0.06, "current_gain": 0.003, "current_offset": 0.003, "angle_offset": 0.0035, "dead_time": 0.0006}
FURTHER = {"flux_linkage": 0.006, "voltage_gain": 0.006, "angle_delay": 0.02}
LARGER = (3.0, 10.0)
# Effects outside the catalogue, each up to what a bench shows.
OUTSIDE = {"crosstalk": (0.015, 0.05), "hum": (0.01, 0.03), "common_hum": (0.01, 0.03), "sensor_hysteresis": (0.01, 0.04)}


def nothing(file):
    return {"R_ohm": file.R_ohm, "L_d_H": file.L_d_H, "L_q_H": file.L_q_H, "psi_f_Wb": file.psi_f_Wb, "gain": [1.0] * 3, "offset_A": [0.0] * 3,
            "theta_0_rad": 0.0, "t_delay_s": 0.0, "k_u": 1.0, "t_dead_s": 0.0, "outside": None}


def put(h, machine, file, cause, size, sign, rng):
    """Hides one effect of a size; returns what the truth file says of it: name, value, whether it can be compared."""
    I_pk, T_s = np.sqrt(2.0) * machine.I_A, 1.0 / machine.f_pwm_Hz
    by = (1.0 + size) ** sign
    if cause in ("current_offset", "current_gain"):
        x = rng.standard_normal(3)
        x = size * (x - x.mean()) / np.abs(x - x.mean()).max()
        key, letter, values = ("offset_A", "o", I_pk * x) if cause == "current_offset" else ("gain", "g", 1.0 + x)
        h[key] = list(values)
        return [(f"{letter}_{p}", v, True) for p, v in zip("abc", values)]
    if cause == "inductance":
        h["L_d_H"], h["L_q_H"] = by * h["L_d_H"], by * h["L_q_H"]
        return [("L", 0.5 * (h["L_d_H"] + h["L_q_H"]), file.L_d_H == file.L_q_H)]
    if cause == "dead_time":
        h["t_dead_s"] = size * T_s
        return [("v_dead", machine.u_dc_V * size, True), ("i_knee", 0.0, False)]
    key, name, value = {"resistance": ("R_ohm", "R", by * h["R_ohm"]), "flux_linkage": ("psi_f_Wb", "psi_f", by * h["psi_f_Wb"]),
                        "voltage_gain": ("k_u", "k_u", by), "angle_offset": ("theta_0_rad", "theta_0", sign * size),
                        "angle_delay": ("t_delay_s", "t_delay", sign * size * T_s)}[cause]
    h[key] = value
    return [(name, value, True)]


def told_of(cause, parameters, known=True, **more):
    return {"id": cause, "known": known, "share_of_floor": None, **more,
            "parameters": [{"name": n, "value": float(v), "compare": c} for n, v, c in parameters]}


def hide(machine, file, case, rng):
    """The true drive, and what the truth file says of each hidden effect."""
    h, told, sign = nothing(file), [], float(rng.choice([-1.0, 1.0]))
    for cause in case["kind"].split("+"):
        if cause == "saliency":
            h["L_d_H"], h["L_q_H"] = h["L_d_H"] * (1.0 + sign * rng.uniform(0.08, 0.15)), h["L_q_H"] * (1.0 - sign * rng.uniform(0.08, 0.15))
            told.append(told_of(cause, [("L_d", h["L_d_H"], True), ("L_q", h["L_q_H"], True)]))
        elif cause == "saturation_dq":
            told.append(told_of(cause, []))
        elif cause in SIZES:
            size = SIZES[cause] if isinstance(SIZES[cause], float) else rng.uniform(*SIZES[cause])
            told.append(told_of(cause, put(h, machine, file, cause, size, sign, rng)))
    return h, told


def hide_group(machine, file, case, rng):
    """The same of a group: a bench, one speed with one cause or none, or an effect outside the catalogue."""
    group, h = case["kind"], nothing(file)
    if group == "outside":
        name = list(OUTSIDE)[case["seed"] % len(OUTSIDE)]
        h["outside"] = (name, rng.uniform(*OUTSIDE[name]), int(rng.integers(3)))
        return h, [told_of(name, [], known=False)]
    if group == "steady":
        alone = [] if rng.random() < 0.3 else [str(rng.choice(list(SIZES)))]
        return hide(machine, file, {"kind": "+".join(alone)}, rng)
    base = {**SMALL, **FURTHER}
    large = {str(x) for x in rng.choice(list(base), 1 + int(rng.random() < 0.4), replace=False)}
    told = []
    for cause, size in base.items():
        if cause not in SMALL and cause not in large:
            continue
        scale = np.exp(rng.uniform(*np.log(LARGER))) if cause in large else rng.uniform(0.5, 1.5) * (0.5 if group == "bench_half" else 1.0)
        sign = 1.0 if cause == "resistance" and cause not in large else float(rng.choice([-1.0, 1.0]))
        told.append(told_of(cause, put(h, machine, file, cause, float(size * scale), sign, rng), dominates=cause in large))
    return h, told


def main():
    case, folder = json.load(sys.stdin), sys.argv[1]
    machine = MACHINES[case["machine"]]
    base = constants_of(machine)
    rng = np.random.default_rng([case["seed"], 30])
    hidden, told = (hide_group if case["kind"] in GROUPS else hide)(machine, base, case, rng)
    runs = simulate(machine, base, hidden, case["seed"], case["kind"].split("+"))
    file = SimpleNamespace(name=machine.name, pole_pairs=machine.pole_pairs, R_ohm=base.R_ohm, L_d_H=base.L_d_H, L_q_H=base.L_q_H,
                           psi_f_Wb=base.psi_f_Wb, I_rated_A_rms=machine.I_A, n_max_rpm=60.0 * machine.f_Hz / machine.pole_pairs,
                           f_pwm_Hz=machine.f_pwm_Hz, u_dc_V=machine.u_dc_V)
    os.makedirs(folder, exist_ok=True)
    generate.write_text(folder, "rec.csv", recording_text(runs, 1.0 / machine.f_pwm_Hz, case["seed"] % 2 == 0))
    generate.write_text(folder, "motor.toml", generate.motor_text(file))
    I_pk = np.sqrt(2.0) * machine.I_A
    size = np.sqrt(np.mean(np.concatenate([np.sum(r["i"] ** 2, axis=1) * 2.0 / 3.0 for r in runs])))
    noise = np.sqrt((0.0012 * I_pk) ** 2 + (2.0 * 2.2 * I_pk / 4096) ** 2 / 12.0)
    generate.write_truth({"seed": case["seed"], "kind": case["kind"], "group": case["kind"], "plant": f"motulator {case['machine']}", "effects": told,
                          "oracle": {"floor_percent": 100.0 * float(np.sqrt(8.0 / 3.0) * noise / size)},
                          "motor_file_should_say": {k: float(hidden[k]) for k in ("R_ohm", "L_d_H", "L_q_H", "psi_f_Wb")}}, folder)


if __name__ == "__main__":
    sys.exit(main())
