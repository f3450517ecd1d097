#!/usr/bin/env python3
"""Plain words: counts words per sentence in the documents, and finds words that this project does not use.

    check_words.py              checks the tree; exit status 1 with a line for each finding
    check_words.py FILE...      the findings of these files, swept or not
    check_words.py --summary [FILE...]    a table of pages: sentences, mean words, longest sentence, unused words

Documents are README.md, docs/ and all other Markdown files but CHANGELOG.md. Checked there are sentences in paragraphs and lists: the
mean of a page is at most 20 words, and no sentence has more than 40. A code span or a link's address is at most one word. Tables, code,
headings and the blocks that programs write have no limit of length.

Words that are not used are looked for in documents (tables and headings included), and in the strings and comments of C, Python,
JavaScript and shell sources. tools/words_unswept.txt names pages and folders that are not checked yet. A path of that list that has no
finding any more, or does not exist, is a finding itself: remove its line.
"""

import argparse
import io
import pathlib
import re
import subprocess
import sys
import tokenize

ROOT = pathlib.Path(__file__).resolve().parent.parent
UNSWEPT = "tools/words_unswept.txt"
MEAN, LONGEST = 20, 40
# These two name the words; the change log's older sections are history.
NOT_CHECKED = {"tools/check_words.py", "tools/test_words.py", "CHANGELOG.md"}
C_LIKE = (".c", ".h", ".cpp", ".hpp", ".def", ".js", ".ino")

# Not used at all, with what to write instead.
UNUSED = [
    (r"mend(?:s|ed|ing|er)?", "correct, repair"),
    (r"noughts?", "zero"),
    (r"borne", "tolerated"),
    (r"reckon(?:s|ed|ing)?", "count, estimate"),
    (r"anew", "again"),
    (r"told", "reported, distinguished"),
    (r"beside", "next to, in addition to"),
    (r"worth a name", "above the reporting threshold"),
    (r"go(?:es)? by", "is called, uses"),
    (r"stands(?! (?:for|still|alone|in for)\b)|stood|stand (?:in(?! for\b)|at|on|above|below|between|here|there|behind|under|where)", "is, exists"),
    (r"(?:takes?|took|taken|taking) off", "reduces"),
    (r"of which", "write a second sentence"),
    (r"(?:does|do|did) (?:\w+ )?alike", "has the same effect"),
    # One name for one thing.
    (r"late voltages?", "voltage delay"),
    (r"late angles?", "angle delay"),
    (r"learnt drift", "disturbance estimate"),
    (r"last digits", "parameter tolerance"),
    (r"free[- ]run(?:s|ning)?(?! (?:timer|clock|counter))|(?:runs?|running) freely", "open-loop simulation"),
    (r"missing voltages?", "residual voltage"),
    (r"witness(?:es)?", "forward validation"),
]
WORDS = [(re.compile(r"\b(?:" + pattern.replace(" ", r"\s+") + r")\b", re.IGNORECASE), better) for pattern, better in UNUSED]
ANY_WORD = re.compile("|".join(pattern.pattern for pattern, _ in WORDS), re.IGNORECASE)
OPENINGS = re.compile(r"(?:Of|Where|As it is)\b(?! course\b)")

ABBREVIATION = re.compile(r"(?:^|[\s(])(?:e\.g|i\.e|cf|vs|etc|approx|ca|pp?|no|nos|vol|fig|figs|eqs?|sec|ch|dr|prof|al|resp|min|max|St|[A-Z])\.$",
                          re.IGNORECASE)
END_OF_SENTENCE = re.compile(r"[.!?][)\"'*_]*(?=\s)")
BLOCK = re.compile(r"<!-- *([\w-]+)(?:: .*)? *-->")
BLOCK_END = re.compile(r"<!-- *(?:[\w-]+: *)?end *-->")
WRITTEN = {"figures", "blind", "bench", "house", "modules", "misra", "mutation", "licences", "mutate"}
LIST_ITEM = re.compile(r"\s*(?:[-*+]|\d+[.)])\s+")


class Finding:
    def __init__(self, line, what, text):
        self.line, self.what, self.text = line, what, text


