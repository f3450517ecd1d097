#!/usr/bin/env python3
"""Mutation testing: makes small mistakes in the code; a unit test should fail on each.

tools/mutators.py makes a mistake in one file. The tool compiles that file and its includers as the host preset does, and links them with
the objects of all other sources to a shared library. The unit tests are linked against that library once. Tests that call the changed
function run with the mutant's library, the fastest first, until one fails or exceeds several times its usual processor time. A mutant
survives if no test fails on it. A mutant that compiles to the same code does not count. tools/mutate_equivalent.txt lists those that
change no result, with the reason: each must still exist and survive. Needs build/host with its tests.

    tools/mutate.py --sample 600         that many mutants of src/, chosen by --seed; --file F: of one file, headers in include/iqfoc too
    tools/mutate.py --docs ...           updates tools/mutate_results.json and the summary in docs/mutation.md with the sample, one of the
                                         headers, and one of the diagnosis' decisions; --part P: one of src, headers, decisions alone
    tools/mutate.py --page               writes build/mutation.md from these results; runs no mutant
    tools/mutate.py --check              what CI runs: known mutants are killed, one in untested code survives
Results are kept in build/mutate, by the bytes of library and test. --seconds N: ends after N seconds; the next call continues.
"""
import argparse
import concurrent.futures
import hashlib
import pathlib
import sys
import threading
import time

import mutate_bench
import mutate_page
import mutators

ROOT = pathlib.Path(__file__).resolve().parent.parent
EQUIVALENT = ROOT / "tools/mutate_equivalent.txt"
KNOWN = ROOT / "tools/mutate_known.txt"
RESULTS = ROOT / "tools/mutate_results.json"
PAGE = ROOT / "docs/mutation.md"
WHOLE = ROOT / "build/mutation.md"
LEAST_PERCENT = 95.0
FEWEST = 5  # of each file in a sample
PLANTED = "\nint32_t iqfoc_planted(int32_t x);\nint32_t iqfoc_planted(int32_t x)\n{\n    return x > 3 ? 2 * x : x;\n}\n"


def mutants_of(file, extra=""):
    return mutators.mutants(file, (ROOT / file).read_text(encoding="utf-8") + extra)


def sample(files, count, seed):
    """At least FEWEST of each file, the rest from all alike; the same ones for the same seed, however the files change elsewhere."""
    def rank(mutant):
        return hashlib.sha256(f"{seed} {mutant.key}".encode()).digest()

    first, rest = [], []
    for file in files:
        ranked = sorted(mutants_of(file), key=rank)
        first += ranked[:FEWEST]
        rest += ranked[FEWEST:]
    chosen = sorted(first, key=rank)[:count] + sorted(rest, key=rank)[:max(count - len(first), 0)]
    return sorted(chosen, key=lambda m: (m.file, m.start, m.new))


def equivalents():
    """{key: reason}. The file has keys, then their reason on an indented line."""
    found, keys = {}, []
    for line in EQUIVALENT.read_text(encoding="utf-8").split("\n"):
        if line.startswith(" ") and line.strip():
            found.update({key: line.strip() for key in keys})
            keys = []
        elif line and not line.startswith("#"):
            keys.append(line)
    if keys:
        sys.exit(f"tools/mutate_equivalent.txt gives no reason for {keys[0]}")
    return found


def stale(keys):
    """Those of the keys that name no mutant of the tree."""
    there = {mutant.key for file in {key.split(":")[0] for key in keys} if (ROOT / file).exists() for mutant in mutants_of(file)}
    return sorted(set(keys) - there)


def run(bench, chosen, jobs, until=None, on_result=None):
    """[(mutant, outcome)] of those that were reached in time."""
    done, lock = [], threading.Lock()

    def one(mutant):
        if until is not None and time.monotonic() > until:
            return
        outcome = bench.try_out(mutant)
        with lock:
            done.append((mutant, outcome))
            if on_result is not None:
                on_result(mutant, outcome)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for future in [pool.submit(one, mutant) for mutant in chosen]:
            future.result()
    return sorted(done, key=lambda pair: (pair[0].file, pair[0].start, pair[0].new))


def told(mutant, outcome):
    if outcome.state == "survived":
        print(f"survived  {mutant.file}:{mutant.line}: {mutant.key.split(': ', 1)[1]}", flush=True)


def judged(results, known):
    """The results with the listed equivalents called so, and what is wrong with the list."""
    wrong = []
    for mutant, outcome in results:
        if mutant.key in known and outcome.state == "survived":
            outcome.state, outcome.why = "equivalent", known[mutant.key]
        elif mutant.key in known and outcome.state == "killed":
            wrong.append(f"listed as equivalent, but {outcome.why} fails: {mutant.key}")
    return wrong


