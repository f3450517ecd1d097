#!/usr/bin/env python3
"""The documentation as a site that opens from disk, search included: build/site/index.html.

    build.py [-o DIR]

The pages are docs/, one for each header of the library (api.py), each file or folder that a document links to, and the lists that tools
write: MISRA, mutation testing, licences. A broken link or anchor, or a comment that api.py has read wrongly, is an error. Needs
doxygen, mkdocs in .cache/python/site, iframe-worker in .cache/iframe-worker, cppcheck, lizard in .cache/python/checks and the library in build/cortex-m4 (`./dev site` sets all up).
"""

import argparse
import html.parser
import os
import pathlib
import posixpath
import re
import shutil
import subprocess
import sys
import urllib.parse

import api

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Pages that a tool writes into build/: place in the site, the file, the command.
WRITTEN = (("misra-list.md", "build/misra.md", ("tools/misra.py", "page")),
           ("mutation-list.md", "build/mutation.md", ("tools/mutate.py", "--page")),
           ("licences-texts.md", "build/licences.md", ("tools/licences.py", "--texts", "build/licences.md")))
HERE = pathlib.Path(__file__).resolve().parent
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
LANGUAGES = {".c": "c", ".h": "c", ".cpp": "cpp", ".py": "python", ".sh": "bash", ".toml": "toml", ".json": "json", ".yml": "yaml"}
LONGEST_FILE = 200_000


