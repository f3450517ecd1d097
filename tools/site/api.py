"""Writes the library's headers as Markdown, a page for each header: declarations by doxygen, text by the comments above them.

Doxygen says what is declared, where, with which fields and values. The comments are taken from the source as they stand, since
their formulas are laid out by hand: lines indented by four become code.
"""

import pathlib
import re
import subprocess
import xml.etree.ElementTree

DOXYFILE = """
INPUT = {include}
OUTPUT_DIRECTORY = {out}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
EXTRACT_STATIC = YES
OPTIMIZE_OUTPUT_FOR_C = YES
RECURSIVE = YES
MARKDOWN_SUPPORT = NO
MACRO_EXPANSION = NO
QUIET = YES
WARNINGS = NO
FILTER_PATTERNS = *.h="sed -E 's#^( +[^/]*[^ /].*[^ ]) +/[*] #\\1 /**< #'"
"""
# What a paragraph or a sentence of a comment tells of: set in bold, so that it is found at a glance.
LABEL = re.compile(r"(?:^|(?<=[.;] ))((?:Range|Error|Errors|In|Out|Returns|Overflow|Precondition|Source)(?: [a-z]+)?:|Largest error:?)")
# A search finds the documents ahead of the functions: "dead time" begins the names of the deadbeat controllers.
BEHIND_DOCUMENTS = "---\nsearch:\n  boost: 0.3\n---\n\n"
KNOWN = re.compile(r"\b(?:iqfoc|iq24|IQFOC|IQ24)(?:\\_|\w)*\w(?!\.h)")
FILE = re.compile(r"(?:iqfoc/)?\b([a-z0-9]+(?:\\_[a-z0-9]+)*\.h)\b")


class Item:
    """A declaration: kind, name, the C text of its head, the comment's lines, and rows (name, type or value, words) of its parts."""

    def __init__(self, kind, name, line, head, comment, rows=()):
        self.kind, self.name, self.line, self.head, self.comment, self.rows = kind, name, line, head, comment, rows


def comment_above(lines, line):
    """The lines of the comment that ends just above this line (counted from 1), without its marks."""
    last = line - 2
    if last < 0 or not lines[last].rstrip().endswith("*/"):
        return []
    first = last
    while "/*" not in lines[first]:
        first -= 1
    if not lines[first].lstrip().startswith("/*"):
        return []  # It is behind a declaration, and that declaration's.
    text = lines[first:last + 1]
    text[-1] = re.sub(r"\s*\*/\s*$", "", text[-1])
    text[0] = re.sub(r"^\s*/\* ?", "", text[0])
    text = text[:1] + [re.sub(r"^ ?\* ?", "", line) for line in text[1:]]
    while text and not text[0].strip():
        text.pop(0)
    while text and not text[-1].strip():
        text.pop()
    return text


def comment_behind(lines, line):
    """The text of the comment behind the one-line definition at this line (counted from 1), as a list of one line or none."""
    begin = re.search(r"\S\s*/\*(.*)$", lines[line - 1])
    if not begin or lines[line - 1].endswith("\\"):
        return []
    text, last = begin[1], line
    while "*/" not in text:
        text += " " + lines[last].strip().lstrip("* ")
        last += 1
    text = text[:text.index("*/")].strip()
    return [text[:1].upper() + text[1:]] if text else []


def words(element):
    return " ".join("".join(element.itertext()).split()) if element is not None else ""


def head_of_function(lines, line):
    """The declaration as the header has it, from this line to its body or semicolon."""
    text = []
    for part in lines[line - 1:]:
        if part.startswith("{"):
            break
        text.append(part.rstrip())
        if part.rstrip().endswith(";"):
            break
    return "\n".join(text)


def head_of_macro(lines, line, member):
    """The definition where it is one line, else its name and parameters."""
    if not lines[line - 1].endswith("\\"):
        return re.sub(r"\s*/\*.*$", "", re.sub(r"  +", " ", lines[line - 1]))
    parameters = [p.findtext("defname") for p in member.findall("param")]
    return f"#define {member.findtext('name')}" + (f"({', '.join(p for p in parameters if p)})" if any(parameters) else "")


