#!/usr/bin/env python3
"""Compares the tree with docs/DESIGN.md: the table of folders, and the modules with their includes.

The folders are the table between <!-- folders --> and <!-- end -->. Each folder at the top of the tree has a row, and each path with a
slash at its end in that table exists. Each folder at the top begins with a README.md, or an index.md.

The modules are the block between <!-- modules --> and <!-- end -->: one line for each,

    module   path   <- modules that it includes

`lib:a,b*` means files of these names in include/iqfoc/ and src/. Any other path is a folder, or the files of that name. A module includes
only modules above it. Each include between modules is in the block, and each arrow of the block is an include. No files include one
another in a circle.

    tools/check_layout.py            compares; exit status 1 with a line for each difference
    tools/check_layout.py --print    prints the modules with their includes, for the block
"""

import fnmatch
import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGE = os.path.join("docs", "DESIGN.md")
SOURCES = (".c", ".h", ".cpp", ".def")
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
LINE = re.compile(r"^    (\S+)\s+(\S+)\s+<-(.*)$", re.MULTILINE)


def drawing(text):
    """[(module, path, modules it includes)] in the page's order."""
    block = re.search(r"<!-- modules -->(.*?)<!-- end -->", text, re.DOTALL)
    if block is None:
        sys.exit(f"{PAGE}: no block between <!-- modules --> and <!-- end -->")
    modules = [(name, path.rstrip("/"), names.split()) for name, path, names in LINE.findall(block.group(1))]
    if not modules:
        sys.exit(f"{PAGE}: the block has no modules")
    return modules


def listed(root):
    done = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root, capture_output=True, text=True, check=True)
    return [f for f in done.stdout.split("\n") if f and os.path.exists(os.path.join(root, f))]


def tracked(root):
    return [f for f in listed(root) if f.endswith(SOURCES)]


def holds(where, path):
    """How closely a module's path fits a file; 0: not at all."""
    if where.startswith("lib:"):
        folder, name = os.path.split(path)
        stem = os.path.splitext(name)[0]
        named = any(fnmatch.fnmatchcase(stem, wanted) for wanted in where[4:].split(","))
        return len(path) if folder in ("include/iqfoc", "src") and named else 0
    return len(where) if path.startswith((where + "/", where + ".")) else 0


def module_of(path, modules):
    """The module whose path fits the file most closely, or None."""
    closest = max(modules, key=lambda module: holds(module[1], path))
    return closest[0] if holds(closest[1], path) else None


def wrong_folders(text, root, files):
    """A line for each difference between the table of folders and the tree."""
    block = re.search(r"<!-- folders -->(.*?)<!-- end -->", text, re.DOTALL)
    if block is None:
        sys.exit(f"{PAGE}: no block between <!-- folders --> and <!-- end -->")
    named = set(re.findall(r"`([^`\s]+/)`", block.group(1)))
    there = {f.split("/")[0] + "/" for f in files if "/" in f and not f.startswith(".")}
    opened = {f"{folder}/" for folder, name in (f.rsplit("/", 1) for f in files if "/" in f) if name in ("README.md", "index.md")}
    return [f"{folder} has no row in the table of folders" for folder in sorted(there - named)] + [
        f"{folder} has no README.md" for folder in sorted(there - opened)] + [
        f"{folder} is in the table of folders, but not in the tree" for folder in sorted(named) if not os.path.isdir(os.path.join(root, folder))]


def includes(root, files):
    """{file: [tracked files that it includes]}."""
    known = set(files)
    ends = {}
    for f in files:
        parts = f.split("/")
        for n in range(len(parts)):
            ends.setdefault("/".join(parts[n:]), []).append(f)
    graph = {}
    for f in files:
        with open(os.path.join(root, f), encoding="utf-8") as source:
            text = source.read()
        graph[f] = []
        for named in INCLUDE.findall(text):
            near = os.path.normpath(os.path.join(os.path.dirname(f), named))
            if near in known:
                graph[f].append(near)
            elif len(ends.get(named, [])) == 1:
                graph[f].append(ends[named][0])
            elif named in ends:
                # More than one header of the name: the one in the nearest folder.
                graph[f].append(max(ends[named], key=lambda g: len(os.path.commonprefix([f, g]))))
    return graph


def circle(graph):
    """A list of files that include one another in a circle, or None."""
    state = {}

    def visit(f, path):
        state[f] = "open"
        for g in graph[f]:
            if state.get(g) == "open":
                return path[path.index(g):] + [g] if g in path else [f, g]
            if g not in state:
                found = visit(g, path + [g])
                if found:
                    return found
        state[f] = "done"
        return None

    for f in graph:
        if f not in state:
            found = visit(f, [f])
            if found:
                return found
    return None


def arrows(graph, modules):
    """{(module, module): one include between them}."""
    found = {}
    for f, named in graph.items():
        here = module_of(f, modules)
        for g in named:
            there = module_of(g, modules)
            if here and there and here != there:
                found.setdefault((here, there), f"{f} includes {g}")
    return found


def compare(modules, graph):
    """A line for each difference."""
    order = {name: n for n, (name, _, _) in enumerate(modules)}
    drawn = {(name, other) for name, _, names in modules for other in names}
    seen = arrows(graph, modules)
    wrong = []
    for name, other in sorted(drawn):
        if other not in order:
            wrong.append(f"{name} <- {other}: there is no module {other}")
        elif (name, other) not in seen:
            wrong.append(f"{name} <- {other}: in the block, but no file includes it")
    for (name, other), why in sorted(seen.items()):
        if order[other] > order[name]:
            wrong.append(f"{name} <- {other}: includes a module below it: {why}")
        elif (name, other) not in drawn:
            wrong.append(f"{name} <- {other}: not in the block: {why}")
    ring = circle(graph)
    if ring:
        wrong.append("a circle: " + " -> ".join(ring))
    for name, where, _ in modules:
        if not any(module_of(f, modules) == name for f in graph):
            wrong.append(f"{name}: no file in {where}")
    return wrong


def main():
    with open(os.path.join(ROOT, PAGE), encoding="utf-8") as page:
        text = page.read()
    modules = drawing(text)
    graph = includes(ROOT, tracked(ROOT))
    if "--print" in sys.argv[1:]:
        seen = arrows(graph, modules)
        for name, where, _ in modules:
            print(f"    {name:<12} {where:<26} <- " + " ".join(other for other, _, _ in modules if (name, other) in seen))
        return 0
    wrong = compare(modules, graph) + wrong_folders(text, ROOT, listed(ROOT))
    for words in wrong:
        print(f"{PAGE}: {words}")
    print(f"layout: {len(modules)} modules, {len(arrows(graph, modules))} includes between them, {len(wrong)} differences")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
