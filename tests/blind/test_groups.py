#!/usr/bin/python3
"""The groups of recordings that look like benches: what is drawn is what the plants do, and the scoring says what it should.

Usage: tests/blind/test_groups.py [--iqfoc build/host/iqfoc]
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)

import averaged
import draw
import effects
import figure
import generate
import group_score
import groups
import motors
import reading
import score

IQFOC = os.path.join(os.path.dirname(os.path.dirname(HERE)), "build", "host", "iqfoc")


def quiet(bench):
    """The bench without noise of its sensors."""
    I_pk = bench.full_scale_A
    bench.noise_A, bench.bits, bench.encoder_counts, bench.omega_noise, bench.u_dc_noise = 1e-9 * I_pk, 32, 2 ** 40, 0.0, 0.0
    bench.timer_counts = 10 ** 9
    return bench


class Benches(unittest.TestCase):
    def small_bench(self, seed):
        """A quiet recording of a bench, and its true model: 150 rows of each run."""
        case = groups.draw_bench_case(seed, "bench")
        quiet(case.bench)
        case.bench.rows = [150] * case.bench.runs
        model, _ = draw.true_model(case.motor, case.ids, case.sizes, case.directions, case.bench.has_i_c)
        return case, model, draw.simulate(case.motor, case.bench, model, 150, [seed, 1])

    def test_sizes_are_as_stated(self):
        for seed in range(40):
            rng = np.random.default_rng(seed)
            ids, sizes, directions, small, large = groups.bench_effects(rng, 1.0, 1 + seed % 2, True, False)
            self.assertEqual(sorted(ids), sorted(small + large))
            self.assertEqual(len(large), 1 + seed % 2)
            self.assertTrue(set(groups.SMALL) <= set(ids))
            for name, size, d in zip(ids, sizes, directions):
                if name == "dead_time_compensated":
                    self.assertTrue(0.004 <= size <= 0.015)
                    size = abs(d["left"])
                base = {**groups.SMALL, **groups.FURTHER}[name]
                low, high = (3.0, 10.0) if name in large else (0.5, 1.5)
                self.assertGreaterEqual(size, 0.999 * low * base)
                self.assertLessEqual(size, 1.001 * high * base)

    def test_half_is_half(self):
        whole = groups.bench_effects(np.random.default_rng(5), 1.0, 1, True, False)
        half = groups.bench_effects(np.random.default_rng(5), 0.5, 1, True, False)
        self.assertEqual(whole[0], half[0])
        for name, a, b, da, db in zip(whole[0], whole[1], half[1], whole[2], half[2]):
            if name == "dead_time_compensated":
                a, b = da["left"], db["left"]
            self.assertAlmostEqual(b / a, 1.0 if name in whole[4] else 0.5, 9)

    def test_the_truth_is_what_the_plant_does(self):
        # Without noise the true model errs least, and without any of the effects it errs more. What an averaged model leaves of
        # switching edges within dead time and iron is a share of what the file's values leave.
        for seed in (600_100, 600_101):
            with self.subTest(seed=seed):
                case, model, columns = self.small_bench(seed)
                T_s = 1.0 / case.motor.f_pwm_Hz
                model.whole = True
                model.ripple_rad = averaged.ripple_phases(columns, model, case.motor.pole_pairs, T_s)
                model.i_knee_A = draw.oracle(columns, model, case.motor)[3]

                def left(tried):
                    tried.i_knee_A = model.i_knee_A
                    if tried.u_ripple:
                        tried.ripple_rad = model.ripple_rad
                    return averaged.rms(averaged.predict(columns, tried, case.motor.pole_pairs, T_s)[0])
                true = left(model)
                nominal = left(effects.nominal_model(case.motor, averaged.no_effect()))
                self.assertLess(true, 0.4 * nominal)
                for name in case.ids:
                    if name == "iron_loss" and name not in case.large:
                        continue  # of 0.6 % at top speed: less than the averaged model errs by in the edges
                    self.assertGreater(left(groups.without(case, name)), 1.002 * true, name)

    def test_open_loop_of_the_truth(self):
        # A quiet drive with nothing hidden: the true model stays with it to a part in a thousand, with the wrong flux it does not.
        case = draw.draw_case(31, "clean")
        quiet(case.bench)
        case.bench.rows = [200] * case.bench.runs
        model, _ = draw.true_model(case.motor, [], [], [], True)
        columns = draw.simulate(case.motor, case.bench, model, 200, [31, 1])
        wrong = draw.copy.copy(model)
        wrong.psi_f_Wb = 1.02 * model.psi_f_Wb
        share = []
        for tried in (model, wrong):
            error, measured = averaged.open_loop(columns, tried, case.motor.pole_pairs, 1.0 / case.motor.f_pwm_Hz, case.bench.rows)
            self.assertEqual(len(error), case.bench.runs * (200 - averaged.HISTORY))
            share.append(averaged.rms(error) / averaged.rms(measured))
        self.assertLess(share[0], 2e-3)
        self.assertGreater(share[1], 10.0 * share[0])

    def test_ripple_phases_are_found(self):
        case = draw.draw_case(32, "dc_link_ripple")
        quiet(case.bench)
        model, _ = draw.true_model(case.motor, case.ids, [0.02], case.directions, case.bench.has_i_c)
        columns = draw.simulate(case.motor, case.bench, model, 300, [32, 1])
        T_s = 1.0 / case.motor.f_pwm_Hz
        found = averaged.ripple_phases(columns, model, case.motor.pole_pairs, T_s)
        # second_drive.py: sin(2 pi f (t + T/2)), t from the warm-up's start on.
        true = 2.0 * np.pi * model.u_ripple_Hz * T_s * (case.bench.warm_up + 0.5)
        moving = [n for n, (w, _) in enumerate(case.bench.points) if abs(w) > 0.0]
        off = np.abs(np.angle(np.exp(1j * (found - true))))[moving]
        self.assertLess(np.median(off), 0.05)

    def test_the_truth_file_of_either_plant(self):
        for plant in ("second", "main"):
            with self.subTest(plant=plant), tempfile.TemporaryDirectory() as folder:
                groups.make(600_102, "bench_half", plant, folder, IQFOC)
                with open(os.path.join(folder, "truth.json"), encoding="utf-8") as file:
                    truth = json.load(file)
                o = truth["oracle"]
                self.assertLess(o["true_percent"], o["nominal_percent"])
                self.assertLess(o["open_loop_true_percent"], 0.7 * o["open_loop_nominal_percent"])
                self.assertTrue(1 <= sum(e["dominates"] for e in truth["effects"]) <= 2)
                self.assertGreaterEqual(min(e["evidence"] for e in truth["effects"] if e["dominates"]), 0.5 * groups.EVIDENCE)
                self.assertGreater(truth["drive"]["compensation_V"], 0.0)
                self.assertEqual(truth["motor_file_should_say"]["R_ohm"], truth["drive"]["R_ohm"])

    def test_plants_take_turns(self):
        cases = groups.cases("bench", 12)
        self.assertEqual({p for _, _, p in cases}, {"second", "main"})
        self.assertEqual(len({s for s, _, _ in cases}), 12)
        ranges = [(groups.FIRST_SEED[g], groups.FIRST_SEED[g] + 9999) for g in groups.GROUPS]
        for n, (low, high) in enumerate(ranges):
            self.assertTrue(all(high < a or b < low for m, (a, b) in enumerate(ranges) if m != n))


class Outside(unittest.TestCase):
    def test_both_plants_do_the_same(self):
        # Two plants that share no code, the same effect: the file's model errs by as much, and more than by noise.
        first = groups.FIRST_SEED["outside"] + 1000
        for name, seed in ((effects.OUTSIDE[s % len(effects.OUTSIDE)], s) for s in range(first, first + len(effects.OUTSIDE))):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                case = groups.draw_case(seed, "outside")
                self.assertEqual(case.ids, [name])
                noise = case.bench.full_scale_A / 2e4
                case.bench.noise_A, case.bench.bits = noise, 16
                case.sizes = [effects.RANGE[name][1]]
                case.bench.rows = [300] * case.bench.runs
                case.bench.has_i_c = True
                T_s, shown = 1.0 / case.motor.f_pwm_Hz, []
                import main_plant
                model, _ = draw.true_model(case.motor, case.ids, case.sizes, case.directions, True)
                nominal = effects.nominal_model(case.motor, averaged.no_effect())
                for columns in (draw.simulate(case.motor, case.bench, model, 300, [seed, 1]),
                                main_plant.simulate(case, case.sizes, folder, IQFOC)[2]):
                    error, _, _ = averaged.predict(columns, nominal, case.motor.pole_pairs, T_s)
                    total = columns["i_A"].sum(axis=1)
                    shown.append((averaged.rms(error), float(np.std(total))))
                floor = draw.noise_floor_A(case.bench)
                (a, sum_a), (b, sum_b) = shown
                if name in ("common_hum", "crosstalk", "hum", "switching_noise"):
                    self.assertLess(abs(sum_a / sum_b - 1.0), 0.2)
                    self.assertGreater(sum_a, 5.0 * np.sqrt(3.0) * noise)
                if name != "common_hum":
                    self.assertLess(abs(a / b - 1.0), 0.2)
                    self.assertGreater(a, 1.1 * floor)


class OneRun(unittest.TestCase):
    def test_one_speed_as_stated(self):
        for seed in range(620_000, 620_030):
            case = draw.draw_case(seed, "clean", "steady", True)
            motor, bench = case.motor, case.bench
            self.assertEqual(bench.runs, 1)
            cycles = motor.f_pwm_Hz / (abs(bench.points[0][0]) / (2.0 * np.pi))
            self.assertTrue(4.99 <= cycles <= 60.0, cycles)
            seconds = bench.rows[0] / motor.f_pwm_Hz
            self.assertTrue(bench.rows[0] == motors.ROWS_MOST or 0.299 <= seconds <= 2.0, seconds)

    def test_a_recording_at_one_speed_and_a_ramp(self):
        for kind in ("steady", "ramp"):
            case = draw.draw_case(620_003, "clean", kind, True)
            quiet(case.bench)
            case.bench.rows = [400]
            model, _ = draw.true_model(case.motor, [], [], [], True)
            columns = draw.simulate(case.motor, case.bench, model, 400, [620_003, 1])
            omega = columns["omega_e_rad_s"][:, 0]
            if kind == "steady":
                self.assertLess(np.ptp(omega), 0.01 * abs(omega.mean()))
            else:
                line = np.linspace(*case.bench.ramp_rad_s, 401)[:400]
                np.testing.assert_allclose(omega, line, atol=1e-3 * np.abs(line).max())
            turned = np.diff(columns["theta_e_rad"][:, 0])
            np.testing.assert_allclose(turned, 0.5 * (omega[1:] + omega[:-1]) / case.motor.f_pwm_Hz, atol=1e-6)
            error = averaged.predict(columns, model, case.motor.pole_pairs, 1.0 / case.motor.f_pwm_Hz)[0]
            self.assertLess(averaged.rms(error), 2e-3 * case.motor.I_rated_A_rms)

    def test_separation(self):
        # A resistance at one speed and a constant current is as well a little of flux and scale; at many points it is not.
        def distance(kind, bench_kind, seed, size, **bench):
            case = draw.draw_case(seed, kind, bench_kind)
            vars(case.bench).update(bench)
            case.sizes = [size]
            case.bench.rows = [300] * case.bench.runs
            model, _ = draw.true_model(case.motor, case.ids, case.sizes, case.directions, case.bench.has_i_c)
            columns = draw.simulate(case.motor, case.bench, model, 300, [seed, 1])
            return groups.separation(case, columns)
        for kind, size in (("resistance", 0.4), ("flux_linkage", 0.05), ("angle_offset", 0.05)):
            self.assertLess(distance(kind, "steady", 2, size, excitation=0.0), 0.2 * group_score.SEPARABLE, kind)
            self.assertGreater(distance(kind, "usual", 2, size), 3.0 * group_score.SEPARABLE, kind)
        self.assertIsNone(distance("clean", "steady", 2, 0.0))


class Diagnosed(unittest.TestCase):
    def answer(self, folder):
        """The truth of a recording, and the diagnosis."""
        found = os.path.join(folder, "found.json")
        subprocess.run([IQFOC, "diagnose", os.path.join(folder, "rec.csv"), "--motor", os.path.join(folder, "motor.toml"),
                        "--json", found], check=True, capture_output=True)
        with open(os.path.join(folder, "truth.json"), encoding="utf-8") as truth, open(found, encoding="utf-8") as answer:
            return json.load(truth), json.load(answer)

    def check(self, seed, group, plant, outcome="right"):
        with self.subTest(seed=seed):
            judged = self.judged(seed, group, plant)
            self.assertEqual(judged["outcome"], outcome, judged)

    def judged(self, seed, group, plant):
        with tempfile.TemporaryDirectory() as folder:
            groups.make(seed, group, plant, folder, IQFOC, open_loop=False)
            return group_score.judge(*self.answer(folder))

    def test_a_saturation_has_one_name(self):
        """The whole drive fits an inductance and its fall. The motor file's inductance is the true one at some current."""
        with tempfile.TemporaryDirectory() as folder:
            generate.make(815_506, "triple", "second", folder, IQFOC, "usual", True)
            judged = score.judge(*self.answer(folder))
            self.assertTrue(judged["exact"], judged)

    def test_a_fit_ends_where_only_its_scale_moves(self):
        """Its steps follow one prior along the factor that no recording shows, and the choice of the factor another: 20 steps to and fro."""
        with tempfile.TemporaryDirectory() as folder:
            groups.make(860_018, "bench", "second", folder, IQFOC, open_loop=False)
            told = subprocess.run([IQFOC, "diagnose", os.path.join(folder, "rec.csv"), "--motor", os.path.join(folder, "motor.toml"),
                                   "--trace"], check=True, capture_output=True, text=True)
        steps = [int(n) for n in re.findall(r"whole drive, step (\d+):", told.stdout + told.stderr)]
        self.assertGreater(len(steps), 5)
        self.assertLess(max(steps), 12)

    def test_crosstalk_is_no_gain_and_no_inductance(self):
        for seed in (764_037, 764_053):
            self.check(seed, "outside", "main")

    def test_a_weak_pole_of_a_single_pair_is_no_angle_error(self):
        """Unequal poles explain more, without a name, than the effects of a real drive do."""
        self.check(807_017, "outside", "main")

    def test_benches_that_were_wrong_once(self):
        # In turn: the fit of the whole drive ended before it was over; a flux map for two inductances that saturate; a compensation that
        # holds the sign of a simulated current.
        for seed, plant in ((742_015, "main"), (742_026, "second"), (762_005, "main")):
            self.check(seed, "bench", plant)
        # A resistance that one phase has alone, reported as one of all three; an inductance that is wrong at every current, as a saturation.
        for seed in (772_015, 772_019):
            self.check(seed, "bench", "main")
        # The whole drive holds small effects as well: a set of its large ones is likelier than what the search had found.
        self.check(804_006, "bench", "second")

    def test_what_flows_at_an_edge_is_no_filter_of_the_sensors(self):
        """A compensated dead time that the search took for a plain one; the iron's current at an edge; noise where a compensation decides."""
        for seed, plant in ((865_009, "main"), (865_011, "main"), (860_018, "second")):
            self.check(seed, "bench", plant)

    def test_offsets_at_one_speed_are_no_resistance(self):
        """They act through R: to the parabola about the fit, no offset is a resistance of twice the value."""
        self.check(806_033, "steady", "main")

    def test_iron_loss_under_a_compensation_is_no_delay(self):
        # A sparse search takes an angle delay for it, and explains the recording; only the whole drive tells them apart.
        self.check(785_013, "bench_half", "main")

    def test_the_peaks_of_a_ripple_are_no_missed_updates(self):
        """To the first drive that is found some are; to the last one their correction does harm."""
        self.check(848_003, "bench_half", "main")

    def test_another_modulator_is_no_filter_of_the_sensors(self):
        """The search's drive is too wrong to show the modulator; that of the fit of the whole drive does."""
        self.check(852_006, "bench", "second")

    def test_gains_that_hardly_drift_are_gains(self):
        """The search takes gains that drift. The fit of the whole drive finds large gains, and a drift below its threshold."""
        self.check(848_000, "bench_half", "second")

    def test_noise_of_the_link_is_no_resistance(self):
        # One speed. Hidden: a voltage gain, and an angle offset that other causes explain as well.
        for seed in (788_030, 788_032):
            self.check(seed, "steady", "second")

    def test_the_large_effects_of_the_whole_drive_are_those_of_the_search(self):
        """Fitted from either end, one set scored a third of a unit better or worse, and with that the small effects came or went."""
        self.check(838_002, "bench_half", "second")

    def test_what_a_sign_turned_by_noise_does_is_no_missed_update(self):
        """A compensation by the wrong sign moves the current as a command that did not come does."""
        self.check(791_008, "bench_half", "second")

    def test_a_ripple_at_one_speed_is_no_other_motor(self):
        """Before any cause was known of, a search made a drive of it that fits everything and has no value of the motor file's."""
        self.check(783_024, "steady", "second")

    def test_a_salient_machine_under_a_dead_time_keeps_its_inductances(self):
        """An edge finds a ripple that turns with the rotor."""
        self.check(794_016, "steady", "second")

    def test_what_a_dead_time_leaves_is_no_cause(self):
        # One speed, a compensated dead time. The noise was overestimated four times, and unequal phases took up what was left. The dead
        # time's value is 1.8 % off, just outside its interval.
        judged = self.judged(788_059, "steady", "main")
        self.assertEqual((judged["named"], judged["by_names"], judged["verdict"]), (["dead_time"], True, "explained"), judged)
        self.assertLess(max(p["off"] for p in judged["parameters"]), 1.5, judged)

    def test_a_scale_that_no_recording_shows_is_no_cause(self):
        # R, L and psi_f are off, and the voltages by one factor with another L would do; no angle delay stands for the iron loss.
        self.check(772_023, "bench", "main", "held back")