class Header:
    """A header: its path, opening comment, and items in the order of the file."""

    def __init__(self, path, include, xml_folder):
        self.path = path
        self.name = path.relative_to(include / "iqfoc").as_posix()
        self.lines = path.read_text(encoding="utf-8").split("\n")
        self.opening = comment_above(self.lines, next(n for n, text in enumerate(self.lines, 1) if text.startswith("#ifndef")))
        self.items = []
        by_location = {}
        for file in sorted(xml_folder.glob("*.xml")):
            root = xml.etree.ElementTree.parse(file).getroot()
            for compound in root.findall("compounddef"):
                by_location.setdefault(compound.find("location").get("file") if compound.find("location") is not None else "", []).append(
                    compound)
        for compound in by_location.get(path.relative_to(include.parent).as_posix(), []):
            if compound.get("kind") in ("struct", "union"):
                self.add_struct(compound)
            elif compound.get("kind") == "file":
                for member in compound.iter("memberdef"):
                    self.add_member(member)
        self.items.sort(key=lambda item: item.line)

    def add_struct(self, compound):
        line = int(compound.find("location").get("line"))
        rows = []
        for field in compound.iter("memberdef"):
            kind = words(field.find("type"))
            rows.append((field.findtext("name") + (field.findtext("argsstring") or ""), kind, words(field.find("detaileddescription"))))
        name = compound.findtext("compoundname").split("::")[-1]
        self.items.append(Item("struct", name + "_t", line, None, comment_above(self.lines, line), rows))

    def add_member(self, member):
        kind, name, line = member.get("kind"), member.findtext("name"), int(member.find("location").get("line"))
        comment = comment_above(self.lines, line)
        if kind == "function":
            # The head may begin a line above the name.
            if comment == [] and not self.lines[line - 2].strip().endswith((";", "}", "*/", "")):
                comment = comment_above(self.lines, line - 1)
            self.items.append(Item(kind, name, line, head_of_function(self.lines, line), comment))
        elif kind == "enum":
            rows = []
            for value in member.findall("enumvalue"):
                given = (value.findtext("initializer") or "").lstrip("= ")
                if not given:
                    given = str(int(rows[-1][1], 0) + 1) if rows else "0"
                rows.append((value.findtext("name"), given, words(value.find("detaileddescription"))))
            self.items.append(Item(kind, (name or "") + "_t", line, None, comment, rows))
        elif kind == "define" and not name.endswith(("_H", "_")):
            behind = comment_behind(self.lines, line)
            self.items.append(Item(kind, name, line, head_of_macro(self.lines, line, member),
                                   [*comment, "", *behind] if comment and behind else comment or behind))
        elif kind == "typedef" and not re.search(r"\b(struct|enum|union)\b", member.findtext("definition")):
            self.items.append(Item(kind, name, line, member.findtext("definition") + (member.findtext("argsstring") or "") + ";", comment))


def read_headers(include, out):
    """All headers, from doxygen's XML, which goes into the folder `out`."""
    out.mkdir(parents=True, exist_ok=True)
    subprocess.run(["doxygen", "-"], input=DOXYFILE.format(include=include / "iqfoc", out=out), text=True, check=True,
                   stdout=subprocess.DEVNULL, cwd=include.parent)
    return [Header(path, include, out / "xml") for path in sorted((include / "iqfoc").rglob("*.h"))]


def anchor(name):
    return name.lower()


