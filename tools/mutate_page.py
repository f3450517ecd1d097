"""The results of mutation testing: tools/mutate_results.json, the summary in docs/mutation.md, and build/mutation.md. See mutate.py."""
import collections
import json
import pathlib
import re
import subprocess

from marked import with_table

HEADERS = 40
DECISIONS = 100
HEADINGS = {"src": "The library's sources", "headers": "The library's headers", "decisions": "The diagnosis' decisions"}
COLUMNS = ("no code", "equivalent", "killed", "survived")


def decisions(root):
    """The diagnosis' files that weigh and choose causes and give the verdict."""
    folder = root / "sim_host/diagnose"
    steps = [path for step in ("weigh", "choose") for path in sorted((folder / step).glob("*.c"))]
    return [str(path.relative_to(root)) for path in (*steps, folder / "session.c", folder / "result.c")]


def counts(results):
    return collections.Counter(outcome.state for _, outcome in results)


def score(results):
    """Percent killed of the mutants that are neither equivalent, nor the same code, nor without code."""
    seen = counts(results)
    return percent(seen["killed"], seen["survived"])


def percent(killed, survived):
    return 100.0 * killed / (killed + survived) if killed + survived else 100.0


def summary(results):
    seen = counts(results)
    return (f"{len(results)} mutants: {seen['killed']} killed, {seen['survived']} survived, {seen['equivalent']} equivalent, "
            f"{seen['same code']} with the same code, {seen['no code']} that do not compile; {score(results):.1f} % killed")


def record(results, seed, commit):
    """The results of one part, as the file keeps them."""
    files = collections.defaultdict(list)
    for mutant, outcome in results:
        files[pathlib.PurePath(mutant.file).name].append((mutant, outcome))
    rows = {}
    for name, part in sorted(files.items()):
        seen = counts(part)
        rows[name] = {"no code": seen["no code"] + seen["same code"], **{key: seen[key] for key in COLUMNS[1:]}}
    return {"seed": seed, "commit": commit, "files": rows,
            "survived": [mutant.key for mutant, outcome in results if outcome.state == "survived"]}


def text_of(records):
    """The file's text: one line for each source file and each survivor."""
    def lines(opening, items, closing):
        return opening + "\n" + ",\n".join("   " + item for item in items) + closing if items else opening + closing

    parts = []
    for name, part in records.items():
        files = lines("{", [f"{json.dumps(key)}: {json.dumps(row)}" for key, row in part["files"].items()], "}")
        survived = lines("[", [json.dumps(key) for key in part["survived"]], "]")
        parts.append(f' {json.dumps(name)}: {{"seed": {part["seed"]}, "commit": {json.dumps(part["commit"])},\n'
                     f'  "files": {files},\n  "survived": {survived}}}')
    return "{\n" + ",\n".join(parts) + "\n}\n"


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


def row_of(name, cells):
    total = sum(cells.values())
    return (f"| {name} | {total} | {cells['no code']} | {cells['equivalent']} | {cells['killed']} | {cells['survived']} "
            f"| {percent(cells['killed'], cells['survived']):.1f} % |")


def total_of(part):
    return {key: sum(row[key] for row in part["files"].values()) for key in COLUMNS}


def table(part):
    """A row for each file of a part, and their sum."""
    lines = ["| file | mutants | no code, or the same | equivalent | killed | survived | killed of those that count |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
    return "\n".join(lines + [row_of(name, cells) for name, cells in part["files"].items()] + [row_of("all", total_of(part))])


def summary_table(records):
    """The table of docs/mutation.md: a row for each part."""
    lines = ["| part | mutants | no code, or the same | equivalent | killed | survived | killed of those that count | seed, sources |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |"]
    return "\n".join(lines + [f"{row_of(HEADINGS[name], total_of(part))} {part['seed']}, {part['commit']} |"
                              for name, part in records.items()])


def listed(known):
    reasons = collections.defaultdict(list)
    for key, reason in known.items():
        reasons[reason].append(key)
    return "\n\n".join(f"{reason}\n\n```\n" + "\n".join(keys) + "\n```" for reason, keys in reasons.items())


def whole_page(records, known):
    """The page with each file, each survivor and each equivalent mutant."""
    text = """# Mutation testing: every file, survivor and equivalent mutant

For developers who improve the tests: the results for each file, the mutants that no test fails on, and the mutants that change no result.
`./dev mutate --page` writes this page. [Mutation testing](mutation.md) says how it is done and what is not covered.
"""
    for name, part in records.items():
        survived = "```\n" + "\n".join(part["survived"]) + "\n```" if part["survived"] else "None."
        text += f"\n## {HEADINGS[name]}\n\nSeed {part['seed']}, sources of commit {part['commit']}.\n\n{table(part)}\n\nSurvived:\n\n{survived}\n"
    return text + f"\n## Equivalent mutants\n\n{listed(known)}\n"


def commit_of(root):
    return subprocess.run(["git", "log", "-1", "--format=%h"], cwd=root, capture_output=True, text=True, check=False).stdout.strip()


def updated(records, results, seed, commit):
    """The records with these parts replaced, in the order of HEADINGS."""
    merged = {**records, **{name: record(part, seed, commit) for name, part in results.items()}}
    return {name: merged[name] for name in HEADINGS if name in merged}


def with_summary(page, records):
    """The page's text with the table of these records."""
    return with_table(page, "mutation", summary_table(records))


def sections(text):
    """{heading: text below it}."""
    parts = re.split(r"^## (.*)\n\n", text, flags=re.M)
    return dict(zip(parts[1::2], parts[2::2]))
