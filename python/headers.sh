#!/usr/bin/env bash
# Ahead of cibuildwheel: puts what a manylinux image does not have into .cache, which goes into the image with the tree. The libraries
# of headers come from this Debian machine, musl's sources and uPlot from `./dev build`.
#     python/headers.sh && cibuildwheel --platform linux --archs x86_64,aarch64 python
set -euo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
place=$ROOT/.cache/headers/include
rm -rf "$place"
mkdir -p "$place"
for folder in eigen3/Eigen kissfft nlohmann toml++; do
    cp -rL "/usr/include/$folder" "$place/${folder##*/}"
done
for folder in musl uplot; do
    [[ -d $ROOT/.cache/$folder ]] || {
        echo "$ROOT/.cache/$folder is missing; run ./dev build first" >&2
        exit 1
    }
done
