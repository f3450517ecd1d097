"""A second switching-level drive, written apart from sim_host/plant: the machine and the inverter.

It exists so that the diagnosis is not judged only on recordings made by this project's own physics. Everything differs
on purpose: the state is the stator flux linkage in the stationary frame,

    d psi/dt = u(t) - R i(psi, theta),

the inverter's volt-seconds enter it exactly between switching edges, and the resistive term is integrated by the
classical Runge-Kutta rule on each interval between two edges. Every quantity is an array over "lanes": the runs of one
or of several recordings advance side by side, because numpy is only fast that way.

Conventions are those of docs (consumer sign, amplitude-invariant Clarke, theta = 0 with the magnet on phase A).
Complex numbers are vectors alpha + j beta.
"""

import numpy as np

TURN = 2.0 * np.pi
# The axis of each phase in the stationary frame.
AXIS = np.exp(1j * TURN / 3.0 * np.arange(3)).reshape(3, 1)
NEWTON_STEPS = 7  # of current() with saturation and unequal phases: below 1e-12 A up to 0.7 I_sat of a salient machine


def phases_from_vector(x):
    """Three phase values, shape (3, lanes), of a vector without common part."""
    return (x * AXIS.conj()).real


def vector_from_phases(x_abc):
    """Amplitude-invariant Clarke transform; a common part of the three phases drops out."""
    return (2.0 / 3.0) * (x_abc * AXIS).sum(axis=0)


def bounded(x, low, high):
    """np.clip of so few values, in a third of its time."""
    return np.minimum(np.maximum(x, low), high)


class FluxMap:
    """Iron that saturates and crosses over, as an algebraic law of the flux: no polynomial of the current.

    In the rotor frame, with a magnet of flux psi_f on the d axis, i = g(psi) - g(psi_f) with

        g_d = (1/L_d + a_d |psi_d|^S + c/(V + 2) |psi_d|^U |psi_q|^(V + 2)) psi_d
        g_q = (1/L_q + a_q |psi_q|^T + c/(U + 2) |psi_d|^(U + 2) |psi_q|^V) psi_q

    (Hinkkanen et al., 2017, found that it meets measured machines.) g is the gradient of an energy.
    """

    def __init__(self, psi_f_Wb, L_d_H, L_q_H, a_d, a_q, c, S=5.0, T=1.0, U=1.0, V=0.0):
        self.psi_f_Wb, self.L_d_H, self.L_q_H = psi_f_Wb, L_d_H, L_q_H
        self.a_d, self.a_q, self.c, self.powers = a_d, a_q, c, (S, T, U, V)

    def _g(self, psi):
        S, T, U, V = self.powers
        d, q = np.abs(psi.real), np.abs(psi.imag)
        return ((1.0 / self.L_d_H + self.a_d * d ** S + self.c / (V + 2.0) * d ** U * q ** (V + 2.0)) * psi.real
                + 1j * (1.0 / self.L_q_H + self.a_q * q ** T + self.c / (U + 2.0) * d ** (U + 2.0) * q ** V) * psi.imag)

    def current(self, psi):
        """Current of a flux, rotor frame."""
        return self._g(psi) - self._g(np.array([self.psi_f_Wb + 0.0j]))

    def flux(self, i):
        """Flux of a current, rotor frame: by Newton's method, differences for the slope."""
        psi = self.psi_f_Wb + 0.5 * (self.L_d_H * np.real(i) + 1j * self.L_q_H * np.imag(i))
        h = 1e-6 * (np.abs(psi).max() + self.L_q_H)
        for _ in range(60):
            left = i - self.current(psi)
            by_d = (self.current(psi + h) - self.current(psi - h)) / (2.0 * h)
            by_q = (self.current(psi + 1j * h) - self.current(psi - 1j * h)) / (2.0 * h)
            det = by_d.real * by_q.imag - by_q.real * by_d.imag
            step = ((by_q.imag * left.real - by_q.real * left.imag)
                    + 1j * (by_d.real * left.imag - by_d.imag * left.real)) / det
            psi = psi + step
            if np.abs(step).max() < 1e-13 * (np.abs(psi).max() + 1e-9):
                break
        return psi


