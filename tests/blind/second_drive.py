"""The second drive's electronics: sensors, angle sensor, DC link, current controller, and the loop that records.

All values are arrays over lanes (see second_plant.py). The controller is deliberately plain: it stands for whatever
firmware the user's bench runs, and knows only what it measures.
"""

import numpy as np

from second_plant import TURN, Drive, bounded, phases_from_vector, vector_from_phases


def quantise(x, step):
    return np.rint(x / step) * step


class CurrentSensors:
    """measured = gain * true + offset + noise, quantised; one phase may be loose (reads a part of the truth)."""

    def __init__(self, gain, offset_A, noise_A, lsb_A, full_scale_A, loose_phase, loose_rate, loose_factor,
                 two_sensors, rng, hysteresis_A=0.0, crosstalk=0.0, hum_A=0.0, hum_Hz=50.0, hum_channel=None, edge_A=0.0, edge_s=1.0,
                 edge_coupling=0.0):
        self.two_sensors = two_sensors
        self.gain, self.offset_A, self.noise_A = gain, offset_A, noise_A
        self.lsb_A, self.full_scale_A, self.rng = lsb_A, full_scale_A, rng
        self.loose_phase, self.loose_rate, self.loose_factor = loose_phase, loose_rate, loose_factor
        self.loose_left = np.zeros(lsb_A.shape, int)
        self.hysteresis_A, self.held = hysteresis_A, None
        self.crosstalk, self.hum_A, self.hum_Hz, self.hum_channel = crosstalk, hum_A, hum_Hz, hum_channel
        self.edge_A, self.edge_s, self.edge_coupling = edge_A, edge_s, edge_coupling

    def contact(self):
        """Decides, once per cycle, which lanes' loose contact is open; it stays so for 1 to 12 cycles."""
        if not np.any(self.loose_rate):
            return
        opens = (self.rng.random(self.loose_left.shape) < self.loose_rate) & (self.loose_left == 0)
        length = self.rng.integers(1, 13, self.loose_left.shape)
        self.loose_left = np.where(opens, length, np.maximum(self.loose_left - 1, 0))

    def drift_to(self, gain, offset_A):
        self.gain, self.offset_A = gain, offset_A

    def read(self, i_abc, t_s=0.0, edge_age_s=np.inf, edge_sign=1.0):
        """edge_age_s, edge_sign: since the last switching edge of each leg, and whether it rose (1) or fell (-1)."""
        x = self.gain * i_abc + self.offset_A
        if self.hysteresis_A:
            # A core's play: what is shown follows once the current has turned by more than the width.
            self.held = x if self.held is None else bounded(self.held, x - self.hysteresis_A, x + self.hysteresis_A)
            x = self.held.copy()
        if self.crosstalk:
            x = x + self.crosstalk * np.stack([np.zeros_like(x[0]), x[0], x[1]])
        if self.edge_A:
            left = self.edge_A * edge_sign * np.exp(-edge_age_s / self.edge_s) * (1.0 + 0.3 * self.rng.standard_normal(x.shape))
            x = x + left + self.edge_coupling * (left.sum(axis=0) - left)
        if self.hum_A:
            # In one channel, or in all alike.
            here = np.ones((3, 1)) if self.hum_channel is None else np.arange(3).reshape(3, 1) == self.hum_channel
            x = x + self.hum_A * np.sin(TURN * self.hum_Hz * t_s) * here
        if np.any(self.loose_rate):
            open_now = (self.loose_left > 0) & (np.arange(3).reshape(3, 1) == self.loose_phase)
            x = np.where(open_now, self.loose_factor * x, x)
        x = x + self.noise_A * self.rng.standard_normal(x.shape)
        x = bounded(quantise(x, self.lsb_A), -self.full_scale_A, self.full_scale_A)
        if self.two_sensors:
            x[2] = -x[0] - x[1]
        return x


class AngleSensor:
    """recorded theta_e(t) = true theta_e(t + delay) + offset + amplitude cos(order theta_mech + phase), in counts."""

    def __init__(self, shaft, pole_pairs, counts, offset_rad, delay_s, order, amplitude_rad, phase_rad):
        self.shaft, self.pole_pairs, self.counts = shaft, pole_pairs, counts
        self.offset_rad, self.delay_s = offset_rad, delay_s
        self.order, self.amplitude_rad, self.phase_rad = order, amplitude_rad, phase_rad

    def read(self, t_s):
        true = self.shaft.theta(t_s + self.delay_s)
        mech = true / self.pole_pairs
        seen = true + self.offset_rad + self.amplitude_rad * np.cos(self.order * mech + self.phase_rad)
        return quantise(seen, TURN * self.pole_pairs / self.counts)


