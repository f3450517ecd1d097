#!/usr/bin/python3
"""The blind tests: draws recordings, has `iqfoc diagnose` look at them, and compares with what was hidden.

    tests/blind/run.py              320 recordings; fails below the thresholds of score.py
    tests/blind/run.py --digits     the same with last-digit errors in every motor file (digits.py)
    tests/blind/run.py --ci         a fixed set of 52, half of them by the second plant
    tests/blind/run.py --quick      twelve of them; each must be right
    tests/blind/run.py --release 3  release set 3: recordings that nothing was developed on; once only (release.py)
    tests/blind/run.py --release 3 --minutes 30     as much of it as begins within 30 minutes, in an order drawn beforehand
    tests/blind/run.py --kind phase_inductance --count 40    recordings of one kind (generate.py lists them)
    tests/blind/run.py --skip-check for each cause: without its hypothesis, the diagnosis must fail this test
    tests/blind/run.py --group bench --count 24    recordings that look like a bench (groups.py: bench, bench_half, steady, ramp, outside)
    tests/blind/run.py --reliability 40 --first 720000    how often named causes are there, by their probability: all kinds in turn
    tests/blind/run.py --reliability A.json B.json           the same of recordings whose results were written by --json
    tests/blind/run.py --limits     the size of each effect that is found in 95 % of cases (limits.py)
    tests/blind/run.py --limits --any-size     the same without the reporting threshold

Recordings are the same on every machine: a seed is all there is. --keep DIR leaves them (and reuses those there).
Needs Debian's python3-numpy and python3-scipy, and gnuplot for --figure.
"""

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
import typing
from concurrent.futures import ProcessPoolExecutor, as_completed, wait

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
MADE_AHEAD = 20
QUICK, QUICK_CAUSES = 12, 10
# One thread per process: numpy's pools would only fight over the two processes' cores.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, HERE)

try:
    import effects
    import figure
    import generate
    import group_score
    import groups
    import release
    import score
except ImportError as missing:
    sys.exit(f"tests/blind/run.py: {missing}; needs Debian's python3-numpy and its /usr/bin/python3")


