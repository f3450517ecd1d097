#!/usr/bin/env bash
# Tests of ./dev's set-up on machines that it cannot set up: one line says what to install, and nothing hangs or is installed.
# A folder of substitutes as the only PATH simulates the machine.
set -uo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
WORK=$(mktemp -d)
trap 'rm -rf "$WORK"' EXIT
failures=0

# A machine: a PATH with the plain tools, plus the stand-ins that are given as name=script.
machine() {
    rm -rf "${WORK:?}/bin"
    mkdir "$WORK/bin"
    local tool stand_in
    for tool in bash env dirname nproc head mkdir grep tail id cat true wc sleep touch; do
        ln -s "$(type -P "$tool")" "$WORK/bin/$tool"
    done
    for stand_in in "$@"; do
        printf '#!/bin/sh\n%s\n' "${stand_in#*=}" >"$WORK/bin/${stand_in%%=*}"
        chmod +x "$WORK/bin/${stand_in%%=*}"
    done
}

# shellcheck disable=SC2016 # the code is for the inner shell
# Runs set-up code as an ordinary user would (EUID is read-only, so that the two questions about root are answered here).
try() {
    "$(command -v env)" -i PATH="$WORK/bin" HOME="$WORK" ROOT="$WORK" "${@:2}" "$(command -v timeout)" 20 bash -c '
        say() { printf "dev: %s\n" "$*" >&2; }
        die() { say "$*"; exit 1; }
        . "'"$ROOT"'/tools/setup.sh"
        [ -n "${PLAIN_USER:-}" ] && may_become_root() { sudo -n true 2>/dev/null; }
        '"$1" 2>&1 </dev/null
}

expect() {
    local name=$1 status=$2 words=$3 said
    shift 3
    said=$(try "$@")
    local got=$?
    if [[ $got -ne $status || $said != *"$words"* ]]; then
        printf 'FAIL %s: status %d (expected %d), said: %s\n' "$name" "$got" "$status" "$said"
        failures=$((failures + 1))
    fi
}

INSTALLED='dpkg-query=echo installed'
ABSENT='dpkg-query=case "$*" in *gnuplot*) exit 1;; *) echo installed;; esac'

machine "$INSTALLED"
expect "all installed needs neither apt nor root" 0 "" 'install_packages gcc gnuplot-nox'
machine "$ABSENT"
expect "no apt-get" 1 "Install these packages: gnuplot-nox" 'install_packages gcc gnuplot-nox'
machine
expect "no Debian" 1 "not a Debian machine" 'install_packages gcc gnuplot-nox'
expect "no Debian, reported" 0 "" 'install_packages gcc gnuplot-nox' IQFOC_NO_INSTALL=1
machine "$ABSENT" 'apt-get=exit 99'
expect "no root, no sudo" 1 "Run: apt-get install gnuplot-nox" 'install_packages gcc gnuplot-nox' PLAIN_USER=1
machine "$ABSENT" 'apt-get=exit 99' 'sudo=exit 1'
expect "sudo wants a password" 1 "Run: apt-get install gnuplot-nox" 'install_packages gcc gnuplot-nox' PLAIN_USER=1
machine "$ABSENT" 'apt-get=echo "E: no such package"; exit 100' 'sudo=shift; exec "$@"'
expect "apt-get fails" 1 "E: no such package" 'install_packages gcc gnuplot-nox' PLAIN_USER=1
# Another apt holds the lock once, then a mirror fails once: each is said in one line, and apt-get is run again.
# shellcheck disable=SC2016 # for the stand-in's shell
once='case "$*" in *update*) exit 0;; esac; [ -e "$HOME/tried" ] && exit 0; touch "$HOME/tried"'
machine "$ABSENT" "apt-get=$once; echo 'E: Could not get lock /var/lib/dpkg/lock-frontend'; exit 100" 'sudo=shift; exec "$@"'
rm -f "$WORK/tried"
expect "another apt" 0 "another apt is running; waiting for it" 'install_packages gcc gnuplot-nox' PLAIN_USER=1 IQFOC_APT_PAUSE_S=0
machine "$ABSENT" "apt-get=$once; echo 'E: Failed to fetch http://mirror.example/x.deb'; exit 100" 'sudo=shift; exec "$@"'
rm -f "$WORK/tried"
expect "a broken fetch" 0 "could not fetch everything; trying again" 'install_packages gcc gnuplot-nox' PLAIN_USER=1 IQFOC_APT_PAUSE_S=0
machine "$ABSENT" "apt-get=echo 'E: Failed to fetch http://mirror.example/x.deb'; exit 100" 'sudo=shift; exec "$@"'
expect "a fetch that stays broken" 1 "E: Failed to fetch" 'install_packages gcc gnuplot-nox' PLAIN_USER=1 IQFOC_APT_PAUSE_S=0
# musl decides the last decimals of results.
machine
mkdir -p "$WORK/packages" "$WORK/musl"
ln -s "$(type -P sha256sum)" "$WORK/bin/sha256sum"
ln -sf "$ROOT/packages/musl.sha256" "$WORK/packages/musl.sha256"
expect "another musl" 1 "not the pinned one" 'set_up_math' "MUSL_SOURCE_DIR=$WORK/musl"
machine
expect "UNITY_DIR is wrong" 1 "there is no unity.c in it" 'set_up_unity' UNITY_DIR=/nowhere
expect "no Unity, no apt-get" 1 "Set UNITY_DIR" 'set_up_unity'

