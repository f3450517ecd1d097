#!/usr/bin/env python3
"""The parts of others in a statically linked `iqfoc`, their licences, and the texts of these licences.

The linker's map names the archives that objects were taken from; the compiler's dependency files name the headers that were read. Debian's
copyright files give holder and licence of each. A file that belongs to no known part is an error.

    tools/licences.py build/static-x86-64            fails if the table in docs/licences.md is not that of the program
    tools/licences.py build/static-x86-64 --write    writes that table
    tools/licences.py --texts FILE                   writes table and texts of all parts in docs/licences.md; --uplot DIR and --musl DIR
                                                     say where these are unpacked (default: the environment, then .cache)
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys

from marked import with_table

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/licences.md"

# Parts of others: a pattern of its files' paths, its name, the Debian package whose copyright file has the text, the SPDX expression,
# and the names of the texts in that file, or a file with the text.
PARTS = (
    (r"/eigen3/|(^|/)headers/Eigen/", "Eigen", "libeigen3-dev", "MPL-2.0 AND BSD-3-Clause", ["BSD-3-clause"]),
    (r"/kissfft/", "KissFFT", "libkissfft-dev", "BSD-3-Clause", ["BSD-3-clause"]),
    (r"/nlohmann/", "JSON for Modern C++", "nlohmann-json3-dev", "MIT", ["Expat"]),
    (r"/toml\+\+/", "toml++", "libtomlplusplus-dev", "MIT", ["Expat"]),
    (r"libzlib_of_sources\.a|/zlib\.h$|/zconf\.h$", "zlib", "zlib1g-dev", "Zlib", ["Zlib"]),
    (r"/libstdc\+\+\.a|/libgcc(_eh)?\.a|/crt(begin|end|fastmath)\w*\.o|/include/c\+\+/|/lib/gcc(-cross)?/[^/]+/\d+/include", "libstdc++ and libgcc",
     "gcc-12-base", "GPL-3.0-or-later WITH GCC-exception-3.1", []),
    (r"/lib(c|m|mvec|m-[\d.]+|pthread)\.a|/crt[1in]\.o|/usr/(aarch64-linux-gnu/)?include/", "GNU C Library", "libc6", "LGPL-2.1-or-later", ["/usr/share/common-licenses/LGPL-2.1"]),
)

# Parts that are unpacked from their sources: name, the CMake variable with the folder, the folder in .cache, the licence's file, SPDX.
UNPACKED = (
    ("uPlot", "UPLOT_DIR", "uplot", "LICENSE", "MIT"),
    ("musl's mathematics", "MUSL_SOURCE_DIR", "musl", "COPYRIGHT", "MIT"),
)


def used_archives(text):
    """The archives that the linker took an object of, by its map."""
    return set(re.findall(r"^(?:\s*\.\S+\s+0x[0-9a-f]+\s+0x[0-9a-f]+\s+)?(\S+?\.a)\(", text, re.MULTILINE))


def headers(folder):
    """The files that the compiler read, as ninja has kept them."""
    done = subprocess.run(["ninja", "-C", folder, "-t", "deps"], capture_output=True, text=True, check=True)
    return {str((folder / line.strip()).resolve()) if line.strip().startswith("..") else line.strip()
            for line in done.stdout.splitlines() if line.startswith("    ")}


def part_of(path):
    for part in PARTS:
        if re.search(part[0], path):
            return part
    return None


def stanza(package, name):
    """The text of a licence in a package's copyright file (Debian's format 1.0), or in the file of that name."""
    if name.startswith("/"):
        return pathlib.Path(name).read_text(encoding="utf-8").strip("\n")
    text = pathlib.Path(f"/usr/share/doc/{package}/copyright").read_text()
    for match in re.finditer(rf"^License:[ ]*{re.escape(name)}\n((?:[ \t].*\n?)+)", text, re.MULTILINE):
        lines = [re.sub(r"^ \.$", "", line)[1:] if line.strip() != "." else "" for line in match.group(1).splitlines()]
        return "\n".join(line.rstrip() for line in lines).strip("\n")
    sys.exit(f"{package}: no text of the licence {name}")


def holder(package):
    """Who has the copyright of all files that no line says otherwise of."""
    text = pathlib.Path(f"/usr/share/doc/{package}/copyright").read_text()
    match = re.search(r"^Files:[ ]*\*\nCopyright:[ ]*(.*)", text, re.MULTILINE)
    return match.group(1).strip() if match else "Free Software Foundation, Inc."


def place_of(folder, variable):
    """The folder in a variable of the build's CMake cache."""
    place = re.search(rf"^{variable}:PATH=(.+)$", (folder / "CMakeCache.txt").read_text(), re.MULTILINE)
    return pathlib.Path(place[1]) if place else sys.exit(f"{variable} is empty in {folder}: its library is not in this build")


