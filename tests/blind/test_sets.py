#!/usr/bin/python3
"""The sets of the blind tests: last-digit errors of motor files, release sets, what is published of them.

Usage: tests/blind/test_sets.py
"""

import os
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import digits
import draw
import effects
import figure
import generate
import release
import score

KEYS = ("R_ohm", "L_d_H", "L_q_H", "psi_f_Wb")


class Digits(unittest.TestCase):
    def test_errors_are_as_stated(self):
        for key in KEYS:
            errors = np.array([draw.draw_case(seed, "clean", "usual", True).file_errors[key] for seed in range(400)])
            size = errors / digits.LEAST[key]
            self.assertLessEqual(np.abs(size).max(), 0.5)
            # A normal spread of 0.2, cut at 2.5 of itself: 0.1955.
            self.assertLess(abs(size.std() - 0.1955), 0.02)
            self.assertLess(abs(size.mean()), 0.03)

    def test_the_file_is_off_by_them(self):
        for seed in range(20):
            case = draw.draw_case(seed, "clean", "usual", True)
            for key in KEYS:
                off = getattr(case.file, key) / getattr(case.motor, key) - 1.0
                self.assertLess(abs(off - case.file_errors[key]), 5e-5)  # five digits
            self.assertEqual(case.file.L_d_H == case.file.L_q_H, case.motor.L_d_H == case.motor.L_q_H)

    def test_what_is_hidden_has_no_other_error(self):
        for kind, keys in (("resistance", ["R_ohm"]), ("inductance", ["L_d_H", "L_q_H"]), ("flux_linkage", ["psi_f_Wb"]),
                           ("saliency+resistance", ["R_ohm", "L_d_H", "L_q_H"]), ("dead_time", [])):
            errors = draw.draw_case(3, kind, "usual", True).file_errors
            self.assertEqual(sorted(set(KEYS) - set(errors)), sorted(keys))

    def test_a_seed_is_the_same_drive_with_and_without(self):
        for kind in ("pair", "single", "clean"):
            plain, off = draw.draw_case(8, kind), draw.draw_case(8, kind, "usual", True)
            self.assertEqual((plain.motor, plain.bench, plain.ids, plain.targets), (off.motor, off.bench, off.ids, off.targets))
            self.assertEqual(vars(plain.file), vars(plain.motor))

    def test_the_diagnosis_gets_the_file_and_the_truth_the_motor(self):
        with tempfile.TemporaryDirectory() as folder:
            drawn = draw.draw(5, "clean", None, "usual", True)
            generate.write(drawn, folder)
            with open(os.path.join(folder, "motor.toml"), encoding="utf-8") as file:
                self.assertEqual(file.read(), generate.motor_text(drawn.file))
            self.assertEqual(drawn.truth["motor_file_should_say"], {key: getattr(drawn.motor, key) for key in KEYS})
            self.assertGreater(drawn.truth["oracle"]["gain"], 1.0)