# Where Unity's source package comes from: the machine's own mirror and keyring, in either form of apt's entries.
machine
for tool in awk sed; do ln -s "$(type -P "$tool")" "$WORK/bin/$tool"; done
mkdir -p "$WORK/apt/sources.list.d" "$WORK/out"
cat >"$WORK/apt/sources.list.d/debian.sources" <<'END'
# the machine's
Types: deb
URIs: http://mirror.example/debian
Suites: bookworm bookworm-updates
Components: main contrib
Architectures: amd64
Signed-By: /keys/debian.gpg

Types: deb
URIs: http://mirror.example/debian-security
Suites: bookworm-security
Components: main

Enabled: no
Types: deb
URIs: http://off.example/debian
Suites: bookworm
Components: main
END
echo 'deb [arch=amd64 signed-by=/keys/old.gpg] http://old.example/debian bookworm contrib main' >"$WORK/apt/sources.list"
try "APT_SOURCES=$WORK/apt write_source_entries bookworm $WORK/out" >/dev/null
same() {
    if [[ $2 != "$3" ]]; then
        printf 'FAIL %s: wanted\n%s\nand got\n%s\n' "$1" "$3" "$2"
        failures=$((failures + 1))
    fi
}
same "deb822 entries" "$(cat "$WORK/out/src.sources")" 'Types: deb-src
URIs: http://mirror.example/debian
Suites: bookworm
Components: main
Signed-By: /keys/debian.gpg'
same "one-line entries" "$(tr -s ' ' <"$WORK/out/src.list" | sed 's/\[ /[/')" \
    'deb-src [signed-by=/keys/old.gpg] http://old.example/debian bookworm main'

# What opens with #! is a program: ./dev and others start it by its name, and git keeps that it can be.
while IFS=$'\t' read -r kept path; do
    first=
    [[ ! -f $ROOT/$path ]] || IFS= read -r -n 2 first <"$ROOT/$path" 2>/dev/null
    case "${kept%% *}$first" in
    '100644#!') printf 'FAIL %s opens with #! and cannot be run: chmod +x\n' "$path" && failures=$((failures + 1)) ;;
    100755[!#]*) printf 'FAIL %s can be run and does not say by what\n' "$path" && failures=$((failures + 1)) ;;
    esac
done < <(git -C "$ROOT" ls-files -s)

((failures == 0)) && printf 'set-up: all as expected\n'
exit $((failures != 0))