class Scoring(unittest.TestCase):
    def truth(self, **more):
        def effect(name, dominates, *values):
            return {"id": name, "known": True, "dominates": dominates,
                    "parameters": [{"name": n, "value": v, "compare": True} for n, v in values]}
        return {"seed": 1, "kind": "bench", "group": "bench", "plant": "second",
                "effects": [effect("saturation", False, ("L_0", 1.0)), effect("resistance", True, ("R", 2.0)),
                            effect("dead_time", True, ("v_dead", 3.0))],
                "motor_file_should_say": {"R_ohm": 2.0, "L_d_H": 1.0, "L_q_H": 1.0, "psi_f_Wb": 1.0},
                "oracle": {"nominal_percent": 4.0, "true_percent": 1.0, "open_loop_nominal_percent": 10.0,
                           "open_loop_true_percent": 2.0, "floor_percent": 0.9}, **more}

    def answer(self, *named, verdict="explained", after=2.0, **more):
        values = {"resistance": ("R", 2.05, [1.9, 2.2]), "dead_time": ("v_dead", 2.9, [2.7, 3.1]), "saturation_dq": ("L_d0", 1.0, [0.9, 1.1]),
                  "angle_delay": ("t_delay", 1.0, [0.9, 1.1])}
        causes = [{"id": x, "probability": 0.99, "parameters": [dict(zip(("name", "value", "ci95"), values[x]))]} for x in named]
        return {"causes": causes, "verdict": verdict, "estimates": [],
                "error": {"nominal": 4.0, "extended": 1.0, "free_run_nominal": 10.0, "free_run_extended": after}, **more}

    def test_outcomes(self):
        for named, outcome in ((("resistance", "dead_time"), "right"), (("resistance",), "partly"), ((), "missed"),
                               (("resistance", "dead_time", "angle_delay"), "false"),
                               (("resistance", "dead_time", "saturation_dq"), "right")):
            self.assertEqual(group_score.judge(self.truth(), self.answer(*named))["outcome"], outcome, named)

    def test_a_value_outside_is_not_right(self):
        wrong = self.answer("resistance", "dead_time")
        wrong["causes"][0]["parameters"][0]["ci95"] = [2.04, 2.06]
        judged = group_score.judge(self.truth(), wrong)
        self.assertEqual((judged["outcome"], judged["by_names"]), ("partly", True))
        # Of two values each interval may be 1.14 times as wide.
        wrong["causes"][0]["parameters"][0]["ci95"] = [2.005, 2.095]
        self.assertEqual(group_score.judge(self.truth(), wrong)["outcome"], "right")
        # Any value of a range is true.
        truth = self.truth()
        truth["effects"][1]["parameters"][0]["value"], truth["effects"][1]["parameters"][0]["low"] = 2.4, 2.0
        wrong["causes"][0]["parameters"][0]["ci95"] = [2.04, 2.06]
        self.assertEqual(group_score.judge(truth, wrong)["outcome"], "right")

    def test_what_cannot_be_distinguished(self):
        one = self.truth(separation=2.0)
        one["effects"] = one["effects"][1:2]
        held = {"candidates": [{"causes": ["resistance"], "probability": 0.5}, {"causes": ["flux_linkage"], "probability": 0.5}]}
        for more, separation, outcome in ((held, 2.0, "right"), (held, 20.0, "held back"), ({}, 2.0, "missed"),
                                          ({"not_visible": [{"words": "R"}]}, 2.0, "right"), ({}, 20.0, "missed")):
            judged = group_score.judge(dict(one, separation=separation), self.answer(verdict="clean", **more))
            self.assertEqual(judged["outcome"], outcome, (more, separation))

    def test_outside(self):
        truth = self.truth()
        truth["effects"] = [{"id": "weak_pole", "known": False, "parameters": []}]
        self.assertEqual(group_score.judge(truth, self.answer("resistance"))["outcome"], "false")
        self.assertEqual(group_score.judge(truth, self.answer(verdict="unexplained"))["outcome"], "right")
        self.assertEqual(group_score.judge(truth, self.answer(verdict="clean"))["outcome"], "missed")
        # What shows nowhere is not missed; the sum of the currents shows what the vector does not.
        truth["oracle"]["nominal_percent"] = 1.05 * truth["oracle"]["floor_percent"]
        self.assertEqual(group_score.judge(truth, self.answer(verdict="clean"))["outcome"], "right")
        truth["effects"][0]["id"] = "common_hum"
        self.assertEqual(group_score.judge(truth, self.answer(verdict="clean"))["outcome"], "missed")

    def test_shares_and_reliability(self):
        judged = group_score.judge(self.truth(), self.answer("resistance", "dead_time", after=4.0))
        self.assertAlmostEqual(judged["open_loop"], 0.5)
        self.assertAlmostEqual(judged["one_cycle"], 1.0)
        false = group_score.judge(self.truth(), self.answer("angle_delay"))
        (low, high, count, said, real), = group_score.reliability([judged, false])
        self.assertEqual((low, high, count), (0.99, 0.999, 3))
        self.assertAlmostEqual(said, 0.99)
        self.assertAlmostEqual(real, 2.0 / 3.0)
        problems = group_score.below_asked([judged] * 79 + [false] * 21)
        self.assertEqual(len(problems), 2, problems)
        right = group_score.judge(self.truth(), self.answer("resistance", "dead_time"))
        self.assertEqual(group_score.below_asked([right] * 80 + [false] * 20), [])
        s = group_score.summary([judged, false])
        self.assertEqual(s["outcomes"], {"right": 1, "partly": 0, "held back": 0, "missed": 0, "false": 1})
        self.assertEqual(s["intervals"]["clean or explained"], [2, 2])
        page = figure.group_markdown([judged, false], "0123abc")
        self.assertIn("2 recordings of `bench`, seeds 1 to 1, commit 0123abc:", page)
        self.assertIn("| right | 1 of 2 | 1 to 99 % |", page)
        self.assertIn("| a false cause | 1 of 2 | 1 to 99 % |", page)
        self.assertNotIn("missed", page)
        self.assertIn("| true values inside their 95 % interval | 2 of 2 | 16 to 100 % |", page)
        self.assertIn("| named with a probability of 0.99 or more: the drive has it | 2 of 3 | 9 to 99 % |", page)


if __name__ == "__main__":
    if "--iqfoc" in sys.argv:
        at = sys.argv.index("--iqfoc")
        IQFOC = os.path.abspath(sys.argv[at + 1])
        del sys.argv[at:at + 2]
    unittest.main(argv=sys.argv, verbosity=1)