def unpacked(places):
    """Name, SPDX expression and licence text of each unpacked part; `places` has the folder of each CMake variable, empty for a build without the part."""
    for name, variable, _, file, spdx in UNPACKED:
        if not str(places[variable]):
            continue
        text = pathlib.Path(places[variable]) / file
        if not text.exists():
            sys.exit(f"{text}: no such file; {variable} is the folder of {name}")
        yield name, spdx, text.read_text(encoding="utf-8").strip()


def table(used, others):
    """The table of docs/licences.md."""
    lines = ["| part | licence (SPDX) | copyright |", "| --- | --- | --- |"]
    lines += [f"| {name} | {spdx} | {holder(package)} |" for _, name, package, spdx, _ in PARTS if name in used]
    for name, spdx, text in others:
        lines.append(f"| {name} | {spdx} | " + re.search(r"Copyright (?:\(c\)|\u00a9) (.*)", text).group(1) + " |")
    return "\n".join(lines)


def listed():
    """The parts in the table of docs/licences.md."""
    return set(re.findall(r"^\| (.+?) \| .+? \| .+ \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))


def whole_page(places):
    """The table and the texts, as the program and the wheel carry them."""
    used, others = listed(), list(unpacked(places))
    lines = ["# Licences: the texts", "",
             "For anyone who passes on the program or the Python package: the parts of others that a statically linked `iqfoc` holds, and the",
             "texts of their licences. The project's own sources are under the MIT licence (the file LICENSE). The Python package holds all of",
             "these parts except the GNU C Library and GCC's own.", "", table(used, others), "",
             "Eigen's files are used unchanged. Their sources are Debian's package `libeigen3-dev`, and the text of the MPL 2.0 is at",
             "<https://mozilla.org/MPL/2.0/>. Debian's source package `gcc-12` holds the texts of the GPL 3 and of its exception.",
             ""]
    for _, name, package, _, texts in PARTS:
        for text in texts:
            if name in used:
                lines += [f"## {name}", "", f"Copyright {holder(package)}", "", "```text", stanza(package, text), "```", ""]
    for name, _, text in others:
        lines += [f"## {name}", "", "```text", text, "```", ""]
    return "\n".join(lines)


def default_places():
    """Where the parts that no package installs are unpacked."""
    return {variable: os.environ.get(variable) or ROOT / ".cache" / folder for _, variable, folder, _, _ in UNPACKED}


def parts_of(folder):
    """The names of the parts in the program that was built there."""
    files = used_archives((folder / "iqfoc.map").read_text()) | headers(folder)
    own = (str(ROOT), "sim_host/", "src/", "port/", "tests/", "generated/", "libmusl_math.a", "musl_names.h",
           str(place_of(folder, "MUSL_SOURCE_DIR")), str(place_of(folder, "ZLIB_SOURCE_DIR")))
    used, strange = set(), []
    for path in sorted(files):
        part = part_of(path)
        if part is not None:
            used.add(part[1])
        elif not path.startswith(own):
            strange.append(path)
    if strange:
        sys.exit("these files belong to no part in tools/licences.py: " + ", ".join(strange))
    print(f"{len(files)} files of {len(used)} parts")
    return used


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", type=pathlib.Path, nargs="?", help="folder of a static build, with the linker's iqfoc.map in it")
    parser.add_argument("--write", action="store_true", help="write the table of docs/licences.md")
    parser.add_argument("--texts", type=pathlib.Path, metavar="FILE", help="write the table with all texts to FILE")
    parser.add_argument("--uplot", metavar="DIR")
    parser.add_argument("--musl", metavar="DIR", help="empty: the build does without")
    options = parser.parse_args()
    if (options.build is None) == (options.texts is None):
        parser.error("give the folder of a build, or --texts FILE")

    if options.texts:
        places = default_places()
        places.update({name: place for name, place in (("UPLOT_DIR", options.uplot), ("MUSL_SOURCE_DIR", options.musl)) if place is not None})
        options.texts.write_text(whole_page(places), encoding="utf-8")
        return
    folder = options.build.resolve()
    places = {variable: place_of(folder, variable) for _, variable, _, _, _ in UNPACKED}
    page = PAGE.read_text(encoding="utf-8")
    made = with_table(page, "licences", table(parts_of(folder), list(unpacked(places))))
    if options.write:
        PAGE.write_text(made, encoding="utf-8")
    elif made != page:
        sys.exit("docs/licences.md has another table than the program; tools/licences.py --write writes it")


if __name__ == "__main__":
    main()
