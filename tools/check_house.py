#!/usr/bin/env python3
"""Holds the include graph to the house that docs/DESIGN.md draws.

The drawing is the block between <!-- house --> and <!-- end -->: one line a room,

    room   path   <- rooms that it includes

where `lib:a,b*` stands for include/iqfoc/ and src/ with these names, and anything else for a folder, or for the files of that name.

A room may include only rooms that stand above it, so that no arrow points up and there is no circle. Each include must be
drawn, and each arrow drawn must be there. Within the rooms no files may include one another in a circle.

    tools/check_house.py            compares; exit status 1 with a line for each difference
    tools/check_house.py --print    prints the arrows as they are, for the drawing
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
    """[(room, path, rooms it includes)] in the page's order."""
    block = re.search(r"<!-- house -->(.*?)<!-- end -->", text, re.DOTALL)
    if block is None:
        sys.exit(f"{PAGE}: no block between <!-- house --> and <!-- end -->")
    rooms = [(name, path.rstrip("/"), names.split()) for name, path, names in LINE.findall(block.group(1))]
    if not rooms:
        sys.exit(f"{PAGE}: the house has no rooms")
    return rooms


def tracked(root):
    done = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root, capture_output=True, text=True, check=True)
    return [f for f in done.stdout.split("\n") if f.endswith(SOURCES) and os.path.exists(os.path.join(root, f))]


def holds(where, path):
    """How closely a room's path fits a file; 0: not at all."""
    if where.startswith("lib:"):
        folder, name = os.path.split(path)
        stem = os.path.splitext(name)[0]
        named = any(fnmatch.fnmatchcase(stem, wanted) for wanted in where[4:].split(","))
        return len(path) if folder in ("include/iqfoc", "src") and named else 0
    return len(where) if path.startswith((where + "/", where + ".")) else 0


def room_of(path, rooms):
    """The room whose path fits the file most closely, or None."""
    closest = max(rooms, key=lambda room: holds(room[1], path))
    return closest[0] if holds(closest[1], path) else None


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
            beside = os.path.normpath(os.path.join(os.path.dirname(f), named))
            if beside in known:
                graph[f].append(beside)
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


def arrows(graph, rooms):
    """{(room, room): one include that makes the arrow}."""
    found = {}
    for f, named in graph.items():
        here = room_of(f, rooms)
        for g in named:
            there = room_of(g, rooms)
            if here and there and here != there:
                found.setdefault((here, there), f"{f} includes {g}")
    return found


def compare(rooms, graph):
    """A sentence for each difference."""
    order = {name: n for n, (name, _, _) in enumerate(rooms)}
    drawn = {(name, other) for name, _, names in rooms for other in names}
    seen = arrows(graph, rooms)
    wrong = []
    for name, other in sorted(drawn):
        if other not in order:
            wrong.append(f"{name} <- {other}: there is no room {other}")
        elif (name, other) not in seen:
            wrong.append(f"{name} <- {other}: drawn, but nothing includes it")
    for (name, other), why in sorted(seen.items()):
        if order[other] > order[name]:
            wrong.append(f"{name} <- {other}: an arrow up: {why}")
        elif (name, other) not in drawn:
            wrong.append(f"{name} <- {other}: not drawn: {why}")
    ring = circle(graph)
    if ring:
        wrong.append("a circle: " + " -> ".join(ring))
    for name, where, _ in rooms:
        if not any(room_of(f, rooms) == name for f in graph):
            wrong.append(f"{name}: no file in {where}")
    return wrong


def main():
    with open(os.path.join(ROOT, PAGE), encoding="utf-8") as page:
        rooms = drawing(page.read())
    graph = includes(ROOT, tracked(ROOT))
    if "--print" in sys.argv[1:]:
        seen = arrows(graph, rooms)
        for name, where, _ in rooms:
            print(f"    {name:<12} {where:<26} <- " + " ".join(other for other, _, _ in rooms if (name, other) in seen))
        return 0
    wrong = compare(rooms, graph)
    for words in wrong:
        print(f"{PAGE}: {words}")
    print(f"the house: {len(rooms)} rooms, {len(arrows(graph, rooms))} arrows, {len(wrong)} differences")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
