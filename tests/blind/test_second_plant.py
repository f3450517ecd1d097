#!/usr/bin/python3
"""The second plant against an independent integrator and closed forms; the recordings' format; the scoring itself."""

import os
import sys
import tempfile
import unittest

import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import averaged
import draw
import effects
import generate
import reading
import score
from second_plant import Drive, Inverter, Machine, Shaft, phases_from_vector, vector_from_phases


def steady_shaft(omega, theta=0.0):
    return Shaft(np.array([theta]), np.array([omega]), np.array([0.0]), np.array([1.0]), np.array([0.0]))


def scalar_reference(m, omega, theta0, duty, u_dc, T, i0, cycles):
    """The same machine in rotor-frame currents, integrated by scipy from edge to edge at tight tolerance."""
    axis = np.exp(2j * np.pi / 3.0 * np.arange(3))

    def rhs(t, y, v):
        theta = theta0 + omega * t
        i_dq = y[0] + 1j * y[1]
        phases = (i_dq * np.exp(1j * theta) * axis.conj()).real
        lost = np.sum((2.0 / 3.0) * (m["R"] + m["dR"]) * phases * axis)
        u_dq = (np.sum((2.0 / 3.0) * v * axis) - lost) * np.exp(-1j * theta)
        # Magnet: psi_f + psi_5 e^{-6j theta} + psi_7 e^{6j theta}, its rotor-frame derivative and j omega of itself.
        sixth = np.exp(6j * theta)
        magnet = m["psi_f"] + m["psi_5"] / sixth + m["psi_7"] * sixth
        moved = 6j * omega * (m["psi_7"] * sixth - m["psi_5"] / sixth)
        flux = m["L_d"] * y[0] + 1j * m["L_q"] * y[1] + magnet
        e = u_dq - 1j * omega * flux - moved
        return [e.real / m["L_d"], e.imag / m["L_q"]]

    y = i0 * np.exp(-1j * theta0)
    y = [y.real, y.imag]
    for k in range(cycles):
        edges = np.sort(np.concatenate([[0.0, T], 0.5 * T * (1 - duty), 0.5 * T * (1 + duty)]))
        for a, b in zip(edges[:-1], edges[1:]):
            middle = 0.5 * (a + b)
            v = np.where((middle > 0.5 * T * (1 - duty)) & (middle < 0.5 * T * (1 + duty)), u_dc, 0.0)
            y = solve_ivp(rhs, (k * T + a, k * T + b), y, args=(v,), rtol=1e-12, atol=1e-12, method="DOP853").y[:, -1]
    return (y[0] + 1j * y[1]) * np.exp(1j * (theta0 + omega * cycles * T))


def phase_reference(m, omega, theta0, duty, u_dc, T, i0, cycles):
    """Unequal phase inductances, in phase coordinates with the star point's voltage as an unknown.

    u_x - u_star = (R + dR_x) i_x + d psi_x/dt + dL_x d i_x/dt and d(i_a + i_b + i_c)/dt = 0, four equations for three
    slopes and u_star; psi_x = sum_y L_xy(theta) i_y + psi_f cos(theta - x), of a salient machine without saturation.
    """
    x = 2.0 * np.pi / 3.0 * np.arange(3)
    mean, swing = 0.5 * (m["L_d"] + m["L_q"]), 0.5 * (m["L_d"] - m["L_q"])
    away, both = x[:, None] - x[None, :], x[:, None] + x[None, :]

    def rhs(t, i, v):
        theta = theta0 + omega * t
        inductance = 2.0 / 3.0 * (mean * np.cos(away) + swing * np.cos(2.0 * theta - both)) + np.diag(m["dL"])
        turned = -4.0 / 3.0 * swing * np.sin(2.0 * theta - both)
        emf = omega * (turned @ i - m["psi_f"] * np.sin(theta - x))
        system = np.zeros((4, 4))
        system[:3, :3], system[:3, 3], system[3, :3] = inductance, 1.0, 1.0
        return np.linalg.solve(system, np.append(v - (m["R"] + m["dR"]) * i - emf, 0.0))[:3]

    i = (i0 * np.exp(-1j * x)).real
    for k in range(cycles):
        edges = np.sort(np.concatenate([[0.0, T], 0.5 * T * (1 - duty), 0.5 * T * (1 + duty)]))
        for a, b in zip(edges[:-1], edges[1:]):
            middle = 0.5 * (a + b)
            v = np.where((middle > 0.5 * T * (1 - duty)) & (middle < 0.5 * T * (1 + duty)), u_dc, 0.0)
            i = solve_ivp(rhs, (k * T + a, k * T + b), i, args=(v,), rtol=1e-12, atol=1e-12, method="DOP853").y[:, -1]
    return np.sum(2.0 / 3.0 * i * np.exp(1j * x))