def check(bench, jobs):
    """Of the mutants in tools/mutate_known.txt, each with a test: all are killed by it. A planted one of a function that nothing calls
    survives."""
    lines = [line.split(": ", 1) for line in KNOWN.read_text(encoding="utf-8").split("\n") if line and not line.startswith("#")]
    killer = {key: test for test, key in lines}
    wrong = [f"names no mutant: {key}" for key in stale([*killer, *equivalents()])]
    there = {mutant.key: mutant for file in {key.split(":")[0] for key in killer} for mutant in mutants_of(file)}
    bench.prepare({*killer.values(), "restart"})
    bench.only = {key: [test] for key, test in killer.items()}
    results = run(bench, [there[key] for key in killer if key in there], jobs)
    wrong += [f"{outcome.state}, not killed by {killer[mutant.key]}: {mutant.key}" for mutant, outcome in results
              if outcome.state != "killed"]
    length = len((ROOT / "src/restart.c").read_text(encoding="utf-8"))
    planted = [mutant for mutant in mutants_of("src/restart.c", PLANTED) if mutant.start > length]
    bench.only = {mutant.key: ["restart"] for mutant in planted}
    seen = [outcome.state for _, outcome in run(bench, planted, jobs)]
    if seen.count("survived") < 3 or set(seen) - {"survived", "same code", "no code"}:
        wrong.append(f"planted where nothing is tested: {', '.join(seen)}, not all of them survived")
    print("\n".join(wrong) or f"{len(results)} known mutants killed, {seen.count('survived')} planted ones seen to survive")
    return 1 if wrong else 0


def write_page():
    """build/mutation.md: every file, survivor and equivalent mutant."""
    WHOLE.parent.mkdir(exist_ok=True)
    WHOLE.write_text(mutate_page.whole_page(mutate_page.read(RESULTS), equivalents()), encoding="utf-8")
    print(f"{WHOLE.relative_to(ROOT)}: every file, survivor and equivalent mutant")
    return 0


def keep(results, seed):
    """The parts that were run, in the file of results and in the page's summary. Other parts stay as they are."""
    records = mutate_page.updated(mutate_page.read(RESULTS), results, seed, mutate_page.commit_of(ROOT))
    RESULTS.write_text(mutate_page.text_of(records), encoding="utf-8")
    PAGE.write_text(mutate_page.with_summary(PAGE.read_text(encoding="utf-8"), records), encoding="utf-8")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--sample", type=int, metavar="N", help="so many mutants (all, if not given with --file)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--file", action="append", metavar="F", help="of these files only")
    parser.add_argument("--jobs", "-j", type=int, default=2)
    parser.add_argument("--seconds", type=float, metavar="N", help="end after so long; what is done is kept")
    parser.add_argument("--build", default="build/host", help="folder of the host preset's build")
    parser.add_argument("--docs", action="store_true", help="update tools/mutate_results.json and docs/mutation.md")
    parser.add_argument("--page", action="store_true", help="write build/mutation.md from tools/mutate_results.json")
    parser.add_argument("--part", action="append", choices=list(mutate_page.HEADINGS), help="with --docs: these parts of it alone")
    parser.add_argument("--check", action="store_true", help="what CI runs")
    parser.add_argument("--list", action="store_true", help="name the mutants, run none")
    return parser.parse_args()


def main():
    given = arguments()
    if given.page:
        return write_page()
    library = [str(path.relative_to(ROOT)) for path in sorted((ROOT / "src").glob("*.[ch]"))]
    files = given.file or library
    for file in files:
        if not (ROOT / file).is_file():
            sys.exit(f"{file}: there is no such file")
    chosen = sample(files, given.sample or (10 ** 9 if given.file else 600), given.seed)
    if given.list:
        print("\n".join(mutant.key for mutant in chosen))
        return 0
    bench = mutate_bench.Bench(ROOT, ROOT / given.build, ROOT / "build/mutate")
    if given.check:
        return check(bench, given.jobs)
    known = equivalents()
    wrong = [f"tools/mutate_equivalent.txt names no mutant: {key}" for key in stale(known)]
    parts = [("src", chosen)]
    if given.docs:
        headers = [str(path.relative_to(ROOT)) for path in sorted((ROOT / "include/iqfoc").glob("*.h"))]
        parts += [("decisions", sample(mutate_page.decisions(ROOT), mutate_page.DECISIONS, given.seed)),
                  ("headers", sample(headers, mutate_page.HEADERS, given.seed))]
        parts = [(name, part) for name, part in parts if name in (given.part or mutate_page.HEADINGS)]
    until = None if given.seconds is None else time.monotonic() + given.seconds
    results, missing = {}, 0
    for name, part in parts:
        bench.prepare_for(part)
        results[name] = run(bench, part, given.jobs, until, lambda m, o: m.key in known or told(m, o))
        missing += len(part) - len(results[name]) if name == "src" or given.part else 0
        wrong += judged(results[name], known)
    for name, part in results.items():
        print(f"{name}: {mutate_page.summary(part)}")
    print("\n".join(wrong), end="\n" if wrong else "")
    if missing:
        print(f"{missing} not yet tried; the same command goes on from here")
        return 3
    if given.docs:
        keep(results, given.seed)
    return 1 if wrong or mutate_page.score(results.get("src", [])) < LEAST_PERCENT else 0


if __name__ == "__main__":
    sys.exit(main())