class Pages:
    """Markdown of the headers, with each of the library's names led to where it is declared."""

    def __init__(self, headers):
        self.headers = headers
        self.files = {header.name: header for header in headers}
        self.where = {}
        for header in headers:
            for item in header.items:
                self.where.setdefault(item.name, f"{header.name[:-2]}.md#{anchor(item.name)}")
                if item.kind == "enum":
                    for value, _, _ in item.rows:
                        self.where.setdefault(value, f"{header.name[:-2]}.md#{anchor(item.name)}")

    def linked(self, text, header, own=None, up=None):
        """Words of a comment as Markdown: nothing in them is markup, and a known name is a link, from the header's page or `up`."""
        up = "../" * header.name.count("/") if up is None else up
        text = re.sub(r"([\\`*_{}\[\]#])", r"\\\1", text.strip("- ") if text.startswith("----") else text)
        text = re.sub(r"[&<>|]", lambda match: f"&#{ord(match[0])};", text)

        def link(match):
            name = match[0].replace("\\", "")
            place = self.where.get(name) or self.where.get(name + "_t")
            return f"[`{name}`]({up}{place})" if place and name != own else f"`{name}`"

        def file(match):
            name = match[1].replace("\\", "")
            known = name in self.files and name != header.name
            return f"[{match[0]}]({up}{name[:-2]}.md)" if known else match[0]

        text = FILE.sub(file, KNOWN.sub(link, text))
        return LABEL.sub(r"**\1**", text)

    def comment(self, lines, header, own=None):
        """Paragraphs and, where lines are indented by four, blocks of code."""
        out, paragraph, code = [], [], []

        def end(kind):
            if kind == "text" and paragraph:
                out.append(self.linked(" ".join(paragraph), header, own))
                paragraph.clear()
            if kind == "code" and code:
                while not code[-1].strip():
                    code.pop()
                out.append("```text\n" + "\n".join(line[4:] for line in code) + "\n```")
                code.clear()

        for line in lines:
            if line.startswith("    "):
                end("text")
                code.append(line)
            elif not line.strip():
                end("text")
                if code:
                    code.append(line)
            else:
                end("code")
                if re.match(r"- ", line):
                    end("text")
                paragraph.append(line.strip())
        end("text")
        end("code")
        return "\n\n".join(out)

    def rows(self, item, header):
        heads = ("field", "type", "meaning, unit, range") if item.kind == "struct" else ("name", "value", "meaning")
        lines = ["| " + " | ".join(heads) + " |", "| --- | --- | --- |"]
        for name, kind, text in item.rows:
            lines.append(f"| `{name}` | {f'`{kind}`' if kind else ''} | {self.linked(text, header)} |")
        return "\n".join(lines)

    def page(self, header):
        parts = [f"# {header.name}", self.comment(header.opening, header), f'```c\n#include "iqfoc/{header.name}"\n```']
        before = None
        for item in header.items:
            parts.append(f"## {item.name} {{ #{anchor(item.name)} }}")
            if item.head:
                parts.append(f"```c\n{item.head}\n```")
            if item.comment:
                parts.append(self.comment(item.comment, header, item.name))
            elif before is not None and header.lines[item.line - 2].strip():
                parts.append(f"With [`{before.name}`](#{anchor(before.name)}), above.")
            if item.rows:
                parts.append(self.rows(item, header))
            before = item
        return "\n\n".join(part for part in parts if part) + "\n"

    def index(self):
        """The table of all headers, by the first sentence of each."""
        lines = ["# The library's functions", "One header a concept; `iqfoc/iqfoc.h` includes all. Each function says what it computes, its "
                 "units and formats, the range it takes and gives, its overflow behaviour, and its largest error in LSB.",
                 "| header | for | functions |\n| --- | --- | ---: |"]
        for header in self.headers:
            first = re.split(r"(?<=[.:])(?: |$)", " ".join(text for text in header.opening if text.strip()))[0].rstrip(":")
            count = sum(item.kind == "function" for item in header.items)
            lines[-1] += f"\n| [{header.name}]({header.name[:-2]}.md) | {self.linked(first, header, up='')} | {count or ''} |"
        return "\n\n".join(lines) + "\n"


def write_pages(include, pages_folder, work):
    """Writes pages_folder/index.md and a page a header; returns the headers."""
    headers = read_headers(include, pathlib.Path(work))
    pages = Pages(headers)
    for header in headers:
        page = pages_folder / f"{header.name[:-2]}.md"
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(BEHIND_DOCUMENTS + pages.page(header), encoding="utf-8")
    (pages_folder / "index.md").write_text(pages.index(), encoding="utf-8")
    return headers