class Machine:
    """A PMSM from flux linkages: saliency, saturation, flux harmonics, unequal phases, eddy currents.

    The arguments are scalars or arrays over lanes. I_sat_A = inf is no saturation, R_iron_ohm = inf no iron loss.

    dL_H is added to the inductance of each phase: phase x links dL_x i_x more. As a vector that is
    2/3 sum dL_x i_x a_x = m i + c conj(i), fixed to the stator and untouched by saturation; i is the magnetising
    current, so that eddy currents lie around this part of the flux as around the rest. The star point's voltage drops
    out of the vector, as it does of the legs' voltages.
    """

    def __init__(self, lanes, R_ohm, L_d_H, L_q_H, psi_f_Wb, psi_5_Wb=0.0, psi_7_Wb=0.0, I_sat_A=np.inf,
                 dR_ohm=(0.0, 0.0, 0.0), R_iron_ohm=np.inf, tau_iron_s=1e-4,
                 dL_H=(0.0, 0.0, 0.0), psi_11_Wb=0.0, psi_13_Wb=0.0, flux_map=None, weak_pole=0.0, pole_pairs=1, short=None):
        def spread(x):
            return np.broadcast_to(np.asarray(x, float), (lanes,)).copy()

        self.R_ohm, self.L_d_H, self.L_q_H = spread(R_ohm), spread(L_d_H), spread(L_q_H)
        self.psi_f_Wb, self.psi_5_Wb, self.psi_7_Wb = spread(psi_f_Wb), spread(psi_5_Wb), spread(psi_7_Wb)
        self.psi_11_Wb, self.psi_13_Wb = spread(psi_11_Wb), spread(psi_13_Wb)
        self.I_sat_A, self.R_iron_ohm, self.tau_iron_s = spread(I_sat_A), spread(R_iron_ohm), spread(tau_iron_s)
        dR = np.array([spread(x) for x in dR_ohm])
        # 2/3 sum dR_x i_x a_x of a current without common part is this pair of factors on i and on its conjugate.
        self.R_mean_ohm = self.R_ohm + dR.mean(axis=0)
        self.R_conj_ohm = (dR * AXIS ** 2).sum(axis=0) / 3.0
        self.saturates = bool(np.isfinite(self.I_sat_A).any())
        self.has_harmonics = any(np.any(x) for x in (self.psi_5_Wb, self.psi_7_Wb, self.psi_11_Wb, self.psi_13_Wb))
        self.is_unequal = bool(np.any(dR))
        dL = np.array([spread(x) for x in dL_H])
        self.L_mean_H, self.L_conj_H = dL.mean(axis=0), (dL * AXIS ** 2).sum(axis=0) / 3.0
        self.has_unequal_inductance = bool(np.any(dL))
        self.has_iron = bool(np.isfinite(self.R_iron_ohm).any())
        # Takes the place of the inductances, of saturation and of the magnet's fundamental.
        self.flux_map = flux_map
        # By how much the flux dips over one pole pair.
        self.weak_pole, self.pole_pairs = weak_pole, pole_pairs
        # (share of the turns, ohms of the fault, its current's time constant, phase): in place of the iron.
        self.short = short
        if short is not None:
            if self.has_iron:
                raise ValueError("a short between turns and an iron loss at once")
            self.has_iron = True

    def drift_to(self, R_ohm, psi_f_Wb):
        """R and psi_f from now on. The flux linkage stays: a magnet that weakens is answered by the current."""
        self.R_mean_ohm = self.R_mean_ohm + (R_ohm - self.R_ohm)
        self.R_ohm, self.psi_f_Wb = R_ohm, psi_f_Wb

    def magnet_flux_dq(self, theta_rad):
        """Flux of the magnet in the rotor frame; the 5th turns backwards at 5, the 7th forwards at 7 times theta, and so on."""
        if self.weak_pole:
            # Half a cosine squared where the first pole pair passes.
            turn = TURN * self.pole_pairs
            around = np.mod(theta_rad + 0.5 * turn, turn) - 0.5 * turn
            return self.psi_f_Wb * (1.0 - np.where(np.abs(around) < np.pi, self.weak_pole * np.cos(0.5 * around) ** 2, 0.0))
        if not self.has_harmonics:
            return self.psi_f_Wb
        sixth = np.exp(6j * theta_rad)
        twelfth = sixth * sixth
        return (self.psi_f_Wb + self.psi_5_Wb * sixth.conj() + self.psi_7_Wb * sixth
                + self.psi_11_Wb * twelfth.conj() + self.psi_13_Wb * twelfth)

    def _size(self, y):
        """How large a current in the rotor frame is for the iron: by the energy 1/2 (L_d i_d^2 + L_q i_q^2) that it
        would store unsaturated. Of that energy the flux is a gradient; no other measure conserves it."""
        if not self.saturates:
            return np.abs(y)
        return np.sqrt(2.0 * (self.L_d_H * y.real ** 2 + self.L_q_H * y.imag ** 2) / (self.L_d_H + self.L_q_H))

    def _linear_factors(self, theta_rad):
        """p (real) and q of x = p i + q conj(i): flux beyond the magnet's over current, without saturation."""
        p = 0.5 * (self.L_d_H + self.L_q_H) + self.L_mean_H
        return p, 0.5 * (self.L_d_H - self.L_q_H) * np.exp(2j * theta_rad) + self.L_conj_H

    def _current_of_unequal_phases(self, psi, theta_rad):
        """current() where the phases' inductances differ: by the inverse, and by Newton's method if it saturates."""
        x = psi - self.magnet_flux_dq(theta_rad) * np.exp(1j * theta_rad)
        p, q = self._linear_factors(theta_rad)
        i = (p * x - q * x.conj()) / (p ** 2 - np.abs(q) ** 2)
        if not self.saturates:
            return i
        i = i * np.minimum(1.0, 0.9 * self.I_sat_A / np.maximum(self._size(i * np.exp(-1j * theta_rad)), 1e-30))
        for _ in range(NEWTON_STEPS):
            # flux(i + d) - flux(i) is p d + q conj(d) to first order: the part in the rotor frame, divided by
            # 1 + s, s = (|i|/I_sat)^2, and what that division changes; then the stator's part.
            rotor = np.exp(1j * theta_rad)
            y = i * rotor.conj()
            s = (self._size(y) / self.I_sat_A) ** 2
            linear = (self.L_d_H * y.real + 1j * self.L_q_H * y.imag) * rotor
            p = 0.5 * (self.L_d_H + self.L_q_H) / (1.0 + s) + self.L_mean_H
            q = 0.5 * (self.L_d_H - self.L_q_H) * rotor ** 2 / (1.0 + s) + self.L_conj_H
            # d s = 2 Re(conj(h) d) / I_sat^2 with h half the gradient of _size squared, and 2 Re(conj(h) d) =
            # conj(h) d + h conj(d).
            h = linear * 2.0 / (self.L_d_H + self.L_q_H)
            bend = -linear / ((1.0 + s) * self.I_sat_A) ** 2
            p, q = p + bend * h.conj(), q + bend * h
            left = psi - self.flux(i, theta_rad)
            i = i + (p.conj() * left - q * left.conj()) / (np.abs(p) ** 2 - np.abs(q) ** 2)
        return i

    def current(self, psi, theta_rad):
        """Magnetising current of a flux linkage."""
        return self.current_at(psi, self.place(theta_rad))

    def place(self, theta_rad):
        """An angle, its unit vector and its conjugate, and the magnet's flux there: for all fluxes that meet the same rotor."""
        rotor = np.exp(1j * theta_rad)
        return theta_rad, rotor, rotor.conj(), self.magnet_flux_dq(theta_rad)

    def current_at(self, psi, place):
        """The same at a place."""
        theta_rad, rotor, rotor_conj, magnet = place
        if self.has_unequal_inductance:
            return self._current_of_unequal_phases(psi, theta_rad)
        if self.flux_map is not None:
            return self.flux_map.current(psi * rotor_conj - magnet + self.psi_f_Wb) * rotor
        x = psi * rotor_conj - magnet
        y = x.real / self.L_d_H + 1j * (x.imag / self.L_q_H)
        if self.saturates:
            # psi/L_0 = y = i/(1 + (size/I_sat)^2), solved for i. The flux has its maximum at I_sat: the clip keeps an
            # overload on this side of it.
            m = np.minimum(self._size(y) / self.I_sat_A, 0.499)
            s = 2.0 * m / (1.0 + np.sqrt(1.0 - 4.0 * m * m))
            y = y * (1.0 + s * s)
        return y * rotor

    def flux(self, i, theta_rad):
        """Flux linkage of a magnetising current: the inverse of current()."""
        rotor = np.exp(1j * theta_rad)
        y = i * rotor.conj()
        if self.flux_map is not None:
            return (self.flux_map.flux(y) + self.magnet_flux_dq(theta_rad) - self.psi_f_Wb) * rotor
        y = y / (1.0 + (self._size(y) / self.I_sat_A) ** 2)
        psi = (self.L_d_H * y.real + 1j * self.L_q_H * y.imag + self.magnet_flux_dq(theta_rad)) * rotor
        if self.has_unequal_inductance:
            psi = psi + self.L_mean_H * i + self.L_conj_H * np.conj(i)
        return psi

    def resistive_drop(self, i):
        drop = self.R_mean_ohm * i
        if self.is_unequal:
            drop = drop + self.R_conj_ohm * i.conj()
        return drop

    def derivative(self, psi, i_iron, place, u):
        """d psi/dt and d i_iron/dt."""
        return self.derivative_of(self.current_at(psi, place), i_iron, u)

    def derivative_of(self, i, i_iron, u):
        """The same by the magnetising current. Eddy currents are a short-circuited path: they follow d psi/dt / R_iron late."""
        if not self.has_iron:
            return u - self.resistive_drop(i), 0.0
        if self.short is not None:
            return self._shorted(i, i_iron, u)
        d_psi = u - self.resistive_drop(i + i_iron)
        return d_psi, (d_psi / self.R_iron_ohm - i_iron) / self.tau_iron_s

    def _shorted(self, i, extra, u):
        """The same with a share of a phase's turns around a fault: its current i_f adds 2/3 share i_f along the phase's axis.

        The faulted turns see their share of the phase's voltage, R of its current and what changes the flux; the magnetising
        current alone makes the flux, so that it alone drops R there.
        """
        share, fault_ohm, tau_s, phase = self.short
        axis = AXIS[phase]
        d_psi = u - self.resistive_drop(i)
        around = fault_ohm + share * self.R_ohm
        i_fault = 1.5 / share * (extra * axis.conj()).real
        drive = share * (self.R_ohm * ((i + extra) * axis.conj()).real + (d_psi * axis.conj()).real)
        return d_psi, 2.0 / 3.0 * share * axis * (drive / around - i_fault) / tau_s

    def inverse_inductance(self, theta_rad):
        """1/L along each phase's axis, shape (3, lanes): how fast a leg's voltage moves its own current."""
        if self.has_unequal_inductance:
            # A volt on leg x alone is the vector 2/3 a_x; the component along a_x of the current's slope.
            p, q = self._linear_factors(theta_rad)
            return (p - (q * AXIS.conj() ** 2).real) / (p ** 2 - np.abs(q) ** 2)
        angle = theta_rad - np.angle(AXIS)
        return np.cos(angle) ** 2 / self.L_d_H + np.sin(angle) ** 2 / self.L_q_H


