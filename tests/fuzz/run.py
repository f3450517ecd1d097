#!/usr/bin/env python3
"""Runs the fuzzers (docs/fuzzing.md), each beginning with what the tree holds of its kind and with every input that once did harm.

Usage: tests/fuzz/run.py --build FOLDER [--seconds S] [--only NAME] [--planted] [--docs]

    --seconds S   for each fuzzer (30)
    --planted     instead, that a bound taken out of a reader is found: the check can fail
    --docs        write the table into docs/fuzzing.md

Inputs that a run found worth keeping stay in FOLDER/corpus for the next; what does harm is written to FOLDER/harm and ends the run with
status 1.
"""

import argparse
import concurrent.futures
import gzip
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
SEED = 20261122
LONGEST = {"recording": 8192, "log": 8192, "motor": 4096, "scenario": 4096, "map": 4096, "wire": 2048, "board": 4096, "diagnosis": 256}
MEANS = {
    "recording": "recordings, plain and gzip",
    "motor": "motor files",
    "scenario": "scenarios",
    "map": "maps of foreign logs",
    "log": "foreign logs, mapped by their own header",
    "wire": "the recorder's line",
    "board": "the emulated board's line, and the cycle behind it",
    "diagnosis": "whole diagnoses of changed recordings and motor files",
}
# Kinds whose input is text: words of the seeds are given to the fuzzer as a dictionary.
TEXT = ("recording", "motor", "scenario", "map", "log")


def head(path, lines):
    opener = gzip.open if path.suffix == ".gz" else open
    with opener(path, "rt", encoding="utf-8") as file:
        return "".join(line for _, line in zip(range(lines), file)).encode()


def seeds_of(name):
    """What the tree holds of a kind, short."""
    if name in ("recording", "log"):
        texts = [head(path, 30) for path in sorted((ROOT / "data" / "recordings").glob("*.csv.gz"))]
        return texts + ([gzip.compress(texts[0], mtime=0)] if name == "recording" else
                        [texts[0].replace(b",", b";").replace(b".", b","), texts[0].replace(b",", b"\t")])
    if name == "motor":
        return [path.read_bytes() for folder in ("motors", "recordings") for path in sorted((ROOT / "data" / folder).glob("*.toml"))]
    if name == "scenario":
        return [path.read_bytes() for path in sorted((ROOT / "data" / "scenarios").glob("*.toml"))]
    if name == "map":
        text = (ROOT / "docs" / "interfaces.md").read_text(encoding="utf-8")
        return [block.encode() for block in re.findall(r"```\w*\n(.*?)```", text, re.S) if "[columns]" in block]
    if name == "wire":
        return [frames(rows) for rows in (1, 3, 8)]
    return [bytes(64), bytes(range(256))]


def frames(rows):
    """A stream as fuzz_wire reads it, whose CRCs it makes itself: a header of three channels, rows, an end."""
    def frame(kind, sequence, *words):
        words = [1 | kind << 8 | sequence << 16, 7, *words]
        return bytes([len(words)]) + struct.pack(f"<{len(words)}I", *words)

    channels = [word for column in range(3) for word in (column, 997000000, 50)]
    values = [word for cycle in range(rows) for word in (cycle, 1 << 24, 1 << 20, 12345)]
    return (bytes([0]) + frame(1, 0, 1759218604, 43, 1, 3, *channels) + frame(2, 1, 0, rows, *values) + frame(3, 2, 0, rows))


def prepare(name, build):
    """The folder of inputs to begin with, and the options that hold for the kind."""
    corpus = build / "corpus" / name
    corpus.mkdir(parents=True, exist_ok=True)
    words = set()
    for number, text in enumerate(seeds_of(name)):
        (corpus / f"seed-{number}").write_bytes(text)
        words |= set(re.findall(rb"[A-Za-z_][A-Za-z0-9_]{2,30}", text))
    options = [f"-max_len={LONGEST[name]}"]
    if name in TEXT:
        dictionary = build / "corpus" / f"{name}.words"
        dictionary.write_text("".join(f'"{word.decode()}"\n' for word in sorted(words)), encoding="utf-8")
        options.append(f"-dict={dictionary}")
    return corpus, options


