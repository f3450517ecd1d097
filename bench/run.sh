#!/usr/bin/env bash
# Builds the benchmark images of both targets and runs them in QEMU. Arguments: bench/bench.py --help. IQFOC_BUILD is the folder for the
# builds (default build/).
set -euo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
BUILD=${IQFOC_BUILD:-$ROOT/build}
# --core: one core, with any flags, without a build folder. --peers: the same job in other libraries. --rtl: cycles on simulated cores.
for argument in "$@"; do
    [[ $argument != --core* ]] || exec python3 "$ROOT/bench/core.py" "$@"
    [[ $argument != --peers ]] || exec python3 "$ROOT/bench/peers.py" "$@"
    [[ $argument != --rtl ]] || exec python3 "$ROOT/bench/rtl.py" "$@"
done
TARGETS=(cortex-m4 rv32)
[[ " $* " != *" --quick "* ]] || TARGETS=(cortex-m4)
mkdir -p "$BUILD"
for target in "${TARGETS[@]}"; do
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