class Shaft:
    """A speed forced from outside: constant plus a slow swing, so that the angle is known in closed form."""

    def __init__(self, theta_start_rad, omega_rad_s, swing_rad_s, swing_Hz, swing_phase_rad):
        self.theta_start_rad, self.omega_mean_rad_s = theta_start_rad, omega_rad_s
        self.swing_rad_s, self.rate_rad_s, self.phase_rad = swing_rad_s, TURN * swing_Hz, swing_phase_rad

    def theta(self, t_s):
        swung = np.cos(self.phase_rad) - np.cos(self.rate_rad_s * t_s + self.phase_rad)
        return self.theta_start_rad + self.omega_mean_rad_s * t_s + self.swing_rad_s / self.rate_rad_s * swung

    def omega(self, t_s):
        return self.omega_mean_rad_s + self.swing_rad_s * np.sin(self.rate_rad_s * t_s + self.phase_rad)


class RampedShaft:
    """A speed forced from outside that goes in a straight line: so much at begin_s, so much more each second."""

    def __init__(self, theta_start_rad, omega_rad_s, slope_rad_s2, begin_s):
        self.theta_start_rad, self.slope_rad_s2 = theta_start_rad, slope_rad_s2
        self.omega_start_rad_s = omega_rad_s - slope_rad_s2 * begin_s

    def theta(self, t_s):
        return self.theta_start_rad + self.omega_start_rad_s * t_s + 0.5 * self.slope_rad_s2 * t_s ** 2

    def omega(self, t_s):
        return self.omega_start_rad_s + self.slope_rad_s2 * t_s


