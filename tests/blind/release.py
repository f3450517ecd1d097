"""Release sets: 1,000 recordings and those of the groups (groups.py), drawn for one release, used once, and never developed on.

Development has all seeds below FIRST_SEED, a release set has its own thousand beyond. What is found there is published with the set's
number and the commit, as it falls (docs/release-sets.md); a set on that page is used up. A smaller set to try the machinery with
(--scale) is drawn from development seeds.
"""

import os
import subprocess

import numpy as np

import draw
import effects
import groups

FIRST_SEED = 1_000_000_000
PER_SET = 10_000
TRIAL_SEED = 500_000  # of a scaled set
PARTS = {"clean": 300, "unknown": 200, "single": 300, "pair": 150, "triple": 50}
GROUPS = {"bench": 100, "bench_half": 100, "steady": 200, "outside": 300}
GROUP_SEED = 2_000  # of a group's first recording, after the set's first


def kind_of(part, n, seed):
    """What is hidden in recording n of a part: causes and unknown effects in turn, pairs and triples drawn from all causes."""
    if part == "single":
        return effects.KNOWN[n % len(effects.KNOWN)]
    if part == "unknown":
        return effects.UNNAMED[n % len(effects.UNNAMED)]
    if part in ("pair", "triple"):
        return "+".join(draw.draw_group(np.random.default_rng([seed, 6]), effects.KNOWN, 2 if part == "pair" else 3))
    return part


def first_seed(number, scale):
    return FIRST_SEED + number * PER_SET if scale == 1.0 else TRIAL_SEED + number * PER_SET


def group_cases(number, scale=1.0):
    """The same of the groups."""
    out, first = [], first_seed(number, scale) + GROUP_SEED
    for n, (group, count) in enumerate(GROUPS.items()):
        out += groups.cases(group, round(count * scale), first + 1_000 * n)
    return out


def cases(number, scale=1.0):
    """(seed, kind, plant) of release set `number`, or of a share of one on development seeds, without the groups."""
    first = first_seed(number, scale)
    out = []
    for part, count in PARTS.items():
        for n in range(round(count * scale)):
            seed = first + len(out)
            kind = kind_of(part, n, seed)
            # The plants take turns, shifted each time the kinds have been through, so that each kind meets both.
            turns = {"single": len(effects.KNOWN), "unknown": len(effects.UNNAMED)}.get(part, 1)
            shift = n // turns if turns % 2 == 0 else 0
            plants = effects.plants_of(kind)
            out.append((seed, kind, plants[(n + shift) % len(plants)]))
    return out


def shuffled(cases, number):
    """The same in an order that says nothing, for when time may end before the set does."""
    order = np.random.default_rng([number, 7]).permutation(len(cases))
    return [cases[k] for k in order]


def commit():
    """The commit of the tree, or None if the tree has changes."""
    def git(*words):
        here = os.path.dirname(os.path.abspath(__file__))
        return subprocess.run(["git", *words], cwd=here, capture_output=True, text=True, check=True).stdout.strip()
    return None if git("status", "--porcelain", "--untracked-files=no") else git("rev-parse", "--short=12", "HEAD")
