#!/usr/bin/env python3
"""Writes docs/licences.md: what a statically linked `iqfoc` holds of others, under which licences, and their texts.

What is in it is asked of the linker, by the archives that it took objects from, and of the compiler, by the headers that the
sources include; whose they are, and their licences, of Debian's packages. A file of no package that is known here fails.

    tools/licences.py build/static-x86-64            compares with docs/licences.md
    tools/licences.py build/static-x86-64 --write    writes it
"""

import argparse
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/licences.md"

# What a file belongs to: a pattern of its path, a name for people, the Debian package whose copyright file has the text,
# the SPDX expression, and the names of the texts in that file.
PARTS = (
    (r"/eigen3/|(^|/)headers/Eigen/", "Eigen", "libeigen3-dev", "MPL-2.0 AND BSD-3-Clause", ["BSD-3-clause"]),
    (r"/kissfft/", "KissFFT", "libkissfft-dev", "BSD-3-Clause", ["BSD-3-clause"]),
    (r"/nlohmann/", "JSON for Modern C++", "nlohmann-json3-dev", "MIT", ["Expat"]),
    (r"/toml\+\+/", "toml++", "libtomlplusplus-dev", "MIT", ["Expat"]),
    (r"libzlib_of_sources\.a|/zlib\.h$|/zconf\.h$", "zlib", "zlib1g-dev", "Zlib", ["Zlib"]),
    (r"/libstdc\+\+\.a|/libgcc(_eh)?\.a|/crt(begin|end|fastmath)\w*\.o|/include/c\+\+/|/lib/gcc(-cross)?/[^/]+/\d+/include", "libstdc++ and libgcc",
     "gcc-12-base", "GPL-3.0-or-later WITH GCC-exception-3.1", []),
    (r"/lib(c|m|mvec|m-[\d.]+|pthread)\.a|/crt[1in]\.o|/usr/(aarch64-linux-gnu/)?include/", "GNU C Library", "libc6", "LGPL-2.1-or-later", []),
)

# What is not installed by a package but unpacked from its sources: its name, where CMake was told it is, the licence's file there.
UNPACKED = (
    ("uPlot", "UPLOT_DIR", "LICENSE", "MIT"),
    ("musl's mathematics", "MUSL_SOURCE_DIR", "COPYRIGHT", "MIT"),
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
    """The text of a licence in a package's copyright file (Debian's format 1.0)."""
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
    """The folder that CMake was told."""
    place = re.search(rf"^{variable}:PATH=(.+)$", (folder / "CMakeCache.txt").read_text(), re.MULTILINE)
    return pathlib.Path(place[1]) if place else sys.exit(f"{variable} is empty in {folder}: its library is not in this build")


def unpacked(folder):
    """Of what the build takes from unpacked sources: name, SPDX expression, and the text of the licence that lies with them."""
    for name, variable, file, spdx in UNPACKED:
        yield name, spdx, (place_of(folder, variable) / file).read_text(encoding="utf-8").strip()


def page(used, others):
    lines = ["# Licences", "",
             "What a statically linked `iqfoc` holds: this project's own sources under the MIT licence ([LICENSE](../LICENSE)), and of others",
             "what the table lists, as the compiler and the linker say. The file is written by `tools/licences.py` and held to the program that",
             "`./dev test` builds.", "",
             "| part | licence (SPDX) | copyright |", "| --- | --- | --- |"]
    for _, name, package, spdx, _ in PARTS:
        if name in used:
            lines.append(f"| {name} | {spdx} | {holder(package)} |")
    for name, spdx, text in others:
        lines.append(f"| {name} | {spdx} | " + re.search(r"Copyright (?:\(c\)|\u00a9) (.*)", text).group(1) + " |")
    lines += ["", "The exception of GCC's libraries lets what they are linked into have any licence. The GNU C Library is the one part under a",
              "licence that asks for more: who passes a static program on also passes on, or offers, what it takes to link it with a changed C library,",
              "and that library's sources. `./dev static` packs the program with both said and done: `iqfoc.o` in the archive is all of the program but",
              "the C library and GCC's own, `RELINK.txt` has the line that links it and the version whose sources Debian has. `./dev test` makes the",
              "program so with a C library that was changed, for both processors. The program that is not static holds neither: it uses the machine's",
              "own. Eigen's files are used as they are: their sources are Debian's package `libeigen3-dev`, and the text of their licence is at\n<https://mozilla.org/MPL/2.0/>.", ""]
    for _, name, package, _, texts in PARTS:
        for text in texts:
            if name in used:
                lines += [f"## {name}", "", f"Copyright {holder(package)}", "", "```text", stanza(package, text), "```", ""]
    for name, _, text in others:
        lines += [f"## {name}", "", "```text", text, "```", ""]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", type=pathlib.Path, help="folder of the build, with the linker's iqfoc.map in it")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()

    folder = options.build.resolve()
    files = used_archives((folder / "iqfoc.map").read_text()) | headers(folder)
    own = (str(ROOT), "sim_host/", "src/", "port/", "tests/", "generated/", "libmusl_math.a", "musl_names.h",
           str(place_of(folder, "MUSL_SOURCE_DIR")), str(place_of(folder, "ZLIB_SOURCE_DIR")))
    used = set()
    strange = []
    for path in sorted(files):
        part = part_of(path)
        if part is not None:
            used.add(part[1])
        elif not path.startswith(own):
            strange.append(path)
    if strange:
        sys.exit("whose are these, and under which licence? " + ", ".join(strange))
    text = page(used, list(unpacked(folder)))
    if options.write:
        PAGE.write_text(text)
    elif not PAGE.exists() or PAGE.read_text() != text:
        sys.exit("docs/licences.md is not what the program holds: run tools/licences.py with --write")
    print(f"{len(files)} files of {len(used)} parts")


if __name__ == "__main__":
    main()