class Inverter:
    """Two-level legs, centre-aligned (high around T/2), with dead time and constant device drops."""

    def __init__(self, lanes, T_s, t_dead_s=0.0, V_switch_V=0.0, V_diode_V=0.0):
        self.T_s = np.broadcast_to(np.asarray(T_s, float), (lanes,)).copy()
        self.t_dead_s = np.broadcast_to(np.asarray(t_dead_s, float), (lanes,)).copy()
        self.V_switch_V = np.broadcast_to(np.asarray(V_switch_V, float), (lanes,)).copy()
        self.V_diode_V = np.broadcast_to(np.asarray(V_diode_V, float), (lanes,)).copy()
        self.has_dead_time = bool(np.any(self.t_dead_s))
        self.has_drops = bool(np.any(self.V_switch_V) or np.any(self.V_diode_V))

    def instants(self, duty, duty_to_peak, also_s=(), at_rail=False):
        """Sorted instants within the cycle at which anything may change, and those of `also_s`; from 0 to T, shape (n, lanes)."""
        rise, fall = self.edges(duty, duty_to_peak)
        zero = np.zeros((1,) + self.T_s.shape)
        rows = [zero, rise, fall, zero + 0.5 * self.T_s, zero + self.T_s] + [zero + t for t in also_s]
        if self.has_dead_time:
            # A leg that goes to the high rail or comes back does so at the cycle's start.
            rows += [rise + self.t_dead_s, fall + self.t_dead_s] + [zero + self.t_dead_s] * bool(at_rail)
        return np.sort(np.minimum(np.concatenate(rows), self.T_s), axis=0)

    def edges(self, duty, duty_to_peak):
        """Commanded instants: rise of each leg, fall of each leg. The carrier meets one register on its way up to the
        peak and perhaps another on its way down; a leg that changes between them does so at the peak."""
        return 0.5 * self.T_s * (1.0 - duty_to_peak), 0.5 * self.T_s * (1.0 + duty)

    def pulses(self, duty, duty_to_peak, was_high=False):
        """A cycle's edges, and which legs begin and end it high, pulse in it, and leave or enter the high rail at its start.

        A leg that is held at a rail has no edge but the one at the cycle's start that brings it there from the high rail, or to it;
        was_high: the legs that end the cycle before there.
        """
        begins_high = duty_to_peak >= 1.0
        return (*self.edges(duty, duty_to_peak), begins_high, duty >= 1.0, (duty > 0.0) | (duty_to_peak > 0.0), begins_high != was_high)

    def leg_voltages(self, cycle, at_s, i_abc, u_dc_V):
        """Voltages of the legs against the negative rail at an instant between the edges of a cycle (pulses), and which legs have both off
        (None: no dead time).

        After a switch turns off, the other waits for t_dead: meanwhile a positive current flows through the lower
        diode, a negative one through the upper.
        """
        rise, fall, begins_high, ends_high, pulses, starts = cycle
        out_of_motor = i_abc < 0.0
        high = pulses & (begins_high | (at_s > rise + self.t_dead_s)) & (ends_high | (at_s < fall))
        off = None
        if self.has_dead_time:
            off = (pulses & ~begins_high & (at_s > rise) & (at_s < rise + self.t_dead_s)) | (
                pulses & ~ends_high & (at_s > fall) & (at_s < fall + self.t_dead_s)) | (starts & (at_s < self.t_dead_s))
            high = high & ~off
        v = np.where(high if off is None else high | (off & out_of_motor), u_dc_V, 0.0)
        if self.has_drops:
            # Into the motor: upper switch or lower diode. Out of it: upper diode or lower switch.
            low = ~high if off is None else ~high & ~off
            through_switch = (high & ~out_of_motor) | (low & out_of_motor)
            v = v - np.where(out_of_motor, -1.0, 1.0) * np.where(through_switch, self.V_switch_V, self.V_diode_V)
        return v, off