class Plant(unittest.TestCase):
    def test_agrees_with_solve_ivp(self):
        T, u_dc = 1.0 / 5000.0, 560.0
        cases = [  # omega up to eight cycles per turn, reverse and standstill; salient or not; harmonics; unequal R
            (2.0 * np.pi * 625.0, 5e-3, 5e-3, 0.0, 0.0, 0.0),
            (-2.0 * np.pi * 300.0, 4e-3, 9e-3, 0.0, 0.0, 0.0),
            (0.0, 4e-3, 9e-3, 0.0, 0.0, 0.6),
            (2.0 * np.pi * 400.0, 4e-3, 8e-3, 0.004, -0.003, 0.5)]
        duty = np.array([0.62, 0.37, 0.51])
        for omega, L_d, L_q, psi_5, psi_7, dR_a in cases:
            with self.subTest(omega=omega, L_q=L_q, psi_5=psi_5, dR_a=dR_a):
                m = {"R": 0.8, "L_d": L_d, "L_q": L_q, "psi_f": 0.12, "psi_5": psi_5, "psi_7": psi_7,
                     "dR": np.array([dR_a, 0.0, 0.0])}
                machine = Machine(1, 0.8, L_d, L_q, 0.12, psi_5, psi_7, dR_ohm=(dR_a, 0.0, 0.0))
                drive = Drive(machine, Inverter(1, T), steady_shaft(omega, 0.4), 3.0 - 5.0j)
                for _ in range(3):
                    drive.advance_cycle(duty.reshape(3, 1), u_dc)
                expected = scalar_reference(m, omega, 0.4, duty, u_dc, T, 3.0 - 5.0j, 3)
                # Runge-Kutta from edge to edge leaves at most 5e-8 of the current here (measured); sensors see 1e-3.
                self.assertLess(abs(drive.current()[0] - expected), 2e-7 * abs(expected))

    def test_unequal_inductances_agree_with_the_phase_equations(self):
        T, u_dc, duty = 1.0 / 5000.0, 560.0, np.array([0.62, 0.37, 0.51])
        cases = [  # round and salient, fast, reverse and standstill; one phase, two, up and down; unequal R too
            (2.0 * np.pi * 500.0, 5e-3, 5e-3, (1e-3, 0.0, 0.0), (0.0, 0.0, 0.0)),
            (-2.0 * np.pi * 300.0, 4e-3, 9e-3, (0.0, -1e-3, 0.0), (0.0, 0.0, 0.0)),
            (0.0, 4e-3, 9e-3, (0.0, 0.0, 2e-3), (0.0, 0.0, 0.0)),
            (2.0 * np.pi * 400.0, 4e-3, 8e-3, (7e-4, 0.0, -9e-4), (0.5, 0.0, 0.0))]
        for omega, L_d, L_q, dL, dR in cases:
            with self.subTest(omega=omega, L_q=L_q, dL=dL):
                m = {"R": 0.8, "L_d": L_d, "L_q": L_q, "psi_f": 0.12, "dL": np.array(dL), "dR": np.array(dR)}
                machine = Machine(1, 0.8, L_d, L_q, 0.12, dR_ohm=dR, dL_H=dL)
                drive = Drive(machine, Inverter(1, T), steady_shaft(omega, 0.4), 3.0 - 5.0j)
                equal = Drive(Machine(1, 0.8, L_d, L_q, 0.12, dR_ohm=dR), Inverter(1, T), steady_shaft(omega, 0.4), 3.0 - 5.0j)
                for _ in range(3):
                    drive.advance_cycle(duty.reshape(3, 1), u_dc)
                    equal.advance_cycle(duty.reshape(3, 1), u_dc)
                expected = phase_reference(m, omega, 0.4, duty, u_dc, T, 3.0 - 5.0j, 3)
                self.assertLess(abs(drive.current()[0] - expected), 2e-7 * abs(expected))
                self.assertGreater(abs(equal.current()[0] - expected), 1e-2 * abs(expected))

    def test_equal_additions_are_an_inductance(self):
        psi, theta = np.array([0.1 - 0.05j]), np.array([0.7])
        added, larger = Machine(1, 1.0, 4e-3, 9e-3, 0.1, dL_H=(1e-3,) * 3), Machine(1, 1.0, 5e-3, 10e-3, 0.1)
        self.assertLess(abs(added.current(psi, theta) - larger.current(psi, theta))[0], 1e-12)
        np.testing.assert_allclose(added.inverse_inductance(theta), larger.inverse_inductance(theta), rtol=1e-12)

    def test_the_mean_flux_of_a_weak_pole(self):
        machine = Machine(1, 1.0, 4e-3, 9e-3, 0.1, weak_pole=0.3, pole_pairs=4)
        around = machine.magnet_flux_dq(np.linspace(0.0, 8.0 * np.pi, 2880, endpoint=False))
        model = averaged.no_effect()
        model.psi_f_Wb, model.weak_pole = 0.1, 0.3
        self.assertAlmostEqual(np.mean(around), draw.mean_flux_Wb(model, 4), places=12)
        self.assertAlmostEqual(draw.mean_flux_Wb(model, 4), 0.1 * (1.0 - 0.15 / 4.0), places=12)

    def test_inverse_inductance_is_the_slope(self):
        machine, theta = Machine(1, 0.0, 4e-3, 9e-3, 0.1, dL_H=(1e-3, 0.0, -5e-4)), np.array([0.7])
        psi, small = np.array([0.1 - 0.05j]), 1e-6
        for x in range(3):
            more = vector_from_phases(small * np.eye(3)[:, x:x + 1])
            step = phases_from_vector(machine.current(psi + more, theta) - machine.current(psi, theta))[x, 0]
            self.assertAlmostEqual(step / small / (2.0 / 3.0 * machine.inverse_inductance(theta)[x, 0]), 1.0, 6)

    def test_short_circuit_reaches_its_phasor(self):
        omega, R, L, psi, T = 900.0, 0.9, 5e-3, 0.15, 2e-4
        for R_iron, tau in ((np.inf, 1e-4), (60.0, 1e-4)):
            machine = Machine(1, R, L, L, psi, R_iron_ohm=R_iron, tau_iron_s=tau)
            drive = Drive(machine, Inverter(1, T), steady_shaft(omega))
            for _ in range(1500):
                drive.advance_cycle(np.full((3, 1), 0.5), 300.0)
            # psi_total = L i_m + psi, 0 = R (i_m + i_iron) + j omega psi_total,
            # i_iron (1 + j omega tau) = j omega psi_total / R_iron
            y = 1j * omega / R_iron / (1.0 + 1j * omega * tau) if np.isfinite(R_iron) else 0.0
            i_m = -psi * (1j * omega + R * y) / (R + L * (1j * omega + R * y))
            expected = (i_m + y * (L * i_m + psi)) * np.exp(1j * drive.shaft.theta(drive.t_s))[0]
            self.assertLess(abs(drive.current()[0] - expected), 1e-5 * abs(expected))

    def test_power_balance_over_a_turn(self):
        # With no copper loss, what the legs put in over whole turns of a steady state is omega times the torque:
        # 1.5 psi_f omega i_q on average. Sampled at valleys only, so a slow turn and small ripple are needed.
        omega, T, L, psi, u_dc = 2.0 * np.pi * 50.0, 1e-4, 20e-3, 0.5, 600.0
        drive = Drive(Machine(1, 0.0, L, L, psi), Inverter(1, T), steady_shaft(omega), 8.0j)
        power, i_q = [], []
        for k in range(200):
            theta_mid = omega * (k + 0.5) * T
            u = 1j * omega * (psi + 1j * L * 8.0) * np.exp(1j * theta_mid)
            before = drive.current()[0]
            peak = drive.advance_cycle(0.5 + phases_from_vector(np.array([u])) / u_dc, u_dc)[0]
            mean = (before + 4.0 * peak + drive.current()[0]) / 6.0
            power.append(1.5 * (u * np.conj(mean)).real)
            i_q.append((peak * np.exp(-1j * theta_mid)).imag)
        self.assertLess(abs(np.mean(power) / (1.5 * psi * omega * np.mean(i_q)) - 1.0), 2e-3)

    def test_saturation_stores_energy(self):
        """The flux is a gradient: both cross inductances alike, salient or not."""
        machine = Machine(1, 1.0, 4e-3, 9e-3, 0.1, I_sat_A=50.0)
        angle, h = np.array([0.0]), 1e-4
        for i in (20.0 + 30.0j, -35.0 + 10.0j, 5.0 - 25.0j):
            def flux(more):
                return machine.flux(np.array([i + more]), angle)[0]
            d_by_q = (flux(1j * h) - flux(-1j * h)).real / (2.0 * h)
            q_by_d = (flux(h) - flux(-h)).imag / (2.0 * h)
            self.assertGreater(abs(d_by_q), 1e-4)
            self.assertLess(abs(d_by_q - q_by_d), 1e-9)

    def test_saturation_inverts(self):
        machine = Machine(4, 1.0, 4e-3, 9e-3, 0.1, I_sat_A=50.0)
        i = np.array([3.0 + 1.0j, -20.0 + 12.0j, 0.0 + 0.0j, 5.0 - 29.0j])
        theta = np.array([0.0, 1.0, 2.0, -3.0])
        self.assertLess(np.abs(machine.current(machine.flux(i, theta), theta) - i).max(), 1e-12)
        unequal = Machine(4, 1.0, 4e-3, 9e-3, 0.1, I_sat_A=50.0, dL_H=(8e-4, 0.0, -5e-4))
        self.assertLess(np.abs(unequal.current(unequal.flux(i, theta), theta) - i).max(), 1e-12)
        self.assertGreater(np.abs(unequal.current(machine.flux(i, theta), theta) - i).max(), 0.1)
        on_d = Machine(1, 1.0, 4e-3, 4e-3, 0.0, I_sat_A=50.0).flux(np.array([30.0 + 0.0j]), np.array([0.0]))[0]
        self.assertAlmostEqual(on_d.real / 30.0, 4e-3 / (1.0 + 0.36), 12)