def fixed_set(full, first=None):
    """(seed, kind, plant) of every recording: each cause alone, pairs, clean, unknown; the plants take turns."""
    repeats, pairs, clean, unknown = (8, 90, 50, 40) if full else (1, 14, 10, 9)
    kinds = effects.CAUSES * repeats + ["pair"] * pairs + ["clean"] * clean
    # The plants take turns: over an odd number of causes each meets both; the even number of unknown ones is shifted.
    kinds += [effects.UNKNOWN[(n + n // 4) % len(effects.UNKNOWN)] for n in range(unknown)]
    # What those of the published seeds were has got names since; these have none.
    kinds += [effects.UNNAMED[n // 2 % len(effects.UNNAMED)] for n in range(20 if full else 4)]
    if first is None:
        first = 1000 if full else 9000
    return [(first + n, kind, ("second", "main")[n % 2]) for n, kind in enumerate(kinds)]


def of_all_kinds(count, first):
    """(seed, kind, plant): one cause, two, none, and of each group, in turn."""
    turns = ["single", "outside", "pair", "bench", "steady", "outside", "clean", "bench_half"]
    return [(first + n, turns[n % len(turns)], ("second", "main")[n // len(turns) % 2]) for n in range(count)]


class Case(typing.NamedTuple):
    seed: int
    kind: str
    plant: str
    digits: bool
    keep: str
    iqfoc: str
    skip: str


def set_of(args):
    """(seed, kind, plant) of the recordings that are asked for."""
    if args.release is not None:
        cases = release.cases(args.release, args.scale) + release.group_cases(args.release, args.scale)
        return release.shuffled(cases, args.release) if args.minutes else cases
    if args.reliability:
        return of_all_kinds(int(args.reliability[0]), 720_000 if args.first is None else args.first)
    if args.group:
        return [case for case in groups.cases(args.group, args.count, args.first) if args.plant in ("both", case[2])]
    wanted = fixed_set(not args.ci, args.first)
    if args.kind:
        first = 50000 if args.first is None else args.first
        plants = effects.plants_of(args.kind)
        wanted = [(first + n, args.kind, plants[n % len(plants)]) for n in range(args.count)]
    if args.plant != "both":
        wanted = [(seed, kind, args.plant) for seed, kind, _ in wanted]
    return wanted


def prepare(folder, case):
    """Makes the recording unless the folder holds it already."""
    if os.path.exists(os.path.join(folder, "truth.json")):
        pass
    elif case.kind in groups.GROUPS:
        groups.make(case.seed, case.kind, case.plant, folder, case.iqfoc)
    else:
        generate.make(case.seed, case.kind, case.plant, folder, case.iqfoc, "usual", case.digits)
    with open(os.path.join(folder, "truth.json"), encoding="utf-8") as file:
        return json.load(file)


def diagnose(folder, iqfoc, skip=None, motor="motor.toml", more=()):
    """Runs the diagnosis on a folder's recording; raises with its words when it refuses."""
    command = [iqfoc, "diagnose", "rec.csv", "--motor", motor, "--json", "-", *more]
    if skip:
        command += ["--skip", skip]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=1200)
    if done.returncode != 0:
        raise RuntimeError(f"exit {done.returncode}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def timed(folder, iqfoc, skip):
    """The diagnosis, and its seconds by the clock and on the processor. A worker runs one child at a time."""
    def cpu_s():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime
    clock, before = time.monotonic(), cpu_s()
    found = diagnose(folder, iqfoc, skip)
    return found, {"clock_s": time.monotonic() - clock, "cpu_s": cpu_s() - before}


def folder_of(case, scratch):
    name = f"{case.plant}-{case.kind}-{case.seed}" + ("-digits" if case.digits else "")
    return os.path.join(case.keep or scratch, name)


def judged(folder, case, truth):
    found, taken = timed(folder, case.iqfoc, case.skip)
    judge = group_score.judge if case.kind in groups.GROUPS else score.judge
    return {**judge(truth, found), "probability": group_score.probabilities(truth, found), **taken}


def one_case(case):
    with tempfile.TemporaryDirectory(prefix="blind-") as scratch:
        folder = folder_of(case, scratch)
        return judged(folder, case, prepare(folder, case))


def run_cases(cases, jobs, minutes=None):
    """Judged recordings in the cases' order, and (case, words) of those that failed to run. After so many minutes none
    begins; what has begun counts, however long it takes."""
    results, failures, end = {}, [], time.monotonic() + 60.0 * (minutes or math.inf)
    with ProcessPoolExecutor(jobs) as pool:
        waiting = {pool.submit(one_case, case): case for case in cases}
        for done, future in enumerate(as_completed(waiting), 1):
            case = waiting[future]
            if time.monotonic() > end:
                for other in waiting:
                    other.cancel()
            if future.cancelled():
                continue
            try:
                results[case] = future.result()
            except Exception as problem:  # a refusal, a crash or a hang: reported with its case, never passed over
                failures.append((case, f"{type(problem).__name__}: {problem}"))
            if sys.stderr.isatty():
                print(f"\r{done}/{len(cases)} recordings", end="", file=sys.stderr)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    return [results[c] for c in cases if c in results], failures


def run_alone(cases, jobs, minutes=None):
    """The same, but each diagnosis has the machine for itself, as its user's has: recordings are made side by side, some
    ahead, and diagnosed one after the other."""
    results, failures, end = {}, [], time.monotonic() + 60.0 * (minutes or math.inf)
    with ProcessPoolExecutor(jobs) as pool:
        for first in range(0, len(cases), MADE_AHEAD):
            if time.monotonic() > end:
                break
            with tempfile.TemporaryDirectory(prefix="blind-") as scratch:
                batch = [(case, folder_of(case, scratch)) for case in cases[first:first + MADE_AHEAD]]
                made = [pool.submit(prepare, folder, case) for case, folder in batch]
                wait(made)
                for (case, folder), truth in zip(batch, made):
                    try:
                        results[case] = judged(folder, case, truth.result())
                    except Exception as problem:
                        failures.append((case, f"{type(problem).__name__}: {problem}"))
            if sys.stderr.isatty():
                print(f"\r{len(results) + len(failures)}/{len(cases)} recordings", end="", file=sys.stderr)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    return list(results.values()), failures


def print_report(results, failures, s, of_groups):
    for r in results:
        wrong = r["named"] if r["unknown"] else not r["exact"]
        if wrong:
            hidden = "+".join(r["hidden"] + r["unknown"]) or "nothing"
            share = ", ".join(f"{name} {q:.2g}" for name, q in r["share"].items() if q is not None)
            print(f"miss: seed {r['seed']} kind {r['kind']} plant {r['plant']}: hidden {hidden}, "
                  f"named {'+'.join(r['named']) or 'nothing'} ({r['verdict']}); share of floor: {share or '-'}")
        for p in r["parameters"]:
            if not p["inside"]:
                print(f"outside: seed {r['seed']} {r['kind']} {r['plant']}: {p['id']}.{p['name']} "
                      f"true {p['true']:.6g}, fit {p['fit']}, interval {p['ci95']}")
    for case, words in failures:
        print(f"failed: seed {case.seed} kind {case.kind} plant {case.plant}: {words}")
    for name, value in s.items():
        print(f"{name}: {value if not isinstance(value, float) else round(value, 4)}")
    for rows in of_groups.values():
        for line in group_score.report(rows, []):
            print(line)


def skip_check(args):
    """A test that hides an effect must fail when the hypothesis is left out: else it tests nothing."""
    cases = [Case(7000 + n, c, "second", args.digits, args.keep, args.iqfoc, None) for n, c in enumerate(effects.KNOWN)]
    found, failures = run_cases(cases, args.jobs)
    skipped, more = run_cases([case._replace(skip=effects.cause_of(case.kind)) for case in cases], args.jobs)
    for case, words in failures + more:
        print(f"failed: {case.kind}: {words}")
    passed_anyway = [r["kind"] for r in skipped if r["exact"]]
    for r, without in zip(found, skipped):
        print(f"{r['kind']}: named {'+'.join(r['named']) or 'nothing'}; "
              f"without its hypothesis: {'+'.join(without['named']) or 'nothing'} ({without['verdict']})")
    missed = [r["kind"] for r in found if not r["exact"]]
    if missed:
        print(f"not found even when allowed: {', '.join(missed)}")
    if passed_anyway:
        print(f"named although skipped: {', '.join(passed_anyway)}")
    return 1 if passed_anyway or missed or failures or more else 0


def quick(args):
    """Each cause of a dozen alone, or none: right or failed, one line each."""
    kinds = effects.CAUSES[:QUICK_CAUSES] + ["clean"] * (QUICK - QUICK_CAUSES)
    cases = [Case(8000 + n, kind, "second", False, args.keep, args.iqfoc, None) for n, kind in enumerate(kinds)]
    results, failures = run_cases(cases, args.jobs)
    wrong = 0
    for r in results:
        wrong += not r["exact"]
        print(f"{'ok   ' if r['exact'] else 'WRONG'} seed {r['seed']}: hidden {'+'.join(r['hidden']) or 'nothing'}, "
              f"named {'+'.join(r['named']) or 'nothing'} ({r['verdict']})")
    for case, words in failures:
        print(f"failed: seed {case.seed} kind {case.kind}: {words}")
    bad = wrong + len(failures)
    print(f"{100 * (len(cases) - bad) // len(cases)}% tests passed, {bad} tests failed out of {len(cases)}")
    return 1 if bad else 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ci", action="store_true", help="the fixed small set")
    parser.add_argument("--quick", action="store_true", help="twelve recordings of the second plant; each must be right")
    parser.add_argument("--digits", action="store_true", help="with last-digit errors in every motor file (digits.py)")
    parser.add_argument("--release", type=int, metavar="N", help="release set N, with --digits; once only")
    parser.add_argument("--scale", type=float, default=1.0, help="try --release with this share of it, on development seeds")
    parser.add_argument("--minutes", type=float, help="with --release: begin no recording after so long")
    parser.add_argument("--first", type=int, metavar="SEED", help="another set of the same kind: its first seed")
    parser.add_argument("--kind", help="recordings of this kind only: single, dead_time, resistance+angle_offset, ...")
    parser.add_argument("--group", choices=groups.GROUPS, help="recordings of this group only")
    parser.add_argument("--reliability", nargs="+", metavar="N", help="the probabilities of N recordings against what is right, or of those in "
                        "result files (--json)")
    parser.add_argument("--count", type=int, default=40, help="how many of --kind or --group (default 40)")
    parser.add_argument("--skip-check", action="store_true", help="check that skipping a hypothesis fails the test")
    parser.add_argument("--limits", action="store_true", help="detection limits instead of rates")
    parser.add_argument("--any-size", action="store_true", help="for --limits: name what is certain, however small it is")
    parser.add_argument("--seeds", type=int, default=20, help="seeds per cause for --limits")
    parser.add_argument("--causes", default=",".join(effects.CAUSES), help="causes for --limits, by commas")
    parser.add_argument("--plant", choices=["both", "second", "main"], default="both", help="one plant only")
    parser.add_argument("--skip", help="pass on to the diagnosis: hypotheses to leave out")
    parser.add_argument("--iqfoc", default=os.path.join(ROOT, "build", "host", "iqfoc"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="recordings side by side (default: all cores)")
    parser.add_argument("--keep", metavar="DIR", help="leave the recordings here, and reuse those that are")
    parser.add_argument("--json", metavar="F", help="all results as JSON")
    parser.add_argument("--docs", action="store_true", help="write the results into docs/blind_tests.md and its figure (a group: its table), or a release set into "
                        "docs/release-sets.md")
    parser.add_argument("--figure", metavar="F.svg", help="the confusion matrix as a figure")
    parser.add_argument("--table", metavar="F.md", help="the confusion matrix as a table")
    args = parser.parse_args()
    args.iqfoc = os.path.abspath(args.iqfoc)
    if not os.access(args.iqfoc, os.X_OK):
        parser.error(f"no program at {args.iqfoc}: build it first (./dev build) or name it by --iqfoc")
    if args.docs and (args.kind or args.ci):
        parser.error("--docs: the page holds the full set, without --kind and --ci")
    if args.first is not None and args.first >= release.FIRST_SEED:
        parser.error(f"--first: seeds from {release.FIRST_SEED} on are for release sets")
    args.keep = os.path.abspath(args.keep) if args.keep else None
    if args.minutes is not None and (args.release is None or args.minutes <= 0.0):
        parser.error("--minutes: a time above 0, with --release")
    if args.release is not None:
        check_release(parser, args)
    return args


def check_release(parser, args):
    """A release set is used once, on a tree that the published commit stands for."""
    if args.kind or args.ci or args.skip or args.first is not None or args.plant != "both":
        parser.error("--release: the set is what it is, without --kind, --ci, --skip, --first and --plant")
    if not 0 < args.release < 100 or not 0.0 < args.scale <= 1.0:
        parser.error("--release takes a set from 1 to 99, --scale a share above 0 and up to 1")
    args.digits = True
    args.commit = release.commit()
    if args.scale < 1.0:
        if args.docs:
            parser.error("--docs: the page holds whole sets, without --scale")
        return
    if args.keep:
        parser.error("--keep: a release set is not kept")
    if figure.is_published(args.release):
        parser.error(f"release set {args.release} is used up (docs/release-sets.md); take the next number")
    if args.commit is None:
        parser.error("the tree is not as committed; a release set is published with its commit")


def write_results(args, results, failures, s, of_groups):
    """`results`: of all recordings, those of the groups too."""
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump({"summary": s, "failures": [[list(c[:3]), w] for c, w in failures], "recordings": results},
                      file, indent=1)
    if args.figure:
        figure.write_svg([r for r in results if "group" not in r], args.figure)
    if args.table:
        with open(args.table, "w", encoding="utf-8") as file:
            file.write(figure.markdown([r for r in results if "group" not in r]))
    if args.docs and args.release is not None:
        figure.publish(args.release, args.commit, s, len(failures), of_groups, results)
        # The newest set is on two more pages.
        subprocess.run([sys.executable, os.path.join(ROOT, "tools", "figures.py"), "write", "front"], check=True)
    elif args.docs:
        figure.fill_page("rates", figure.rates_markdown(s, score.THRESHOLDS))
        figure.fill_page("confusion", figure.markdown(results))
        os.makedirs(os.path.join(figure.DOCS, "figures"), exist_ok=True)
        figure.write_svg(results, os.path.join(figure.DOCS, "figures", "confusion.svg"))


def built_from(iqfoc):
    """The commit that the program says it was built from."""
    said = subprocess.run([iqfoc, "version"], capture_output=True, text=True, check=True).stdout
    return said.split("commit ")[-1].rstrip(")\n")


def report_group(args, results, failures):
    """Prints what became of a group; fails where a recording could not be diagnosed."""
    for line in group_score.report(results, failures):
        print(line)
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump({"summary": group_score.summary(results), "failures": [[list(c[:3]), w] for c, w in failures],
                       "recordings": results}, file, indent=1)
    if args.docs and results:
        figure.fill_page(args.group, figure.group_markdown(results, built_from(args.iqfoc)))
    problems = group_score.below_asked(results) if len(results) >= group_score.LEAST else []
    for problem in problems:
        print(f"below: {problem}")
    return 1 if failures or not results or problems else 0


def report_reliability(args, results, failures):
    """Prints the probabilities against what is right."""
    for case, words in failures:
        print(f"failed: seed {case.seed} kind {case.kind} plant {case.plant}: {words}")
    text = figure.reliability_markdown(results)
    print(text, end="")
    if args.docs and results:
        seeds = [r["seed"] for r in results]
        head = f"{len(results)} recordings, seeds {min(seeds)} to {max(seeds)}, commit {built_from(args.iqfoc)}:\n\n"
        figure.fill_page("reliability", head + text)
    return 1 if failures or not results else 0


def kept_results(paths):
    """The judged recordings of result files."""
    results = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            results += json.load(file)["recordings"]
    return results


def main():
    args = arguments()
    if args.reliability and not args.reliability[0].isdigit():
        return report_reliability(args, kept_results(args.reliability), [])
    if args.skip_check:
        return skip_check(args)
    if args.limits:
        import limits
        return limits.run(args)

    if args.quick:
        return quick(args)
    if args.ci:
        # Of each group a few: they must run. How many are right is measured on whole groups.
        few = [Case(*case, True, args.keep, args.iqfoc, args.skip) for group, n in groups.FEW.items() for case in groups.cases(group, n)]
        _, broken = run_cases(few, args.jobs)
        for case, words in broken:
            print(f"failed: seed {case.seed} group {case.kind} plant {case.plant}: {words}")
        if broken:
            return 1

    cases = [Case(seed, kind, plant, args.digits, args.keep, args.iqfoc, args.skip) for seed, kind, plant in set_of(args)]
    print(f"{len(cases)} recordings, seeds {cases[0].seed} to {cases[-1].seed}" + (", last-digit errors" if args.digits else ""))
    run_set = run_cases if args.release is None else run_alone
    results, failures = run_set(cases, args.jobs, args.minutes)
    if args.group:
        return report_group(args, results, failures)
    if args.reliability:
        return report_reliability(args, results, failures)
    of_groups = {g: [r for r in results if r.get("group") == g] for g in groups.GROUPS}
    of_groups = {g: rows for g, rows in of_groups.items() if rows}
    apart = [r for r in results if "group" not in r]
    s = score.summary(apart)
    print_report(apart, failures, s, of_groups)
    write_results(args, results, failures, s, of_groups)
    thresholds = score.RELEASE_THRESHOLDS if args.release is not None else score.THRESHOLDS
    problems = score.below_threshold(s, not args.ci and not args.kind, thresholds)
    problems += [problem for rows in of_groups.values() for problem in group_score.below_asked(rows)]
    problems += [f"{len(failures)} recordings failed to run"] * bool(failures)
    for problem in problems:
        print(f"below threshold: {problem}")
    print("blind tests: " + ("thresholds missed" if problems else f"passed on {len(results)} recordings"))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