def blocks(text):
    """(kind, [(line number, line)]) of each paragraph, list item, heading and table row; code and what programs write are left out."""
    fence = written = comment = False
    in_list = blank = False
    gathered, kind = [], "paragraph"

    def flush():
        nonlocal gathered
        done, gathered = gathered, []
        return [(kind, done)] if done else []

    lines = text.split("\n")
    front = lines[0] == "---" and "---" in lines[1:]
    for number, line in enumerate(lines, 1):
        bare = line.strip()
        if front:
            front = number == 1 or bare != "---"
        elif bare.startswith(("```", "~~~")):
            yield from flush()
            fence = not fence
        elif fence:
            continue
        elif comment:
            comment = "-->" not in line
        elif BLOCK_END.fullmatch(bare):
            yield from flush()
            written = False
        elif BLOCK.fullmatch(bare) and (BLOCK.fullmatch(bare)[1] in WRITTEN or bare.endswith(": begin -->")):
            yield from flush()
            written = True
        elif written or BLOCK.fullmatch(bare):
            yield from flush()
        elif bare.startswith("<!--"):
            yield from flush()
            comment = "-->" not in line
        elif not bare:
            yield from flush()
            blank, kind = True, "paragraph"
            continue
        elif bare.startswith("|"):
            yield from flush()
            yield "table", [(number, bare)]
        elif re.match(r"#{1,6} ", bare):
            yield from flush()
            yield "heading", [(number, bare.lstrip("# "))]
        elif LIST_ITEM.match(line) and (blank or in_list or not gathered):
            yield from flush()
            in_list, kind = True, "item"
            gathered.append((number, LIST_ITEM.sub("", line, count=1)))
        elif line.startswith("    ") and not gathered and not in_list:
            continue  # code
        elif line.startswith("        ") and not gathered:
            continue  # code in a list
        else:
            if not line.startswith(" ") and blank:
                in_list = False
            gathered.append((number, re.sub(r"^>\s?", "", bare)))
        blank = False
    yield from flush()


def plain(text):
    """The words of Markdown: images gone, links by their text, a code span or formula as one word, no emphasis marks."""
    text = re.sub(r"``.+?``|`[^`]+`", lambda span: "X" + "x" * (len(span[0]) - 1), text)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"\[([^\]]*)\](?:\([^)]*\)|\[[^\]]*\])", r"\1", text)
    text = re.sub(r"<(?:https?://[^>]*|[/\w][^>]*)>", " ", text)
    text = re.sub(r"\$[^$\n]+\$", "X", text)
    return re.sub(r"\*\*|(?<!\w)[*_](?=\w)|(?<=\w)[*_](?!\w)", "", text)


def sentences(lines):
    """(line number, words, text) of each sentence of a block's lines."""
    whole, starts = "", []
    for number, line in lines:
        starts.append((len(whole), number))
        whole += line + "\n"
    # Spans keep their length, so that an offset leads to its line; links do not, and are replaced within a sentence.
    masked = re.sub(r"``.+?``|`[^`]+`|\]\([^)]*\)|\$[^$]+\$", lambda span: re.sub(r"[.!?\s]", "x", span[0]), whole)
    begin = 0
    cuts = [match.end() for match in END_OF_SENTENCE.finditer(masked)
            if not ABBREVIATION.search(masked[:match.start() + 1][-14:]) and not ends_nothing(masked, match)]
    for end in [*cuts, len(masked)]:
        raw = whole[begin:end]
        text = " ".join(plain(raw).split())
        count = sum(1 for word in text.split() if re.search(r"\w", word))
        if count:
            first = begin + len(raw) - len(raw.lstrip())
            yield max((start, number) for start, number in starts if start <= first)[1], count, " ".join(raw.split())
        begin = end


def ends_nothing(text, match):
    """An ellipsis within a sentence, or a point before a small letter that belongs to what stands ahead of it."""
    return text[:match.start() + 1].endswith("..") and re.match(r"\s+[a-z0-9=<>,]", text[match.end():])


def unused(text):
    """(word, what to write instead) of each unused word of a text."""
    for pattern, better in WORDS:
        match = pattern.search(text)
        if match:
            yield match[0], better


def check_document(text):
    """(findings, [words of each sentence]) of a Markdown text."""
    findings, counts = [], []
    for kind, lines in blocks(text):
        if kind in ("table", "heading"):
            number, line = lines[0]
            words = re.sub(r"`[^`]+`", "x", line)
            findings += [Finding(number, f'"{word}" ({better})', line.strip()) for word, better in unused(words)]
            continue
        for number, count, sentence in sentences(lines):
            counts.append(count)
            words = plain(sentence)
            findings += [Finding(number, f'"{word}" ({better})', sentence) for word, better in unused(words)]
            if OPENINGS.match(words) and kind == "paragraph":
                findings.append(Finding(number, f'begins with "{OPENINGS.match(words)[0]}"', sentence))
            if count > LONGEST:
                findings.append(Finding(number, f"{count} words, at most {LONGEST}", sentence))
    if counts and sum(counts) > MEAN * len(counts):
        findings.append(Finding(1, f"mean {sum(counts) / len(counts):.1f} words a sentence, at most {MEAN}", "the whole page"))
    return findings, counts


C_TEXT = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.DOTALL)


def c_texts(text):
    """(line number, text) of the comments and strings of C."""
    masked = re.sub(r'^\s*#\s*include[^\n]*', "", text, flags=re.MULTILINE)
    for match in C_TEXT.finditer(masked):
        yield masked.count("\n", 0, match.start()) + 1, match[0]