class SpeedColumn:
    """The shaft's speed through a first-order filter, which sees it go in a straight line from cycle to cycle."""

    def __init__(self, shaft, tau_s):
        self.shaft, self.tau_s, self.before, self.seen = shaft, tau_s, None, None

    def read(self, t_s, T_s):
        now = self.shaft.omega(t_s)
        if self.tau_s == 0.0:
            return now
        if self.seen is None:
            self.seen = now
        else:
            slope = (now - self.before) / T_s
            steady = self.before - self.tau_s * slope
            self.seen = steady + slope * T_s + (self.seen - steady) * np.exp(-T_s / self.tau_s)
        self.before = now
        return self.seen


class CurrentController:
    """PI in the rotor frame with decoupling from the nominal motor; acts one cycle after its sample.

    late_cycles: by how much more its voltages are late. A bench that runs has been tuned to that, by slower gains and
    a further advanced angle, whatever its recording says about the timing.
    """

    def __init__(self, T_s, L_d_H, L_q_H, R_ohm, psi_f_Wb, bandwidth_T, u_max_ratio, late_cycles):
        self.late_cycles = late_cycles
        self.T_s, self.L_d_H, self.L_q_H, self.R_ohm, self.psi_f_Wb = T_s, L_d_H, L_q_H, R_ohm, psi_f_Wb
        alpha = bandwidth_T / T_s
        self.alpha, self.k_i = alpha, alpha * (R_ohm + 0.12 * alpha * np.minimum(L_d_H, L_q_H))
        self.u_max_ratio = u_max_ratio
        self.integral = np.zeros(T_s.shape, complex)

    def voltage(self, i, theta_rad, omega_rad_s, i_ref_dq, u_dc_V):
        """Stationary-frame voltage for the next cycle from the sample at this one's peak (theta there)."""
        i_dq = i * np.exp(-1j * theta_rad)
        e = i_ref_dq - i_dq
        forward = 1j * omega_rad_s * (self.psi_f_Wb + self.L_d_H * i_dq.real + 1j * self.L_q_H * i_dq.imag)
        u_p = self.alpha * (self.L_d_H * e.real + 1j * self.L_q_H * e.imag) + forward
        u = u_p + self.integral
        limit = self.u_max_ratio * u_dc_V / np.sqrt(3.0)
        u_limited = u * np.minimum(1.0, limit / np.maximum(np.abs(u), 1e-9))
        self.integral = self.integral + self.T_s * self.k_i * (e + (u_limited - u) / (self.alpha * self.L_d_H))
        # From this peak to the middle of the next cycle, where its voltage acts, the rotor moves by omega T.
        return u_limited * np.exp(1j * (theta_rad + omega_rad_s * self.T_s * (1 + self.late_cycles)))


def held_leg(ratio, turned_rad=0.0, middle=False):
    """The common part that puts a leg at the rail of its voltage's sign: the leg whose voltage is the largest, or the middle one, by
    size, of the vector turned by so much."""
    seen = phases_from_vector(vector_from_phases(ratio) * np.exp(1j * turned_rad))
    leg = np.argsort(np.abs(seen), axis=0)[1 if middle else 2].reshape(1, -1)
    return (0.5 * np.sign(np.take_along_axis(seen, leg, 0)) - np.take_along_axis(ratio, leg, 0))[0]


COMMON = {"min_max": lambda r: -0.5 * (r.max(axis=0) + r.min(axis=0)), "sine": lambda r: np.zeros(r.shape[1]),
          "dpwm_min": lambda r: -0.5 - r.min(axis=0), "dpwm_max": lambda r: 0.5 - r.max(axis=0), "dpwm_1": held_leg,
          "dpwm_0": lambda r: held_leg(r, np.pi / 6.0), "dpwm_2": lambda r: held_leg(r, -np.pi / 6.0),
          "dpwm_3": lambda r: held_leg(r, middle=True)}


def duties(u, u_dc_V, timer_counts, modulator):
    """Duty cycles of a voltage vector with a modulator's common part, in timer counts."""
    ratio = phases_from_vector(u) / u_dc_V
    common = COMMON[modulator](ratio)
    return quantise(bounded(0.5 + ratio + common, 0.0, 1.0), 1.0 / timer_counts)