class Drive:
    """Machine and inverter, advanced by whole PWM cycles.

    lag_s: the current is seen through a first-order filter of that time constant; or, if negative, sampled late by
    that time. What a late sample at the valley sees is known only after the cycle, in late_valley.
    """

    def __init__(self, machine, inverter, shaft, i_start=0.0, lag_s=0.0):
        self.machine, self.inverter, self.shaft = machine, inverter, shaft
        self.t_s = np.zeros_like(inverter.T_s)
        self.psi = machine.flux(np.zeros_like(self.t_s) + i_start, shaft.theta(self.t_s))
        self.i_iron = np.zeros_like(self.psi)
        self.lag_s, self.filtered, self.late_valley = lag_s, self.current(), None
        self.was_high = False

    def seen(self):
        """The current at the sensors now; for late samples see late_valley."""
        return self.filtered if self.lag_s > 0.0 else self.current()

    def _filter(self, h_s, i_before):
        """The filter's answer to a current that goes from i_before to what it is now in a straight line."""
        slope = (self.current() - i_before) / np.where(h_s > 0.0, h_s, 1.0)
        steady = i_before - self.lag_s * slope
        self.filtered = steady + slope * h_s + (self.filtered - steady) * np.exp(-h_s / self.lag_s)

    def current(self):
        """The current that the terminals see, as a vector."""
        return self._with_iron(self.machine.current(self.psi, self.shaft.theta(self.t_s)))

    def _with_iron(self, i):
        """What the terminals see of a magnetising current."""
        return i + self.i_iron if self.machine.has_iron else i

    def _step(self, h_s, u, i0, middle, end):
        """Classical Runge-Kutta over h_s with constant u: the magnetising current at its start, places at its middle and end."""
        f, p, e = self.machine.derivative, self.psi, self.i_iron
        k1, m1 = self.machine.derivative_of(i0, e, u)
        k2, m2 = f(p + 0.5 * h_s * k1, e + 0.5 * h_s * m1, middle, u)
        k3, m3 = f(p + 0.5 * h_s * k2, e + 0.5 * h_s * m2, middle, u)
        k4, m4 = f(p + h_s * k3, e + h_s * m3, end, u)
        return p + h_s / 6.0 * (k1 + 2.0 * (k2 + k3) + k4), e + h_s / 6.0 * (m1 + 2.0 * (m2 + m3) + m4)

    def advance_cycle(self, duty, u_dc_V, duty_to_peak=None):
        """One PWM cycle with the duties (3, lanes), others up to the peak if given; returns the current at the carrier
        peak, as a vector: as the sensors see it."""
        duty_to_peak = duty if duty_to_peak is None else duty_to_peak
        late_s = max(-self.lag_s, 0.0)
        inv, also_s = self.inverter, (late_s, 0.5 * self.inverter.T_s + late_s) if late_s else ()
        at = inv.instants(duty, duty_to_peak, also_s, np.any(duty_to_peak >= 1.0) or np.any(self.was_high))
        t0_s, i_mid, self.late_valley = self.t_s, None, None
        theta, place = self.shaft.theta, self.machine.place
        start, no_current = place(theta(t0_s)), np.zeros_like(at[:3])
        pulses = inv.pulses(duty, duty_to_peak, self.was_high)
        for a, b in zip(at[:-1], at[1:]):
            h, t_mid = b - a, 0.5 * (a + b)
            i_magnet = self.machine.current_at(self.psi, start)
            i_before = self._with_iron(i_magnet)
            middle, end = place(theta(t0_s + t_mid)), place(theta(t0_s + b))
            # Only dead time and device drops ask for the currents' signs.
            i_abc = phases_from_vector(i_before) if inv.has_dead_time or inv.has_drops else no_current
            v, off = inv.leg_voltages(pulses, t_mid, i_abc, u_dc_V)
            u = vector_from_phases(v)
            psi, i_iron = self._step(h, u, i_magnet, middle, end)
            if off is not None and off.any():
                u = self._clamp(u, v, off & (h > 0.0), i_abc, psi, i_iron, h, middle, end, u_dc_V)
                if u is not None:
                    psi, i_iron = self._step(h, u, i_magnet, middle, end)
            self.psi, self.i_iron, self.t_s, start = psi, i_iron, t0_s + b, end
            if self.lag_s > 0.0:
                self._filter(h, i_before)
            i_mid = self._kept(i_mid, b == 0.5 * inv.T_s + late_s)
            if late_s:
                self.late_valley = self._kept(self.late_valley, b == late_s)
        self.was_high = duty >= 1.0
        return i_mid

    def _kept(self, before, now):
        """What is seen, in those lanes whose instant it is."""
        if not now.any():
            return before
        return self.seen() if before is None else np.where(now, self.seen(), before)

    def _clamp(self, u, v, off, i_abc, psi, i_iron, h, middle, end, u_dc_V):
        """A diode does not carry its current through zero: the leg floats at the voltage that leaves it there.

        Over so short an interval as the dead time, the mean voltage that brings the current to zero at the end of
        the interval stands for "diode until zero, then floating". Where two legs would cross, the third has no way
        back either, and the whole vector goes to zero. None: no leg needs it.
        """
        i_end = self.machine.current_at(psi, end) + (i_iron if self.machine.has_iron else 0.0)
        i_end = phases_from_vector(i_end)
        crossed = off & (i_end * np.where(i_abc < 0.0, -1.0, 1.0) < 0.0)
        if not crossed.any():
            return None
        span = np.where(h > 0.0, h, 1.0)
        per_volt = (2.0 / 3.0) * span * self.machine.inverse_inductance(middle[0])
        drop = self.inverter.V_diode_V
        floating = np.where(crossed, bounded(v - i_end / per_volt, -drop, u_dc_V + drop), v)
        to_zero = u + (self.machine.flux(0.0, end[0]) - psi) / span
        # No more than the rails can give.
        to_zero = to_zero * np.minimum(1.0, (2.0 / 3.0) * u_dc_V / np.maximum(np.abs(to_zero), 1e-9))
        return np.where(crossed.sum(axis=0) > 1, to_zero, vector_from_phases(floating))
