"""docs/mutation.md, and what is counted for it: see mutate.py."""
import collections
import pathlib
import re
import subprocess

HEADERS = 40
DECISIONS = 100


def decisions(root):
    """The diagnosis' files that choose causes and give the verdict."""
    folder = root / "sim_host/diagnose"
    return [str(path.relative_to(root)) for path in (*sorted((folder / "choose").glob("*.c")), folder / "result.c")]


def counts(results):
    return collections.Counter(outcome.state for _, outcome in results)


def score(results):
    """Percent of the mutants that are none of equivalent, same code and no code."""
    seen = counts(results)
    real = seen["killed"] + seen["survived"]
    return 100.0 * seen["killed"] / real if real else 100.0


def summary(results):
    seen = counts(results)
    return (f"{len(results)} mutants: {seen['killed']} killed, {seen['survived']} survived, {seen['equivalent']} equivalent, "
            f"{seen['same code']} with the same code, {seen['no code']} that do not compile; {score(results):.1f} % killed")


def table(results):
    if not results:
        return "None tried."
    lines = ["| file | mutants | no code, or the same | equivalent | killed | survived | killed of those that count |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
    files = collections.defaultdict(list)
    for mutant, outcome in results:
        files[mutant.file].append((mutant, outcome))
    for name, part in [*sorted(files.items()), ("all", results)]:
        seen = counts(part)
        lines.append(f"| {pathlib.PurePath(name).name} | {len(part)} | {seen['no code'] + seen['same code']} | {seen['equivalent']} "
                     f"| {seen['killed']} | {seen['survived']} | {score(part):.1f} % |")
    return "\n".join(lines)


def survivors(results):
    found = [f"{mutant.key}" for mutant, outcome in results if outcome.state == "survived"]
    return "```\n" + "\n".join(found) + "\n```" if found else "None."


def listed(known):
    reasons = collections.defaultdict(list)
    for key, reason in known.items():
        reasons[reason].append(key)
    return "\n\n".join(f"{reason}\n\n```\n" + "\n".join(keys) + "\n```" for reason, keys in reasons.items())


HEADINGS = {"src": "The library's sources", "headers": "The library's headers", "decisions": "The diagnosis' decisions"}
WHAT = {
    "src": "",
    "headers": """What is inline is compiled into the tests: for each mutant here the library and each test's own source are built anew, so that the sample
is smaller, as many as the time given to the tool allowed. What the host's parts have of it inline stays as it is.

""",
    "decisions": """What chooses the causes and gives the verdict, by its quick tests: `test_choose.c` and its like have each rule on sums that are made by
hand, `test_choose_looks.c` a few recordings. The blind recordings, which say how good the decisions are, take hours and are not asked.

""",
}


def section(name, results, seed, commit):
    return f"""{WHAT[name]}Seed {seed}, on the sources of {commit}:

{table(results)}

Survived:

{survivors(results)}
"""


def sections(text):
    """{heading: what stands below it}."""
    parts = re.split(r"^## (.*)\n\n", text, flags=re.M)
    return dict(zip(parts[1::2], (part.rstrip("\n") + "\n" for part in parts[2::2])))


def write(path, results, seed, known):
    """Parts without results stay as the page has them."""
    commit = subprocess.run(["git", "log", "-1", "--format=%h"], cwd=path.parent, capture_output=True, text=True, check=False).stdout.strip()
    below = sections(path.read_text(encoding="utf-8"))
    below.update({HEADINGS[name]: section(name, part, seed, commit) for name, part in results.items()})
    below["Equivalent mutants"] = listed(known) + "\n"
    path.write_text("""# Mutation testing

Written by `./dev mutate --docs --seed N`, a part of it with `--part`. A mutant is the library with one small mistake in it: a
relation, an operator or a sign turned round, a constant one up or down, a rounding or a saturation left out, a condition negated, a
statement left out, a member taken for its neighbour, another value returned. A test should fail on each; a mutant that no test fails on
has survived, and says what the tests do not look at. Tried is a sample, the same one for the same seed. What survives in a sample is
what the tests are then mended by: another seed will show others.

The tests are the unit tests alone: not the golden vectors, exhaustive sweeps, blind recordings or the program. A mutant that does not
compile, or compiles to the same code, is none. Some others change no result that a caller can see; they are listed with the reason
([tools/mutate_equivalent.txt](../tools/mutate_equivalent.txt)), which is ours to get right: the tool checks that they are still there
and that no test fails on one. CI tries a few mutants known to be killed, and one planted where nothing is tested, which must be seen to
survive.
""" + "".join(f"\n## {heading}\n\n{below[heading]}" for heading in (*HEADINGS.values(), "Equivalent mutants")), encoding="utf-8")