def run_fuzzer(name, build, seconds):
    """The figures of a run, or what was found."""
    corpus, options = prepare(name, build)
    harm = build / "harm"
    harm.mkdir(exist_ok=True)
    known = [str(HERE / "harmful" / name)] if (HERE / "harmful" / name).is_dir() else []
    done = subprocess.run(
        [build / "fuzz" / f"fuzz_{name}", f"-max_total_time={seconds}", f"-seed={SEED}", "-timeout=60", "-rss_limit_mb=1024",
         "-print_final_stats=1", f"-artifact_prefix={harm}/{name}-", *options, str(corpus), *known],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env={**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1"}, check=False)
    told = done.stderr.decode("utf-8", "replace")
    if done.returncode != 0:
        return {"name": name, "harm": told}
    runs = re.search(r"number_of_executed_units: *(\d+)", told)
    peak = re.search(r"peak_rss_mb: *(\d+)", told)
    branches = re.findall(r" cov: (\d+)", told)
    return {"name": name, "runs": int(runs.group(1)), "branches": int(branches[-1]), "peak_MB": int(peak.group(1))}


def table(results, seconds):
    rows = [f"| fuzzer | reads | inputs in {seconds} s | branches | most memory, MB |", "| --- | --- | ---: | ---: | ---: |"]
    rows += [f"| `{r['name']}` | {MEANS[r['name']]} | {r['runs']:,} | {r['branches']:,} | {r['peak_MB']} |" for r in results]
    return "\n".join(rows) + "\n"


def write_docs(text):
    path = ROOT / "docs" / "fuzzing.md"
    page = path.read_text(encoding="utf-8")
    begin, end = "<!-- fuzz: table -->\n", "<!-- end -->"
    at = page.index(begin) + len(begin)
    path.write_text(page[:at] + "\n" + text + "\n" + page[page.index(end, at):], encoding="utf-8")


# A bound in the reader of the recorder's line, and what is left when it is taken out.
PLANTED_FILE = "sim_host/record/wire_reader.c"
PLANTED = ("r->octets == sizeof r->data", "false")


def planted(build, seconds):
    """A reader without one of its bounds is caught."""
    text = (ROOT / PLANTED_FILE).read_text(encoding="utf-8")
    if text.count(PLANTED[0]) != 1:
        sys.exit(f"{PLANTED_FILE}: '{PLANTED[0]}' is expected once")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "wire_reader.c").write_text(text.replace(*PLANTED), encoding="utf-8")
        subprocess.run(
            ["clang", "-g", "-O1", "-D_GNU_SOURCE", "-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all",
             f"-I{ROOT}/include", f"-I{ROOT}/sim_host", f"-I{ROOT}/sim_host/record", folder / "wire_reader.c", HERE / "fuzz_wire.c",
             HERE / "fuzz.c", "-lz", "-lm", "-o", folder / "fuzz_planted"], check=True)
        corpus, options = prepare("wire", build)
        done = subprocess.run([folder / "fuzz_planted", *options, corpus, f"-max_total_time={seconds}", f"-seed={SEED}", f"-artifact_prefix={folder}/"],
                              capture_output=True, check=False)
    if done.returncode == 0:
        print(f"a reader without its bound was not caught in {seconds} s", file=sys.stderr)
        return 1
    print("a reader without its bound was caught")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--seconds", type=int, default=30)
    parser.add_argument("--only", choices=sorted(MEANS))
    parser.add_argument("--planted", action="store_true")
    parser.add_argument("--docs", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    if options.planted:
        return planted(options.build, options.seconds)

    names = [options.only] if options.only else list(MEANS)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda name: run_fuzzer(name, options.build.resolve(), options.seconds), names))
    bad = [r for r in results if "harm" in r]
    for r in bad:
        print(f"fuzz_{r['name']} found:\n" + "\n".join(r["harm"].splitlines()[-60:]), file=sys.stderr)
    if not bad:
        text = table(results, options.seconds)
        print(text, end="")
        if options.docs:
            write_docs(text)
    print(f"{100 * (len(results) - len(bad)) // len(results)}% tests passed, {len(bad)} tests failed out of {len(results)}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