class DeadTime(unittest.TestCase):
    def lost_volt_seconds(self, i0, t_dead, V_switch, V_diode, duty):
        """Flux that a drive without resistance and without EMF gains less than an ideal one, per phase."""
        T, u_dc = 2e-4, 500.0
        flux = []
        for t, s, d in ((0.0, 0.0, 0.0), (t_dead, V_switch, V_diode)):
            drive = Drive(Machine(1, 0.0, 0.05, 0.05, 0.0), Inverter(1, T, t, s, d), steady_shaft(0.0), i0)
            drive.advance_cycle(duty.reshape(3, 1), u_dc)
            flux.append(drive.psi[0])
        return phases_from_vector(np.array([flux[0] - flux[1]])).ravel() / T

    def test_law_at_large_current(self):
        # i_a > 0, i_b, i_c < 0 well away from zero: v_dead = u_dc t_dead f against each sign, common part removed.
        lost = self.lost_volt_seconds(10.0 + 0.0j, 1.5e-6, 0.0, 0.0, np.array([0.5, 0.5, 0.5]))
        v_dead = 500.0 * 1.5e-6 / 2e-4
        expected = phases_from_vector(vector_from_phases(v_dead * np.array([[1.0], [-1.0], [-1.0]])))
        np.testing.assert_allclose(lost, expected.ravel(), atol=1e-9)

    def test_device_drops(self):
        # At half duty a leg conducts half the time through the switch, half through the diode.
        lost = self.lost_volt_seconds(10.0 + 0.0j, 0.0, 1.4, 0.8, np.array([0.5, 0.5, 0.5]))
        np.testing.assert_allclose(lost, 1.1 * np.array([4.0, -2.0, -2.0]) / 3.0, atol=1e-9)

    def test_current_does_not_cross_zero_in_dead_time(self):
        # All legs switch together and no current flows: each diode blocks, and the current stays at zero, to first
        # order in R h / L of the 0.44 A that would flow without blocking (1.3 mA measured).
        drive = Drive(Machine(1, 0.5, 1e-3, 1e-3, 0.0), Inverter(1, 2e-4, 4e-6), steady_shaft(0.0), 0.0)
        for _ in range(5):
            drive.advance_cycle(np.full((3, 1), 0.5), 500.0)
        self.assertLess(abs(drive.current()[0]), 2e-3)
        # A current that would cross inside the dead time stops at zero: leg a's lower diode carries 20 mA while both of
        # its switches are off and the others are high. Without the diode's blocking it would end near -0.5 A.
        inverter, duty = Inverter(1, 2e-4, 4e-6), np.array([[0.5], [0.9], [0.9]])
        rise = float(inverter.edges(duty, duty)[0][0, 0])
        drive = Drive(Machine(1, 0.0, 3e-3, 3e-3, 0.0), inverter, steady_shaft(0.0), 0.02 + 0.0j)
        v, off = inverter.leg_voltages(inverter.pulses(duty, duty), rise + 2e-6, phases_from_vector(drive.current()), 500.0)
        self.assertEqual((v[0, 0], off[0, 0], off[1, 0]), (0.0, True, False))
        h, theta = np.array([4e-6]), np.array([0.0])
        u = vector_from_phases(v)
        i = drive.current()
        place = drive.machine.place(theta)
        psi, iron = drive._step(h, u, i, place, place)
        self.assertLess(drive.machine.current(psi, theta)[0].real, -0.4)
        u = drive._clamp(u, v, off, phases_from_vector(i), psi, iron, h, place, place, 500.0)
        psi, _ = drive._step(h, u, i, place, place)
        self.assertLess(abs(drive.machine.current(psi, theta)[0].real), 1e-12)


class Recordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clean = [draw.draw(seed, "clean") for seed in (1, 2, 3)]

    def test_format(self):
        required = {"t_s", "i_a_A", "i_b_A", "theta_e_rad", "omega_e_rad_s"}
        for drawn in self.clean:
            with self.subTest(seed=drawn.truth["seed"]), tempfile.TemporaryDirectory() as folder:
                generate.write(drawn, folder)
                table = reading.read_table(os.path.join(folder, "rec.csv"))
                self.assertTrue(required <= set(table))
                self.assertTrue({"u_a_V", "u_b_V", "u_c_V"} <= set(table)
                                or {"d_a", "d_b", "d_c", "u_dc_V"} <= set(table))
                self.assertEqual(len(table["t_s"]), sum(drawn.bench.rows))
                self.assertTrue(all(np.isfinite(x).all() for x in table.values()))
                self.assertTrue((np.diff(table["t_s"]) > 0.0).all())
                runs = reading.read_columns(os.path.join(folder, "rec.csv"), drawn.motor.pole_pairs)
                self.assertEqual([len(r["theta_e_rad"]) for r in runs], drawn.bench.rows)

    def test_a_seed_is_a_recording(self):
        again = draw.draw(1, "clean")
        self.assertEqual(generate.recording_text(again), generate.recording_text(self.clean[0]))
        self.assertEqual(again.truth, self.clean[0].truth)
        self.assertNotEqual(generate.recording_text(again), generate.recording_text(self.clean[1]))

    def test_oracle_reaches_the_noise_floor(self):
        # Each effect's law as documented, against the plant's physics: with the true parameters the averaged model
        # is left with sensor noise. Dead time has no exact averaged law (its shape near zero): 40 % above was measured. What
        # warming leaves within a recording is 13 % above. An iron loss and what is read off rows have no law among these, and no
        # oracle; a speed that lags has a test of its own.
        bounds = {"dead_time": 1.6, "temperature": 1.25}
        for n, cause in enumerate(effects.KNOWN):
            if cause in ("iron_loss", "speed_lag", *effects.NOT_AVERAGED):
                continue
            with self.subTest(cause=cause):
                case = draw.draw_case(300 + n, cause)
                size = [float(np.sqrt(np.prod(effects.RANGE[cause])))]
                model, _ = draw.true_model(case.motor, [cause], size, case.directions, case.bench.has_i_c)
                columns = draw.simulate(case.motor, case.bench, model, 150, [300 + n, 1])
                bound = bounds.get(cause, 1.1)
                error = draw.oracle(columns, model, case.motor)[0]
                self.assertLess(error, bound * draw.noise_floor_A(case.bench))
                nominal = effects.nominal_model(case.motor, averaged.no_effect())
                wrong = averaged.predict(columns, nominal, case.motor.pole_pairs, 1.0 / case.motor.f_pwm_Hz)[0]
                self.assertLess(error, averaged.rms(wrong))

    def test_a_speed_that_lags(self):
        # tau d(recorded)/dt + recorded = true, whose integral is the angle's; without noise, and the same drive without the lag.
        case = draw.draw_case(41, "speed_lag")
        case.bench.omega_noise, case.bench.encoder_counts, case.bench.swing = 0.0, 2 ** 40, [0.05] * case.bench.runs
        columns = {}
        for size in (0.0, 30.0):
            model, _ = draw.true_model(case.motor, ["speed_lag"], [size], case.directions, case.bench.has_i_c)
            columns[size] = draw.simulate(case.motor, case.bench, model, 150, [41, 1])
        T_s = 1.0 / case.motor.f_pwm_Hz
        recorded, true = columns[30.0]["omega_e_rad_s"], columns[0.0]["omega_e_rad_s"]
        np.testing.assert_array_equal(columns[30.0]["theta_e_rad"], columns[0.0]["theta_e_rad"])
        # With the mean of a cycle's ends for the middle: to second order in the cycle.
        slope, middle = np.diff(recorded, axis=0) / T_s, 0.5 * (recorded[1:] + recorded[:-1])
        self.assertLess(np.abs(30.0 * T_s * slope + middle - 0.5 * (true[1:] + true[:-1])).max(), 1e-3 * np.abs(recorded - true).max())
        self.assertGreater(np.abs(recorded - true).max(), 1e-4 * np.abs(true).max())
        turned = np.diff(columns[0.0]["theta_e_rad"], axis=0) - 0.5 * T_s * (recorded[1:] + recorded[:-1])
        ahead = np.cumsum(turned, axis=0)
        self.assertLess(np.abs(ahead - 30.0 * T_s * (recorded[1:] - recorded[:1])).max(), 1e-2 * np.abs(ahead).max() + 1e-9)
        # The oracle's speeds are nearer to the true ones than the recorded ones are.
        mended, inner = averaged.true_speed(recorded, 30.0), slice(40, -40)
        self.assertLess(averaged.rms((mended - true)[inner]), 0.2 * averaged.rms((recorded - true)[inner]))

    def test_a_loose_sensor_among_three_is_a_fault(self):
        self.assertEqual(effects.told_as("loose_sensor", True), ("sensor_fault", True))
        self.assertEqual(effects.told_as("loose_sensor", False), ("loose_sensor", False))
        self.assertTrue(draw.draw_case(3, "sensor_fault").bench.has_i_c)
        self.assertFalse(draw.draw_case(3, "loose_of_two").bench.has_i_c)
        orders = {}
        for seed in range(40):
            case = draw.draw_case(seed, "angle_order")
            model, _ = draw.true_model(case.motor, case.ids, [0.01], case.directions, case.bench.has_i_c)
            orders[case.motor.pole_pairs] = model.order
        self.assertTrue(all(order not in (1, 2, p, 2 * p) for p, order in orders.items()), orders)

    def test_later_causes_are_drawn_by_name_only(self):
        # The published seeds stay what they are: what they draw from does not grow.
        self.assertEqual(len(effects.CAUSES), 15)
        for kind in ("single", "pair", "triple"):
            ids = {name for seed in range(60) for name in draw.draw_case(seed, kind).ids}
            self.assertEqual(ids & set(effects.LATER), set())
        self.assertEqual(draw.draw_case(1, "phase_inductance").ids, ["phase_inductance"])
        truth = draw.draw(1, "phase_inductance").truth["effects"][0]
        self.assertTrue(truth["known"])
        self.assertEqual([p["name"] for p in truth["parameters"]], ["dL_a", "dL_b", "dL_c"])
        self.assertEqual(sum(p["value"] != 0.0 for p in truth["parameters"]), 1)
        self.assertEqual(draw.draw(1, "voltage_delay_half").truth["effects"][0]["id"], "voltage_delay")

    def test_read_back_gives_the_same_oracle(self):
        with tempfile.TemporaryDirectory() as folder:
            drawn = draw.draw(6, "flux_linkage")
            generate.write(drawn, folder)
            model, _ = draw.true_model(drawn.motor, ["flux_linkage"], [drawn.truth["effects"][0]["size"]],
                                       [{"sign": 1.0}], True)
            model.psi_f_Wb = drawn.truth["motor_file_should_say"]["psi_f_Wb"]
            parts = [averaged.predict(r, model, drawn.motor.pole_pairs, 1.0 / drawn.motor.f_pwm_Hz)
                     for r in reading.read_columns(os.path.join(folder, "rec.csv"), drawn.motor.pole_pairs)]
            error = averaged.rms(np.concatenate([p[0] for p in parts]))
            size = averaged.rms(np.concatenate([p[1] for p in parts]))
            self.assertLess(abs(100.0 * error / size / drawn.truth["oracle"]["true_percent"] - 1.0), 0.05)