def record(p, machine, inverter, shaft, cycles, warm_up, rng):
    """Runs all lanes for warm_up + cycles and returns the columns as arrays (cycles, lanes) or (cycles, 3, lanes).

    p: a namespace with what the sensors, the controller and the operating points need (draw.py makes it).
    """
    lanes = inverter.T_s.shape[0]
    drive = Drive(machine, inverter, shaft, p.i_ref_dq[0] * np.exp(1j * shaft.theta(np.zeros(lanes))), p.sensor_lag_s)
    sensors = CurrentSensors(p.gain, p.offset_A, p.noise_A, p.lsb_A, p.full_scale_A, p.loose_phase, p.loose_rate,
                             p.loose_factor, p.two_sensors, rng, p.hysteresis_A, **p.pick_up)
    angle = AngleSensor(shaft, p.pole_pairs, p.encoder_counts, p.theta_0_rad, p.t_delay_s, p.order, p.amplitude_rad,
                        p.phase_rad)
    speed = SpeedColumn(shaft, p.speed_lag_s)
    control = CurrentController(inverter.T_s, p.L_d_file_H, p.L_q_file_H, p.R_file_ohm, p.psi_f_file_Wb,
                                p.bandwidth_T, p.u_max_ratio, p.delay_cycles)
    T = inverter.T_s
    R_middle_ohm, psi_middle_Wb = machine.R_ohm, machine.psi_f_Wb
    keep = {name: [] for name in ("i_A", "i_mid_A", "theta_e_rad", "omega_e_rad_s", "duty", "u_dc_V", "u_V")}
    u_dc_meas = p.u_dc_V / p.k_u
    i0 = p.i_ref_dq[0]
    first = machine.resistive_drop(i0) + 1j * shaft.omega(0.0 * T) * (
        machine.psi_f_Wb + machine.L_d_H * i0.real + 1j * machine.L_q_H * i0.imag)
    command = duties(first * np.exp(1j * (shaft.theta(0.5 * T))), u_dc_meas, p.timer_counts, p.modulator)
    commands, applied = [command, command], command
    control.integral = first - 1j * shaft.omega(0.0 * T) * (p.psi_f_file_Wb + p.L_d_file_H * i0.real
                                                             + 1j * p.L_q_file_H * i0.imag)
    for k in range(warm_up + cycles):
        t = k * T
        if p.drifts:
            # From cycle to cycle: what moves over seconds does not move within one.
            clock_s = p.clock_s + (k - warm_up) * T
            around = p.flux_share * np.cos(p.flux_order * shaft.theta(t) / p.pole_pairs + p.flux_rad)
            machine.drift_to(np.maximum(R_middle_ohm * (1.0 + p.R_share[k]) + p.R_rate_ohm_s * clock_s, 0.0),
                             psi_middle_Wb * (1.0 + p.psi_share[k] + around) + p.psi_rate_Wb_s * clock_s)
            sensors.drift_to(p.gain + p.gain_rate_s * clock_s, p.offset_A + p.offset_rate_A_s * clock_s)
        slow = 1.0 + p.u_drift * np.sin(TURN * p.u_drift_Hz * t + 1.0)
        ripple = p.u_ripple * np.sin(TURN * p.u_ripple_Hz * (t + 0.5 * T))
        u_dc_true = p.u_dc_V * (slow + ripple)
        u_dc_meas = quantise(p.u_dc_V * slow / p.k_u + p.u_dc_noise_V * rng.standard_normal(lanes), p.u_dc_lsb_V)
        sensors.contact()
        # The last edge before the valley fell with the last cycle's duty, the last before the peak rises with this one's.
        fell_s = np.where((applied > 0.0) & (applied < 1.0), 0.5 * T * (1.0 - applied), np.inf)
        i_valley = sensors.read(phases_from_vector(drive.seen()), p.clock_s + t, fell_s, -1.0)
        theta = angle.read(t)
        omega = speed.read(t, T) + p.omega_noise_rad_s * rng.standard_normal(lanes)
        missed = rng.random(lanes) < p.glitch_rate if np.any(p.glitch_rate) else np.zeros(lanes, bool)
        commands = [command] + commands[:1]
        before, applied = applied, np.where(missed, applied, commands[int(p.delay_cycles)])
        # Half a cycle late: registers that load at the peak, up to which those of the last cycle act.
        to_peak = before if p.delay_cycles % 1.0 else applied
        # A compensation of dead time and drops, as gate logic makes it: by the signs at the valley, unseen by the record.
        more = p.compensation_V / p.u_dc_V * np.sign(phases_from_vector(drive.current()))
        if p.hum_V:
            more = more + p.hum_V / p.u_dc_V * np.cos(TURN * p.hum_Hz * (p.clock_s + t)) * (np.arange(3).reshape(3, 1) == p.hum_phase)
        rose_s = np.where((to_peak > 0.0) & (to_peak < 1.0), 0.5 * T * to_peak, np.inf)
        i_mid = sensors.read(phases_from_vector(drive.advance_cycle(applied + more, u_dc_true, to_peak + more)), p.clock_s + t + 0.5 * T,
                             rose_s, 1.0)
        if drive.late_valley is not None:
            i_valley = sensors.read(phases_from_vector(drive.late_valley))
        if k >= warm_up:
            values = (i_valley, i_mid, theta, omega, command, u_dc_meas, (command - command.mean(axis=0)) * u_dc_meas)
            for column, value in zip(keep.values(), values):
                column.append(value)
        u = control.voltage(vector_from_phases(i_mid), theta + 0.5 * omega * T, omega, p.i_ref_dq[k], u_dc_meas)
        command = duties(u, u_dc_meas, p.timer_counts, p.modulator)
    return {name: np.array(column) for name, column in keep.items()}