def python_texts(text):
    """(line number, text) of the comments and strings of Python."""
    try:
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type in (tokenize.COMMENT, tokenize.STRING) or tokenize.tok_name[token.type] == "FSTRING_MIDDLE":
                yield token.start[0], token.string
    except (tokenize.TokenError, SyntaxError):
        yield 1, text


def kind_of(path, text):
    """document, c, python, shell or None."""
    if path.endswith(".md"):
        return "document"
    if path.endswith(C_LIKE):
        return "c"
    if path.endswith(".py") or re.match(r"#!.*python", text):
        return "python"
    if path.endswith(".sh") or re.match(r"#!.*\bsh\b|#!.*bash", text):
        return "shell"
    return None


def check_source(kind, text):
    texts = {"c": c_texts, "python": python_texts, "shell": lambda all_of_it: enumerate(all_of_it.split("\n"), 1)}[kind](text)
    findings = []
    for number, piece in texts:
        # A comment's lines are one text, so that a phrase over two lines is found; the finding names its line.
        flat = re.sub(r"\n[\s/#*]*", lambda gap: "\n" + " " * (len(gap[0]) - 1), piece)
        if not ANY_WORD.search(flat):
            continue
        for pattern, better in WORDS:
            for match in pattern.finditer(flat):
                near = " ".join(flat[max(0, match.start() - 60):match.end() + 60].split())
                findings.append(Finding(number + piece.count("\n", 0, match.start()), f'"{" ".join(match[0].split())}" ({better})', near))
    return findings


def check_file(root, path):
    """(findings, counts) of a file; None if it is of no kind that is checked."""
    try:
        text = (root / path).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None
    kind = kind_of(path, text[:60])
    if kind is None:
        return None
    return check_document(text) if kind == "document" else (check_source(kind, text), [])


def tracked(root):
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root, check=True, capture_output=True, text=True).stdout
    return sorted(f for f in listed.split("\n")
                  if f and f not in NOT_CHECKED and (root / f).is_file() and not (root / f).is_symlink()
                  and (f.endswith((".md", ".py", ".sh", *C_LIKE)) or "." not in pathlib.PurePosixPath(f).name))


def unswept(root):
    """The paths of the list of what is not checked yet."""
    file = root / UNSWEPT
    if not file.exists():
        return []
    lines = (line.split("#")[0].strip().rstrip("/") for line in file.read_text(encoding="utf-8").split("\n"))
    return [line for line in lines if line]


def covers(entry, path):
    """Is this path the entry's, or in its folder? FOLDER/* are the files right in it."""
    if entry.endswith("/*"):
        return path.rpartition("/")[0] == entry[:-2]
    return path == entry or path.startswith(entry + "/")


def check_tree(root=ROOT, out=sys.stdout):
    files = tracked(root)
    entries = unswept(root)
    found = {entry: 0 for entry in entries}
    wrong = checked = 0
    for path in files:
        result = check_file(root, path)
        if result is None:
            continue
        covering = [entry for entry in entries if covers(entry, path)]
        for entry in covering:
            found[entry] += len(result[0])
        if covering:
            continue
        checked += 1
        wrong += show(path, result[0], out)
    for entry in entries:
        if not found[entry]:
            print(f"{UNSWEPT}: {entry} has no finding: remove its line", file=out)
            wrong += 1
    print(f"plain words: {checked} files checked, {wrong} findings; {len(entries)} paths not swept yet", file=out)
    return 1 if wrong else 0


def show(path, findings, out):
    for finding in sorted(findings, key=lambda finding: finding.line):
        print(f"{path}:{finding.line}: {finding.what}: {finding.text}", file=out)
    return len(findings)


def summary(root, paths, out=sys.stdout):
    rows = []
    for path in paths:
        result = check_file(root, path)
        if result is not None and result[1]:
            rows.append((sum(result[1]) / len(result[1]), max(result[1]), len(result[1]),
                         sum(1 for finding in result[0] if finding.what.startswith('"')), path))
    print("| page | sentences | words a sentence | longest | unused words |\n| --- | ---: | ---: | ---: | ---: |", file=out)
    for mean, longest, count, words, path in sorted(rows, reverse=True):
        print(f"| {path} | {count} | {mean:.1f} | {longest} | {words} |", file=out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--summary", action="store_true", help="a table of pages")
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    named = [str(file.resolve().relative_to(ROOT)) for file in options.files]
    if options.summary:
        summary(ROOT, named or [file for file in tracked(ROOT) if file.endswith(".md")])
        return 0
    if not named:
        return check_tree()
    return 1 if sum(show(path, (check_file(ROOT, path) or ([], []))[0], sys.stdout) for path in named) else 0


if __name__ == "__main__":
    sys.exit(main())
