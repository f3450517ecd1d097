#!/usr/bin/env python3
"""Packs statically linked programs with the texts of all licences and the object that links with another C library (docs/licences.md).

    pack_static.py [-o DIR] build/static-x86-64 ...     writes DIR/iqfoc-VERSION-linux-x86-64.tar.gz ...; DIR is build/static by default

The same build gives the same bytes. `./dev static` builds, then calls this.
"""

import argparse
import gzip
import io
import pathlib
import re
import subprocess
import sys
import tarfile

import licences
from package import version

ROOT = pathlib.Path(__file__).resolve().parent.parent
RELINK = """iqfoc is linked statically with the GNU C Library, {library}, which is under the GNU Lesser General Public
License 2.1 or later; licences.md lists what else is in it. iqfoc.o is all of the program but that library and GCC's own. This command links the program
with your changed C library, whose libc.a is in FOLDER:

    {compiler} -static -L FOLDER iqfoc.o -o iqfoc

The sources of the library are those of Debian's source package glibc of that version: apt-get source glibc, or
https://snapshot.debian.org/package/glibc/. Whoever passes the program on passes on this object too, and those sources or an offer of them,
as section 6 of that licence says.
"""


def compiler_of(folder):
    """The build's own, by which the program is linked, where CMake notes it whoever named it."""
    for notes in folder.glob("CMakeFiles/*/CMakeCXXCompiler.cmake"):
        found = re.search(r'^set\(CMAKE_CXX_COMPILER "(.+)"\)$', notes.read_text(encoding="utf-8"), re.MULTILINE)
        if found:
            return pathlib.Path(found[1]).name
    return sys.exit(f"{folder}: no compiler is noted there; build it by a preset static-*")


def c_library(compiler):
    """Where its libc.a is, and which version that says it is."""
    place = pathlib.Path(subprocess.run([compiler, "-print-file-name=libc.a"], check=True, capture_output=True, text=True).stdout.strip())
    banner = re.search(rb"GNU C Library \(([^)]*)\)", place.read_bytes())
    return place, banner[1].decode() if banner else sys.exit(f"{place} is no GNU C Library")


def packed(folder):
    """The archive's bytes."""
    compiler = compiler_of(folder)
    relink = RELINK.format(library=c_library(compiler)[1], compiler=compiler).encode()
    texts = licences.whole_page({variable: licences.place_of(folder, variable) for _, variable, *_ in licences.UNPACKED})
    members = {"iqfoc": (folder / "iqfoc").read_bytes(), "iqfoc.o": (folder / "iqfoc.o").read_bytes(),
               "LICENSE": (ROOT / "LICENSE").read_bytes(), "licences.md": texts.encode(), "RELINK.txt": relink}
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for name, data in members.items():
            member = tarfile.TarInfo(f"iqfoc-{version()}/{name}")
            member.size, member.mode = len(data), 0o755 if name == "iqfoc" else 0o644
            tar.addfile(member, io.BytesIO(data))
    return gzip.compress(stream.getvalue(), mtime=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, nargs="+", help="folder of a preset static-*")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "build/static")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    for folder in options.build:
        kind = folder.resolve().name.removeprefix("static-")
        path = options.output / f"iqfoc-{version()}-linux-{kind}.tar.gz"
        path.write_bytes(packed(folder.resolve()))
        print(path)


if __name__ == "__main__":
    main()
