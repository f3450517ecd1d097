"""One-cycle prediction with the cycle's mean voltage and the true parameters: what an oracle would reach.

Used to size the hidden effects and to judge a diagnosis's gain; the diagnosis itself has its own model, in C.
"""

import copy
from types import SimpleNamespace

import numpy as np

from second_plant import TURN, Machine, bounded, phases_from_vector, vector_from_phases

SUBSTEPS = 4  # RK4 over T/4: below 1e-6 of the current even at eight cycles per turn
HISTORY = 2   # rows at a run's start that an open-loop simulation leaves out, as the diagnosis does


def no_effect():
    """Every effect absent, in the terms of the recording's documentation, plus what the diagnosis does not know.

    whole: whether a prediction knows the iron and the compensation of a dead time. Without it the sizes of the seeds that were drawn
    before it did stay what they are.
    """
    return SimpleNamespace(
        whole=False,
        I_sat_A=np.inf, t_dead_s=0.0, compensation_V=0.0, V_switch_V=0.0, V_diode_V=0.0, v_dead_V=0.0, i_knee_A=1.0, k_u=1.0,
        o_A=np.zeros(3), g=np.ones(3), two_sensors=False, theta_0_rad=0.0,
        # What drifts: by how much per second of the recording; the values are those at its middle.
        R_rate_ohm_s=0.0, psi_rate_Wb_s=0.0, o_rate_A_s=np.zeros(3), g_rate_s=np.zeros(3),
        alpha_R=0.0, alpha_psi=0.0, heating_K=0.0,
        order=1, amplitude_rad=0.0, phase_rad=0.0, t_delay_s=0.0, sensor_lag_s=0.0, speed_lag_s=0.0,
        delay_cycles=0, psi_5_Wb=0.0, psi_7_Wb=0.0, psi_11_Wb=0.0, psi_13_Wb=0.0, dR_ohm=np.zeros(3), dL_H=np.zeros(3), flux_map=None, R_iron_ohm=np.inf,
        tau_iron_s=1e-4, u_ripple=0.0, u_ripple_Hz=300.0, ripple_rad=None, glitch_rate=0.0, loose_rate=0.0, loose_phase=0, loose_factor=0.0,
        weak_pole=0.0, short=None, pick_up={}, hysteresis_A=0.0, hum_V=0.0, hum_Hz=50.0, hum_phase=0, flux_order=0, flux_share=0.0, flux_rad=0.0)


def gains_on_vector(model):
    """p, q of measured = p i + q conj(i), for gains g_x on the phases of a current without common part.

    With two sensors the third value is -a - b of the two measured ones: their gains act on it too.
    """
    def measured(i):
        phases = model.g.reshape(3, 1) * phases_from_vector(np.array([i]))
        if model.two_sensors:
            phases[2] = -phases[0] - phases[1]
        return complex(vector_from_phases(phases)[0])
    of_one, of_j = measured(1.0 + 0.0j), measured(1.0j)
    return 0.5 * (of_one - 1j * of_j), 0.5 * (of_one + 1j * of_j)


def true_speed(omega, lag_rows):
    """The speed ahead of a first-order filter of so many rows: the recorded one and its slope, smoothed over as many."""
    wide = int(round(lag_rows))
    if wide < 2:
        return omega
    rows = len(omega)
    sums = np.concatenate([np.zeros((1, omega.shape[1])), np.cumsum(omega, axis=0)])
    low, high = np.maximum(np.arange(rows) - wide, 0), np.minimum(np.arange(rows) + wide + 1, rows)
    middle = (sums[high] - sums[low]) / (high - low).reshape(-1, 1)
    return omega + lag_rows * np.gradient(middle, axis=0)


def add_iron(i, flux, omega, model):
    """The terminals' current of a machine's: with what eddy currents take at a steady speed."""
    return i + 1j * omega * flux / model.R_iron_ohm if model.whole and np.isfinite(model.R_iron_ohm) else i


class Prepared:
    """The columns as the true drive had them: current, angle, speed and voltage of each row, all of shape (rows, lanes).

    model: R_ohm, L_d_H, L_q_H, psi_f_Wb and the fields of no_effect(); a value that drifts has its mean.
    """

    def __init__(self, columns, model, pole_pairs, T_s):
        self.model, self.T_s, self.shape = model, T_s, columns["theta_e_rad"].shape

        def vectors(name):
            return vector_from_phases(columns[name].transpose(1, 0, 2).reshape(3, -1)).reshape(self.shape)

        self.measured = vectors("i_A")
        self.o = complex(vector_from_phases(model.o_A.reshape(3, 1))[0])
        self.p, self.q = gains_on_vector(model)
        x = self.measured - self.o
        self.i = (np.conj(self.p) * x - self.q * x.conj()) / (abs(self.p) ** 2 - abs(self.q) ** 2)
        theta = columns["theta_e_rad"] - model.theta_0_rad
        if model.amplitude_rad:
            theta = theta - model.amplitude_rad * np.cos(model.order * theta / pole_pairs + model.phase_rad)
        self.omega = true_speed(columns["omega_e_rad_s"], model.speed_lag_s / T_s)
        # While no leg is high a current that is seen late is an angle that is read late: nearly, where a filter still sees edges.
        self.theta = theta - self.omega * (model.t_delay_s + model.sensor_lag_s)
        self.u = model.k_u * vectors("u_V")
        if model.ripple_rad is not None:
            at = TURN * model.u_ripple_Hz * T_s * np.arange(self.shape[0]).reshape(-1, 1) + model.ripple_rad
            self.u = self.u * (1.0 + model.u_ripple * np.sin(at))
        # A voltage delay needs the row (or two) before, which the first rows do not have; the last row has no row after it.
        self.first, self.whole = max(1, int(np.ceil(model.delay_cycles))), int(model.delay_cycles)
        self.part = model.delay_cycles - self.whole  # of each cycle under the command before

    def machine(self, lanes):
        m = self.model
        return Machine(lanes, m.R_ohm, m.L_d_H, m.L_q_H, m.psi_f_Wb, m.psi_5_Wb, m.psi_7_Wb, m.I_sat_A, m.dR_ohm, dL_H=m.dL_H,
                       psi_11_Wb=m.psi_11_Wb, psi_13_Wb=m.psi_13_Wb, flux_map=m.flux_map)

    def as_measured(self, i):
        return self.p * i + self.q * i.conj() + self.o