def title(path):
    """A document's first heading."""
    return re.search(r"^# (.*)$", (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE)[1]


def golden_hash():
    """The number that the documents name after its macro, since it changes with each function that is added."""
    header = (ROOT / "tests/target/golden/golden_hash.h").read_text(encoding="utf-8")
    return re.search(r"#define GOLDEN_HASH UINT64_C\(0x([0-9a-f]+)\)", header)[1]


class Stage:
    """The folder that mkdocs reads: documents with their links led to pages of the site."""

    def __init__(self, folder):
        self.folder = folder
        self.sources = set()

    def place_of(self, path):
        """Where the site has a path of the tree, from the site's root."""
        if path in ("README.md", "docs"):
            return "index.md"
        if path.startswith("docs/"):
            return path[len("docs/"):]
        header = re.fullmatch(r"include/iqfoc/(.*)\.h", path)
        if header:
            return f"api/{header[1]}.md"
        if path == "include/iqfoc":
            return "api/index.md"
        self.sources.add(path)
        return self.place_of_source(path)

    @staticmethod
    def place_of_source(path):
        """mkdocs leaves out what begins with a dot."""
        return "source/" + path.replace("/.", "/").lstrip(".") + ".md"

    def document(self, text, path, place):
        """A document's text for the site: `path` in the tree becomes `place` in the site."""
        in_fence = False
        lines, prose = [], []

        def end_prose():
            # A link's words may go over a line's end.
            if prose:
                lines.append(LINK.sub(lambda match: self.link(match, path, place), "\n".join(prose)))
                prose.clear()

        for line in text.split("\n"):
            fence = line.startswith("```")
            if fence or in_fence or line.startswith("    "):
                end_prose()
                lines.append(line)
                in_fence ^= fence
            else:
                prose.append(line)
        end_prose()
        return "\n".join(lines)

    def link(self, match, path, place):
        words, target, fragment = match[1], match[2], match[3] or ""
        if ":" in target:
            return match[0]
        there = posixpath.normpath(posixpath.join(posixpath.dirname(path), target))
        if not (ROOT / there).exists():
            return match[0]  # mkdocs reports the place
        if words == posixpath.basename(there) and there.startswith("docs/"):
            words = title(there)
        return f"[{words}]({posixpath.relpath(self.place_of(there), posixpath.dirname(place) or '.')}{fragment})"

    def write(self, place, text):
        file = self.folder / place
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def write_source(self, path):
        """A page of a file or a folder. It is found by links alone, not by the search."""
        head = f"---\nsearch:\n  exclude: true\n---\n\n# {path}\n\n"
        place = self.place_of_source(path)
        whole = ROOT / path
        if whole.is_dir():
            listed = subprocess.run(["git", "ls-files", path], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\n")
            lines = [f"- [`{file}`]({posixpath.relpath(self.place_of(file), posixpath.dirname(place))})"
                     for file in listed if file and self.can_be_shown(ROOT / file)]
            self.write(place, head + "\n".join(lines) + "\n")
        elif path.endswith(".md"):
            self.write(place, self.document(whole.read_text(encoding="utf-8"), path, place))
        else:
            language = LANGUAGES.get(whole.suffix, "text")
            text = whole.read_text(encoding="utf-8")
            self.write(place, f"{head}````{language}\n{text.rstrip()}\n````\n")

    @staticmethod
    def can_be_shown(file):
        return file.suffix not in (".gz", ".svg", ".png") and file.stat().st_size < LONGEST_FILE


def write_lists(site):
    """The pages that tools write."""
    for place, file, command in WRITTEN:
        done = subprocess.run([sys.executable, "-B", *command], cwd=ROOT, check=False, stdout=subprocess.DEVNULL)
        if done.returncode:
            sys.exit(f"{' '.join(command)}: exit status {done.returncode}; ./dev site sets up all that it needs")
        site.write(place, site.document((ROOT / file).read_text(encoding="utf-8"), f"docs/{place}", place))


def stage(folder, work):
    site = Stage(folder)
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT / "docs/figures", folder / "figures")
    for file in sorted((ROOT / "docs").glob("*.md")):
        text = file.read_text(encoding="utf-8")
        if file.name == "golden.md":
            text = text.replace("`GOLDEN_HASH`", f"`{golden_hash()}`")
        site.write(file.name, site.document(text, f"docs/{file.name}", file.name))
    write_lists(site)
    shutil.copy(HERE / "style.css", folder)
    api.write_pages(ROOT / "include", folder / "api", work)
    done = set()
    while site.sources - done:
        for path in sorted(site.sources - done):
            site.write_source(path)
            done.add(path)


class Links(html.parser.HTMLParser):
    """The anchors of a page, and what it refers to."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.targets = set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (name == "name" and tag == "a"):
                self.anchors.add(value)
            if value and ((name == "href" and tag in ("a", "link")) or name == "src"):
                self.targets.append((tag, value))


def broken_links(site):
    """A sentence for each reference of the built pages that leads nowhere, or that a reader without a network would miss."""
    pages = {page: Links(page.read_text(encoding="utf-8")) for page in site.rglob("*.html")}
    for page, links in sorted(pages.items()):
        for tag, target in links.targets:
            place, _, fragment = target.partition("#")
            if re.match(r"[a-z]+:", target):
                if tag != "a":
                    yield f"{page.relative_to(site)}: {target} is fetched from a network"
                continue
            there = page if not place else pathlib.Path(os.path.normpath(page.parent / urllib.parse.unquote(place)))
            if page.name == "404.html" and place.startswith("/"):
                continue
            if not there.is_file():
                yield f"{page.relative_to(site)}: {target} leads nowhere"
            elif fragment and there in pages and urllib.parse.unquote(fragment) not in pages[there].anchors:
                yield f"{page.relative_to(site)}: {target} has no such anchor"


def marks_of_comments(site):
    """A sentence for each page of a header whose words hold a mark of a C comment: there a comment was not read as its author set it."""
    for page in sorted((site / "api").rglob("*.html")):
        text = re.sub(r"<(code|pre|script)\b.*?</\1>", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        for line in re.sub(r"<[^>]*>", "", text).split("\n"):
            if "*/" in line or "/*" in line:
                yield f"{page.relative_to(site)}: a comment's mark in: {line.strip()[:120]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "build/site")
    output = parser.parse_args().output.absolute()
    mkdocs = ROOT / ".cache/python/site/bin/mkdocs"
    if not mkdocs.exists():
        sys.exit("no mkdocs in .cache/python/site; ./dev tools site installs it")
    worker = ROOT / ".cache/iframe-worker"
    if not worker.exists():
        sys.exit("no .cache/iframe-worker; ./dev site fetches it")
    work = output.with_name(output.name + ".work")
    shutil.rmtree(work, ignore_errors=True)
    stage(work / "pages", work / "doxygen")
    (work / "pages/iframe-worker").mkdir()
    shutil.copy(worker / "shim/index.js", work / "pages/iframe-worker/shim.js")
    shutil.copy(worker / "LICENSE", work / "pages/iframe-worker")
    shutil.copy(HERE / "mkdocs.yml", work)
    # The theme's makers print an advertisement where this is not set.
    done = subprocess.run([mkdocs, "build", "--strict", "--quiet", "-f", work / "mkdocs.yml", "-d", output], check=False,
                          env={**os.environ, "NO_MKDOCS_2_WARNING": "1"})
    if done.returncode:
        return 1
    broken = [*broken_links(output), *marks_of_comments(output)]
    print("\n".join(broken) or f"{len(list(output.rglob('*.html')))} pages: {output}/index.html")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
