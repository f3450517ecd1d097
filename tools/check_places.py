#!/usr/bin/env python3
"""Each public function is in the golden vectors and in a proof, and each public header with functions in the instruction counts; or
tools/places.txt says why not.

A function of include/iqfoc is in a place if the place's sources name it, or a function or macro that they name reaches it. For the counts
one function of a header is enough: that of a control cycle. tools/places.txt has the exceptions: place, header or function, reason.
Places: golden (tests/target/golden), prove (tests/prove), bench (bench/). The test tool_places runs this. Error bounds and MISRA have
checks of their own over all public headers: tools/bounds.py, tools/misra.py.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PLACES = {"golden": "tests/target/golden/*.c", "bench": "bench/*.c", "prove": "tests/prove/*.c"}
BY_FUNCTION = ("golden", "prove")
WORD = re.compile(r"[A-Za-z_]\w*")
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
FUNCTION = re.compile(r"^(?:(?!typedef|#|return|else)[A-Za-z_][\w \t*]*[ *\n])((?:iqfoc|iq24)_\w+)\s*\(", re.MULTILINE)
MACRO = re.compile(r"^#define (\w+)(.*(?:\\\n.*)*)", re.MULTILINE)


def without_comments(path):
    return COMMENT.sub(" ", path.read_text(encoding="utf-8"))


def body_at(text, start):
    """The function's body from its brace, or none if a declaration ends first."""
    brace, end = text.find("{", start), text.find(";", start)
    if brace < 0 or 0 <= end < brace:
        return ""
    depth = 0
    for at in range(brace, len(text)):
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        if depth == 0:
            return text[brace:at + 1]
    return ""


def public_functions(root):
    """{function: its header}, deprecated names left out, as they are macros."""
    found = {}
    for path in sorted((root / "include/iqfoc").glob("*.h")):
        found.update({name: path.name for name in FUNCTION.findall(without_comments(path))})
    return found


def bodies(root):
    """{function or macro: words that it names}, of the library."""
    found = {}
    for path in [*sorted((root / "src").glob("*.[ch]")), *sorted((root / "include/iqfoc").rglob("*.h"))]:
        text = without_comments(path)
        for match in re.finditer(r"^(?:(?!typedef|#|return|else)[A-Za-z_][\w \t*]*[ *\n])(\w+)\s*\(", text, re.MULTILINE):
            found.setdefault(match[1], set()).update(WORD.findall(body_at(text, match.end())))
        for name, value in MACRO.findall(text):
            found.setdefault(name, set()).update(WORD.findall(value))
    return found


def reached(sources, calls):
    """All functions that the sources name, or that those reach."""
    waiting = {word for path in sources for word in WORD.findall(without_comments(path))}
    seen = set()
    while waiting:
        word = waiting.pop()
        if word not in seen:
            seen.add(word)
            waiting |= calls.get(word, set()) - seen
    return seen


def exceptions(path):
    """{(place, name): reason}."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    return {tuple(line.split(" ", 2)[:2]): line.split(" ", 2)[2] for line in lines}


def missing(root):
    """{(place, function or header): its header}."""
    public, calls = public_functions(root), bodies(root)
    there = {place: reached(sorted(root.glob(pattern)), calls) for place, pattern in PLACES.items()}
    found = {(place, name): header for place in BY_FUNCTION for name, header in public.items() if name not in there[place]}
    counted = {header for name, header in public.items() if name in there["bench"]}
    found.update({("bench", header): header for header in set(public.values()) - counted})
    return found


def mistakes(root):
    left_out, found = exceptions(root / "tools/places.txt"), missing(root)
    wrong = [f"{header}: {name} is not in {PLACES[place]}; add it there, or to tools/places.txt with a reason"
             for (place, name), header in found.items() if not {(place, name), (place, header)} & set(left_out)]
    known = set(found) | {(place, header) for (place, _), header in found.items()}
    return wrong + [f"tools/places.txt: {place} {name}: nothing is missing there" for place, name in left_out if (place, name) not in known]


def main():
    wrong = mistakes(ROOT)
    print("\n".join(wrong) or f"{len(public_functions(ROOT))} public functions are in {', '.join(PLACES)}, or left out with a reason")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