def start_flux(machine, i, theta, omega, model):
    """The flux linkage of a terminal current, less what the iron takes of it."""
    psi = machine.flux(i, theta)
    if model.whole and np.isfinite(model.R_iron_ohm):
        for _ in range(2):
            psi = machine.flux(i - 1j * omega * psi / model.R_iron_ohm, theta)
    return psi


def one_cycle(machine, model, T_s, psi, theta, omega, u, late, part, i_start):
    """The flux linkage a cycle on. A compensation of the dead time acts by the current at the cycle's start."""
    lost_V = model.v_dead_V
    if model.whole and model.compensation_V:
        lost_V = lost_V + model.compensation_V
        more = vector_from_phases(model.compensation_V * np.sign(phases_from_vector(i_start)))
        u, late = u + more, late + more

    def slope(psi, place):
        current = add_iron(machine.current_at(psi, place), psi, omega, model)
        v = (late if step < part * SUBSTEPS else u) - machine.resistive_drop(current)
        if lost_V:
            lost = lost_V * bounded(phases_from_vector(current) / model.i_knee_A, -1.0, 1.0)
            v = v - vector_from_phases(lost)
        return v

    h = T_s / SUBSTEPS
    for step in range(SUBSTEPS):
        a, b, c = (machine.place(theta + omega * h * (step + x)) for x in (0.0, 0.5, 1.0))
        k1 = slope(psi, a)
        k2 = slope(psi + 0.5 * h * k1, b)
        k3 = slope(psi + 0.5 * h * k2, b)
        k4 = slope(psi + h * k3, c)
        psi = psi + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    return psi


def predict(columns, model, pole_pairs, T_s):
    """Errors of the one-cycle prediction as vectors, shape (cycles - 2, lanes), the measured current and the prediction.

    columns: what second_drive.record returned; model: as of Prepared.
    """
    x = Prepared(columns, model, pole_pairs, T_s)
    rows, now, then = x.shape[0], slice(x.first, -1), slice(x.first + 1, None)
    late, u = x.u[x.first - x.whole - 1:rows - 2 - x.whole], x.u[x.first - x.whole:rows - 1 - x.whole]
    theta, omega, i_now = x.theta[now].ravel(), x.omega[now].ravel(), x.i[now].ravel()
    machine = x.machine(u.size)
    psi = one_cycle(machine, model, T_s, start_flux(machine, i_now, theta, omega, model), theta, omega, u.ravel(), late.ravel(), x.part,
                    i_now)
    i_next = add_iron(machine.current(psi, theta + omega * T_s), psi, omega, model).reshape(u.shape)
    predicted = x.as_measured(i_next)
    return predicted - x.measured[then], x.measured[then], predicted


def open_loop(columns, model, pole_pairs, T_s, rows):
    """The same without a measured current but each lane's first: simulated from its voltages over rows[lane] rows to its end.

    Returns the errors of all rows of all lanes and the measured currents, one after the other.
    """
    x = Prepared(columns, model, pole_pairs, T_s)
    machine = x.machine(x.shape[1])
    first = max(x.first, HISTORY)
    i = x.i[first]
    psi = start_flux(machine, i, x.theta[first], x.omega[first], model)
    out = np.zeros(x.shape, complex)
    for k in range(first, x.shape[0]):
        if k > first:
            # The rotor is where its angle says; the flux linkage stays.
            i = add_iron(machine.current(psi, x.theta[k]), psi, x.omega[k], model)
        out[k] = x.as_measured(i) - x.measured[k]
        psi = one_cycle(machine, model, T_s, psi, x.theta[k], x.omega[k], x.u[k - x.whole], x.u[k - x.whole - 1], x.part, i)
    return (np.concatenate([out[first:n, lane] for lane, n in enumerate(rows)]),
            np.concatenate([x.measured[first:n, lane] for lane, n in enumerate(rows)]))


def ripple_phases(columns, model, pole_pairs, T_s):
    """The phase of the link's ripple in each lane, which no column has: by least squares from the one-cycle error without it."""
    blind = copy.copy(model)
    blind.ripple_rad = None
    error, _, _ = predict(columns, blind, pole_pairs, T_s)
    x = Prepared(columns, blind, pole_pairs, T_s)
    k = np.arange(x.first, x.first + error.shape[0]).reshape(-1, 1)
    u, turned = x.u[x.first:x.first + error.shape[0]], TURN * model.u_ripple_Hz * T_s * k
    phases = np.zeros(x.shape[1])
    for lane in range(x.shape[1]):
        # What the true drive did beyond the prediction goes with the voltage times the sine.
        a = np.stack([u[:, lane] * np.sin(turned[:, 0]), u[:, lane] * np.cos(turned[:, 0])], axis=1)
        both = np.concatenate([a.real, a.imag])
        found = np.linalg.lstsq(both, -np.concatenate([error[:, lane].real, error[:, lane].imag]), rcond=None)[0]
        phases[lane] = np.arctan2(found[1], found[0])
    return phases


def rms(x):
    return float(np.sqrt(np.mean(np.abs(x) ** 2)))
