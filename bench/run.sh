#!/usr/bin/env bash
# Builds the benchmark images of both targets, runs them in QEMU and evaluates them. Arguments: bench/bench.py --help.
# IQFOC_BUILD names another folder for the builds than build/.
set -euo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
BUILD=${IQFOC_BUILD:-$ROOT/build}
# One core, with any flags: no build folder.
for argument in "$@"; do
    [[ $argument != --core* ]] || exec python3 "$ROOT/bench/core.py" "$@"
done
mkdir -p "$BUILD"
for target in cortex-m4 rv32; do
    {
        cmake -G Ninja -S "$ROOT" -B "$BUILD/$target" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DBUILD_TESTING=OFF \
            -DCMAKE_TOOLCHAIN_FILE="$ROOT/cmake/toolchain-$target.cmake" &&
            cmake --build "$BUILD/$target" --target bench bench_trace -j "${IQFOC_JOBS:-$(nproc)}"
    } >"$BUILD/$target.bench.log" 2>&1 || {
        cat "$BUILD/$target.bench.log" >&2
        exit 1
    }
done
exec python3 "$ROOT/bench/bench.py" --build "$BUILD" "$@"