class Scoring(unittest.TestCase):
    TRUTH = {"seed": 1, "kind": "resistance", "plant": "second", "oracle": {"gain": 4.0, "floor_percent": 0.3},
             "effects": [{"id": "resistance", "known": True, "share_of_floor": 3.0,
                          "parameters": [{"name": "R", "unit": "ohm", "value": 1.2, "compare": True}]}]}

    def answer(self, ids, ci95=(1.1, 1.3), gain=3.9):
        return {"causes": [{"id": i, "parameters": [{"name": "R", "value": 1.2, "ci95": list(ci95)}]} for i in ids],
                "verdict": "explained", "error": {"gain": gain, "noise_floor": 0.3}}

    def test_right_answer_passes(self):
        s = score.summary([score.judge(self.TRUTH, self.answer(["resistance"]))] * 20)
        self.assertEqual((s["single_exact"], s["coverage"]), (1.0, 1.0))
        self.assertEqual(score.below_threshold(s, False), [])

    def test_wrong_answers_fail(self):
        for name, answer in (("single_exact", self.answer(["dead_time"])), ("single_exact", self.answer([])),
                             ("single_exact", self.answer(["resistance", "dead_time"])),
                             ("coverage", self.answer(["resistance"], (1.25, 1.3))),
                             ("gain", self.answer(["resistance"], gain=2.0))):
            s = score.summary([score.judge(self.TRUTH, answer)] * 20)
            self.assertTrue(any(p.startswith(name) for p in score.below_threshold(s, False)), name)

    def rates(self, kind, right, wrong):
        """What is said of so many right and wrong answers of one kind of recording."""
        truth, good, bad = self.TRUTH, self.answer(["resistance"]), self.answer([])
        if kind == "clean":
            truth, good, bad = dict(truth, kind="clean", effects=[]), bad, good
        if kind == "unknown":
            effect = {"id": "glitch", "known": False, "share_of_floor": 4.0, "parameters": []}
            truth, good, bad = dict(truth, kind="glitch", effects=[effect]), bad, good
        judged = [score.judge(truth, good)] * right + [score.judge(truth, bad)] * wrong
        return [p for p in score.below_threshold(score.summary(judged), True) if p.startswith(kind)]

    def test_a_rate_is_what_it_says(self):
        # The most misses that are at least 95, 99 and 98 %, and one more; 49 of 50 is 98 %, not at least 99.
        for kind, count, most in (("single", 20, 1), ("single", 19, 0), ("single", 120, 6), ("single", 119, 5),
                                  ("clean", 50, 0), ("clean", 99, 0), ("clean", 100, 1), ("unknown", 40, 0),
                                  ("unknown", 49, 0), ("unknown", 50, 1), ("unknown", 99, 1)):
            with self.subTest(kind=kind, count=count):
                self.assertEqual(self.rates(kind, count - most, most), [])
                self.assertEqual(len(self.rates(kind, count - most - 1, most + 1)), 1)
        # Decimals that no float holds: 0.85 of 20 and of 100 are whole numbers.
        self.assertEqual([score.misses_allowed(n, 0.85) for n in (20, 100, 90, 6)], [3, 15, 13, 0])

    def test_a_cause_in_a_clean_or_unknown_recording_fails(self):
        clean = dict(self.TRUTH, kind="clean", effects=[])
        s = score.summary([score.judge(clean, self.answer(["resistance"]))] * 10)
        self.assertTrue(any(p.startswith("clean") for p in score.below_threshold(s, False)))
        glitch = {"id": "glitch", "known": False, "share_of_floor": 4.0, "parameters": []}
        unknown = dict(self.TRUTH, kind="glitch", effects=[glitch])
        s = score.summary([score.judge(unknown, self.answer(["resistance"]))] * 10)
        self.assertTrue(any(p.startswith("unknown") for p in score.below_threshold(s, False)))


if __name__ == "__main__":
    unittest.main()