class Releases(unittest.TestCase):
    def test_a_set_is_what_is_asked(self):
        cases = release.cases(3)
        self.assertEqual(len(cases), 1000)
        self.assertEqual(len({seed for seed, _, _ in cases}), 1000)
        counts = [sum(kind == "clean" for _, kind, _ in cases), sum(kind in effects.UNNAMED for _, kind, _ in cases),
                  sum(kind in effects.KNOWN for _, kind, _ in cases), sum(kind.count("+") == 1 for _, kind, _ in cases),
                  sum(kind.count("+") == 2 for _, kind, _ in cases)]
        self.assertEqual(counts, [300, 200, 300, 150, 50])
        for kind in ["clean"] + effects.KNOWN + effects.UNNAMED:
            plants = [plant for _, k, plant in cases if k == kind]
            if kind == "saturation_dq":  # only the second plant has such iron
                self.assertEqual(set(plants), {"second"})
                continue
            self.assertEqual(set(plants), {"main", "second"}, kind)
            self.assertLessEqual(abs(plants.count("main") - plants.count("second")), 2, kind)
        for _, kind, _ in cases:
            ids = kind.split("+")
            self.assertTrue(all(effects.compatible(a, b) for a in ids for b in ids if a != b), kind)

    def test_a_set_has_the_groups_too(self):
        cases = release.group_cases(3)
        self.assertEqual({g: sum(group == g for _, group, _ in cases) for g in release.GROUPS}, release.GROUPS)
        seeds = {seed for seed, _, _ in cases + release.cases(3)}
        self.assertEqual(len(seeds), len(cases) + 1000)
        self.assertTrue(all(release.FIRST_SEED + 30_000 <= seed < release.FIRST_SEED + 40_000 for seed in seeds))
        self.assertTrue(all(seed < release.FIRST_SEED for seed, _, _ in release.group_cases(3, 0.05)))

    def test_a_plant_is_asked_only_for_what_it_knows(self):
        self.assertFalse([kind for _, kind, plant in release.cases(3) if plant == "main" and "saturation_dq" in kind])

    def test_development_never_meets_a_release(self):
        first = release.cases(1)
        self.assertTrue(all(seed >= release.FIRST_SEED for seed, _, _ in first))
        self.assertTrue(set(first).isdisjoint(release.cases(2)))
        trial = release.cases(1, 0.05)
        self.assertEqual(len(trial), 50)
        self.assertTrue(all(seed < release.FIRST_SEED for seed, _, _ in trial))

    def test_a_set_cut_short_is_a_sample_of_all_parts(self):
        cases = release.cases(2)
        mixed = release.shuffled(cases, 2)
        self.assertEqual(sorted(mixed), sorted(cases))
        self.assertEqual(mixed, release.shuffled(cases, 2))
        first = mixed[:200]
        for low, part in ((40, "clean"), (40, "single"), (20, "pair")):
            hits = sum((k == "clean") if part == "clean" else k in effects.KNOWN if part == "single" else k.count("+") == 1
                       for _, k, _ in first)
            self.assertGreater(hits, low - 15, part)

    def test_confidence(self):
        # Of 300 without a miss: 1 - 0.025^(1/300); of 10 with 5: the table of Clopper and Pearson.
        self.assertAlmostEqual(score.confidence(300, 300)[0], 0.025 ** (1.0 / 300.0), 9)
        self.assertEqual(score.confidence(300, 300)[1], 1.0)
        np.testing.assert_allclose(score.confidence(5, 10), (0.1871, 0.8129), atol=5e-5)
        self.assertEqual(score.confidence(0, 200)[0], 0.0)

    def summary(self):
        truth = {"seed": 1, "kind": "clean", "plant": "main", "effects": [], "oracle": {"floor_percent": 0.3}}
        answer = {"causes": [], "verdict": "clean", "error": {"noise_floor": 0.3}}
        return score.summary([{**score.judge(truth, answer), "clock_s": 0.5, "cpu_s": 0.4}] * 30)

    def outside(self):
        return [{"outcome": "false" if n == 0 else "right", "probability": [(0.98, n > 0)]} for n in range(40)]

    def test_what_is_published_stays(self):
        docs = figure.DOCS
        with tempfile.TemporaryDirectory() as figure.DOCS:
            try:
                with open(os.path.join(figure.DOCS, figure.RELEASES), "w", encoding="utf-8") as file:
                    file.write("before\n<!-- blind: releases -->\nNone yet.\n<!-- end -->\nafter\n")
                self.assertFalse(figure.is_published(1))
                figure.publish(1, "0123456789ab", self.summary(), 0, {"outside": self.outside()}, self.outside())
                self.assertTrue(figure.is_published(1))
                self.assertFalse(figure.is_published(11))
                first = figure.release_block()
                self.assertIn("| clean recordings with no cause | 30 | 100.0 % | 88.4 to 100.0 % | >= 99 % |", first)
                self.assertIn("| effects outside the catalogue on benches: a false cause | 40 | 2.5 % | 0.1 to 13.2 % | <= 1 % |", first)
                self.assertIn("| 0.95 to 0.99 | 40 | 98.0 % | 97.5 % | 86.8 to 99.9 % | yes |", first)
                self.assertNotIn("None yet", first)
                figure.publish(11, "ba9876543210", self.summary(), 2, {}, [])
                self.assertTrue(figure.release_block().startswith(first))
                self.assertTrue(figure.is_published(1) and figure.is_published(11))
            finally:
                figure.DOCS = docs

    def test_estimates_are_held_to_the_truth(self):
        truth = {"effects": [{"id": "phase_asymmetry"}], "motor_file_should_say": {"R_ohm": 1.0, "L_d_H": 2.0, "L_q_H": 3.0,
                                                                                   "psi_f_Wb": 4.0}}
        given = [{"name": "R", "ci95": [2.0, 3.0], "excited": True}, {"name": "L_d", "ci95": [1.9, 2.1], "excited": True},
                 {"name": "L_q", "ci95": [3.1, 3.2], "excited": True}, {"name": "psi_f", "ci95": None, "excited": False}]
        inside = {e["name"]: e["inside"] for e in score.judge_estimates(truth, {"estimates": given})}
        # Not R, which one phase's own is a part of; not psi_f, which the recording does not show.
        self.assertEqual(inside, {"L_d": True, "L_q": False})


if __name__ == "__main__":
    unittest.main()
