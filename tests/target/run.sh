#!/usr/bin/env bash
# Builds the test images of all emulated targets and the same program with the host's compilers, runs all of them and
# compares: tests/target/run.py. Needs UNITY_DIR (./dev test sets it). IQFOC_BUILD names another folder than build/.
# --quick: Cortex-M4 and gcc alone, without the tests of the program with the images.
set -euo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
BUILD=${IQFOC_BUILD:-$ROOT/build}
JOBS=${IQFOC_JOBS:-$(nproc)}
: "${UNITY_DIR:?the folder of unity.c; ./dev test finds it}"
cd "$ROOT"
TARGETS=(cortex-m4 cortex-m0plus rv32)
QUICK=
if [[ ${1:-} == --quick ]]; then
    TARGETS=(cortex-m4)
    QUICK=1
fi
mkdir -p "$BUILD/same_bits"

for target in "${TARGETS[@]}"; do
    {
        cmake -G Ninja -S . -B "$BUILD/$target" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DUNITY_DIR="$UNITY_DIR" \
            -DCMAKE_TOOLCHAIN_FILE="$ROOT/cmake/toolchain-$target.cmake" &&
            cmake --build "$BUILD/$target" -j "$JOBS"
    } >"$BUILD/$target.images.log" 2>&1 || {
        cat "$BUILD/$target.images.log" >&2
        exit 1
    }
done

# Language and warnings as in cmake/; what differs on purpose is compiler and optimisation.
FLAGS=(-std=c11 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wstrict-prototypes -Werror -Iinclude -Iport/emulated -Itests/target/golden)
SOURCES=(tests/target/{same_bits,closed_loop}.c tests/target/golden/*.c port/emulated/{hal_emulated,small_drive,small_drive_sample}.c src/*.c)
gcc -O2 "${FLAGS[@]}" "${SOURCES[@]}" -o "$BUILD/same_bits/gcc-O2"
[[ -z $QUICK ]] || exec python3 tests/target/run.py --build "$BUILD" --jobs "$JOBS" --quick
clang -O0 "${FLAGS[@]}" "${SOURCES[@]}" -o "$BUILD/same_bits/clang-O0"
clang -O3 "${FLAGS[@]}" "${SOURCES[@]}" -o "$BUILD/same_bits/clang-O3"

# The program, for processor in the loop.
{
    cmake -G Ninja -S . -B "$BUILD/host" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DUNITY_DIR="$UNITY_DIR" &&
        cmake --build "$BUILD/host" --target iqfoc_cli -j "$JOBS"
} >"$BUILD/host.program.log" 2>&1 || {
    cat "$BUILD/host.program.log" >&2
    exit 1
}

exec python3 tests/target/run.py --build "$BUILD" --jobs "$JOBS" "$@"
