"""One-cycle prediction with the cycle's mean voltage and the true parameters: what an oracle would reach.

Used to size the hidden effects and to judge a diagnosis's gain; the diagnosis itself has its own model, in C.
"""

from types import SimpleNamespace

import numpy as np

from second_plant import Machine, phases_from_vector, vector_from_phases

SUBSTEPS = 4  # RK4 over T/4: below 1e-6 of the current even at eight cycles per turn


def no_effect():
    """Every effect absent, in the terms of the recording's documentation, plus what the diagnosis does not know."""
    return SimpleNamespace(
        I_sat_A=np.inf, t_dead_s=0.0, compensation_V=0.0, V_switch_V=0.0, V_diode_V=0.0, v_dead_V=0.0, i_knee_A=1.0, k_u=1.0,
        o_A=np.zeros(3), g=np.ones(3), two_sensors=False, theta_0_rad=0.0,
        # What drifts: by how much per second of the recording; the values are those at its middle.
        R_rate_ohm_s=0.0, psi_rate_Wb_s=0.0, o_rate_A_s=np.zeros(3), g_rate_s=np.zeros(3),
        alpha_R=0.0, alpha_psi=0.0, heating_K=0.0,
        order=1, amplitude_rad=0.0, phase_rad=0.0, t_delay_s=0.0, sensor_lag_s=0.0, speed_lag_s=0.0,
        delay_cycles=0, psi_5_Wb=0.0, psi_7_Wb=0.0, psi_11_Wb=0.0, psi_13_Wb=0.0, dR_ohm=np.zeros(3), dL_H=np.zeros(3), flux_map=None, R_iron_ohm=np.inf,
        tau_iron_s=1e-4, u_ripple=0.0, u_ripple_Hz=300.0, glitch_rate=0.0, loose_rate=0.0, loose_phase=0, loose_factor=0.0,
        hysteresis_A=0.0, hum_V=0.0, hum_Hz=50.0, hum_phase=0, flux_order=0, flux_share=0.0, flux_rad=0.0)


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


def predict(columns, model, pole_pairs, T_s):
    """Errors of the one-cycle prediction as vectors, shape (cycles - 2, lanes), and the measured current.

    columns: what second_drive.record returned. model: R_ohm, L_d_H, L_q_H, psi_f_Wb and the fields of no_effect();
    what drifts stands at its mean.
    """
    shape = columns["theta_e_rad"].shape

    def vectors(name):
        return vector_from_phases(columns[name].transpose(1, 0, 2).reshape(3, -1)).reshape(shape)

    measured = vectors("i_A")
    o = complex(vector_from_phases(model.o_A.reshape(3, 1))[0])
    p, q = gains_on_vector(model)
    x = measured - o
    i = (np.conj(p) * x - q * x.conj()) / (abs(p) ** 2 - abs(q) ** 2)

    theta = columns["theta_e_rad"] - model.theta_0_rad
    if model.amplitude_rad:
        theta = theta - model.amplitude_rad * np.cos(model.order * theta / pole_pairs + model.phase_rad)
    omega = true_speed(columns["omega_e_rad_s"], model.speed_lag_s / T_s)
    # While no leg is high a current that is seen late is an angle that is read late: nearly, where a filter still sees edges.
    theta = theta - omega * (model.t_delay_s + model.sensor_lag_s)

    # The first row (or two) has no row before it, where a late voltage would stand; the last has no row after it.
    first, whole = max(1, int(np.ceil(model.delay_cycles))), int(model.delay_cycles)
    part = model.delay_cycles - whole  # of each cycle under the command before
    now, then = slice(first, -1), slice(first + 1, None)
    u = model.k_u * vectors("u_V")
    late, u = u[first - whole - 1:shape[0] - 2 - whole], u[first - whole:shape[0] - 1 - whole]
    theta, omega, i_now = theta[now].ravel(), omega[now].ravel(), i[now].ravel()
    shape, u, late = u.shape, u.ravel(), late.ravel()  # without the first rows and the last
    machine = Machine(u.size, model.R_ohm, model.L_d_H, model.L_q_H, model.psi_f_Wb, model.psi_5_Wb, model.psi_7_Wb,
                      model.I_sat_A, model.dR_ohm, dL_H=model.dL_H, psi_11_Wb=model.psi_11_Wb, psi_13_Wb=model.psi_13_Wb,
                      flux_map=model.flux_map)

    def slope(psi, angle):
        current = machine.current(psi, angle)
        v = (late if step < part * SUBSTEPS else u) - machine.resistive_drop(current)
        if model.v_dead_V:
            lost = model.v_dead_V * np.clip(phases_from_vector(current) / model.i_knee_A, -1.0, 1.0)
            v = v - vector_from_phases(lost)
        return v

    h, psi = T_s / SUBSTEPS, machine.flux(i_now, theta)
    for step in range(SUBSTEPS):
        a, b, c = (theta + omega * h * (step + x) for x in (0.0, 0.5, 1.0))
        k1 = slope(psi, a)
        k2 = slope(psi + 0.5 * h * k1, b)
        k3 = slope(psi + 0.5 * h * k2, b)
        k4 = slope(psi + h * k3, c)
        psi = psi + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    i_next = machine.current(psi, theta + omega * T_s).reshape(shape)
    predicted = p * i_next + q * i_next.conj() + o
    return predicted - measured[then], measured[then], predicted


def rms(x):
    return float(np.sqrt(np.mean(np.abs(x) ** 2)))
