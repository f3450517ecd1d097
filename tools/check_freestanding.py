#!/usr/bin/env python3
"""Checks that a static library needs only memcpy and memset of a C library, and no floating point.

    check_freestanding.py NM LIBRARY.a

What a compiler may call by itself for 64-bit integers (its own runtime, libgcc) is allowed, by name. The helpers for
floating point are of that runtime too, and are not allowed: this finds a `double` that slipped into fixed-point code.
"""

import subprocess
import sys

ALLOWED = {"memcpy", "memset"}
INTEGER_RUNTIME = {
    "__aeabi_ldivmod", "__aeabi_uldivmod", "__aeabi_lmul", "__aeabi_llsl", "__aeabi_llsr", "__aeabi_lasr",
    "__divdi3", "__udivdi3", "__moddi3", "__umoddi3", "__muldi3", "__ashldi3", "__ashrdi3", "__lshrdi3",
    "__clzsi2", "__clzdi2", "__ctzsi2", "__ctzdi2", "__popcountsi2", "__popcountdi2",
}


def symbols(nm, library, option):
    """The names that nm lists for the library's members with the given selection."""
    listing = subprocess.run([nm, option, "--format=posix", library], check=True, capture_output=True, text=True)
    lines = (line.split() for line in listing.stdout.splitlines())
    return {line[0] for line in lines if len(line) >= 2 and not line[0].endswith(":")}


def main(nm, library):
    defined = symbols(nm, library, "--defined-only")
    needed = symbols(nm, library, "--undefined-only") - defined
    if not defined:
        print(f"{library}: no symbols in it")
        return 1
    print(f"{library}: {len(defined)} symbols; needs from outside: {' '.join(sorted(needed)) or 'nothing'}")
    foreign = needed - ALLOWED - INTEGER_RUNTIME
    for name in sorted(foreign):
        print(f"{library}: must not need '{name}'")
    return 1 if foreign else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
