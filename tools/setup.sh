# Sourced by ./dev: makes a fresh Debian machine ready. Installs missing packages only, without questions.
# shellcheck shell=bash disable=SC2034 # its lists are used by ./dev

# What `build` and `demo` need.
BUILD_PACKAGES=(gcc g++ libc6-dev cmake ninja-build pkg-config libtomlplusplus-dev libeigen3-dev libkissfft-dev
    nlohmann-json3-dev zlib1g-dev gnuplot-nox)
# What `test` needs on top: the recordings' numerics, the compiler and emulator of Cortex-M4.
QUICK_PACKAGES=(git python3 python3-numpy xz-utils gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm)
# What `test --all`, `check`, `bench` and `blind` need on top: the second compiler and its checkers, the other targets' compilers and
# emulators, the independent integrator, coverage, a browser, a counter of instructions, and numerics of the blind tests.
TEST_PACKAGES=("${QUICK_PACKAGES[@]}" python3-scipy python3-venv libsundials-dev gcovr clang libclang-rt-dev clang-tidy clang-format
    cppcheck shellcheck gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf qemu-system-misc gcc-avr avr-libc gcc-xtensa-lx106 lld make
    chromium chromium-driver libxml2-utils g++-aarch64-linux-gnu qemu-user-static file zsh fish ccache valgrind)

# What `web` needs.
WEB_PACKAGES=(clang lld cmake ninja-build wasi-libc libc++-14-dev-wasm32 libclang-rt-14-dev-wasm32 libtomlplusplus-dev libeigen3-dev
    libkissfft-dev nlohmann-json3-dev python3)

# What `site` needs.
SITE_PACKAGES=(git python3 python3-venv doxygen)

# What `bench --rtl` needs.
RTL_PACKAGES=(verilator python3-venv)

# What `prove` needs.
PROVE_PACKAGES=(python3 frama-c-base gappa)

# The packages among the arguments that are not installed, one a line.
missing_packages() {
    local package
    for package in "$@"; do
        if [[ $(dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | head -n 1) != installed ]]; then
            printf '%s\n' "$package"
        fi
    done
}

# Runs its arguments as root, or fails without a question.
as_root() {
    if [[ $EUID -eq 0 ]]; then
        "$@"
    else
        sudo -n "$@"
    fi
}

may_become_root() {
    [[ $EUID -eq 0 ]] || { command -v sudo >/dev/null && sudo -n true 2>/dev/null; }
}

# Installs those of the packages that are missing; fails with the list where it cannot.
install_packages() {
    [[ -n ${IQFOC_NO_INSTALL:-} ]] && return 0
    local missing log=$ROOT/.cache/apt.log
    if ! command -v dpkg-query >/dev/null; then
        die "this is not a Debian machine. Install what these packages hold, then set IQFOC_NO_INSTALL=1: $*"
    fi
    mapfile -t missing < <(missing_packages "$@")
    ((${#missing[@]})) || return 0
    command -v apt-get >/dev/null || die "apt-get is missing. Install these packages: ${missing[*]}"
    may_become_root || die "no root and no sudo without a password. Run: apt-get install ${missing[*]}"

    say "installing ${#missing[@]} Debian packages: ${missing[*]}"
    mkdir -p "$ROOT/.cache"
    : >"$log"
    if ! run_apt "$log" update || ! run_apt "$log" install -y --no-install-recommends "${missing[@]}"; then
        tail -n 20 "$log" >&2
        die "apt-get failed (above; all of it in $log). Needed: ${missing[*]}"
    fi
}

# How long apt-get waits for another apt, and how long it stays away from a mirror that failed.
APT_WAIT_S=1800
APT_PAUSE_S=${IQFOC_APT_PAUSE_S:-10}

# Runs apt-get with the arguments $2..., its output in the log $1. Waits for another apt, and tries a broken fetch twice more, each said
# in one line. (`update` takes the lists' lock, which no option of apt-get waits for.)
run_apt() {
    local log=$1 try said waited=0 start
    shift
    for try in 1 2 3; do
        while :; do
            start=$(wc -c <"$log")
            if as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o Acquire::Retries=3 -o "DPkg::Lock::Timeout=$APT_WAIT_S" \
                -o Dpkg::Use-Pty=0 "$@" >>"$log" 2>&1 </dev/null; then
                # (`update` succeeds without the lists that it could not fetch.)
                said=$(tail -c "+$((start + 1))" "$log")
                [[ $1 != update || $said != *"Some index files failed to download"* ]] && return 0
                break
            fi
            said=$(tail -c "+$((start + 1))" "$log")
            [[ $said == *"Could not get lock"* || $said == *"Unable to lock"* ]] || break
            ((waited < APT_WAIT_S)) || break
            ((waited)) || say "another apt is running; waiting for it, $((APT_WAIT_S / 60)) minutes at most"
            sleep "$APT_PAUSE_S"
            waited=$((waited + APT_PAUSE_S + 1))
        done
        [[ $said == *"Failed to fetch"* || $said == *"Some index files failed"* ]] || return 1
        ((try < 3)) || return 1
        say "apt-get $1 could not fetch everything; trying again"
        sleep "$APT_PAUSE_S"
    done
}

# The machine's own Debian sources as deb-src entries of the release's main part, in the deb822 form where the machine has it.
# Mirror and keyring stay the machine's; options that narrow the architecture do not fit sources and go.
write_source_entries() {
    local codename=$1 folder=$2 apt=${APT_SOURCES:-/etc/apt} file
    : >"$folder/src.sources"
    : >"$folder/src.list"
    for file in "$apt"/sources.list.d/*.sources; do
        [[ -r $file ]] || continue
        grep -v '^#' "$file" | awk -v RS= -v codename="$codename" '
            /(^|\n)[Ee]nabled:[ \t]*no/ { next }
            $0 !~ "(^|\n)Suites:[^\n]*[ \t]" codename "([ \t\n]|$)" { next }
            !/(^|\n)Components:[^\n]*[ \t]main([ \t\n]|$)/ { next }
            {
                count = split($0, line, "\n")
                for (i = 1; i <= count; i++) {
                    if (line[i] ~ /^Types:/) line[i] = "Types: deb-src"
                    if (line[i] ~ /^Suites:/) line[i] = "Suites: " codename
                    if (line[i] ~ /^Components:/) line[i] = "Components: main"
                    if (line[i] !~ /^Architectures:/) print line[i]
                }
                print ""
            }' >>"$folder/src.sources"
    done
    for file in "$apt"/sources.list "$apt"/sources.list.d/*.list; do
        [[ -r $file ]] || continue
        # deb [options] URI release ... main ...
        sed -nE "s/^deb[ \t]+(\[.*\][ \t]+)?([^ \t]+)[ \t]+${codename}[ \t]+(.*[ \t])?main([ \t].*)?$/deb-src \1\2 ${codename} main/p" \
            "$file" | sed -E 's/arch=[^] ]*//' >>"$folder/src.list"
    done
}

# Downloads the tarball of a source package of this release into an empty folder: "$work"/<package>_*.orig.tar.*. Needs no root: apt
# works on folders of this tree, and the machine's own lists and sources stay as they are.
fetch_source() {
    local package=$1 work=$2 codename
    codename=$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")
    rm -rf "$work"
    mkdir -p "$work"/{parts,state/lists/partial,cache/archives/partial}
    write_source_entries "$codename" "$work/parts"
    local apt_options=(-q -o "Dir::Etc::sourcelist=/dev/null" -o "Dir::Etc::sourceparts=$work/parts"
        -o "Dir::State::lists=$work/state/lists" -o "Dir::Cache=$work/cache" -o "APT::Get::List-Cleanup=0"
        -o "APT::Sandbox::User=$(id -un)" -o Acquire::Retries=3 -o Acquire::Languages=none)
    (cd "$work" && apt-get update "${apt_options[@]}" && apt-get source "${apt_options[@]}" --download-only --tar-only "$package") \
        >"$work/log" 2>&1 </dev/null && return
    tail -n 10 "$work/log" >&2
    return 1
}

# Takes Unity out of the source package of ntpsec, which Debian 12 has it in.
fetch_unity() {
    local target=$1 work=$ROOT/.cache/unity-fetch tarball
    say "fetching the test framework Unity from Debian's source package ntpsec"
    fetch_source ntpsec "$work" ||
        die "Unity could not be fetched (above). Set UNITY_DIR to a folder with unity.c, unity.h and unity_internals.h"
    tarball=$(echo "$work"/ntpsec_*.orig.tar.*)
    mkdir "$work/unity"
    tar -C "$work/unity" --no-same-owner --strip-components=3 --wildcards -xf "$tarball" \
        '*/tests/unity/unity.c' '*/tests/unity/unity.h' '*/tests/unity/unity_internals.h' ||
        die "no Unity inside $tarball. Set UNITY_DIR to a folder with unity.c, unity.h and unity_internals.h"
    unity_is_pinned "$work/unity" || die "Unity in $tarball is not the pinned one (packages/unity.sha256)"
    rm -rf "$target"
    mv "$work/unity" "$target"
    rm -rf "$work"
}

# The Python programs of packages/python/$1.txt, each pinned by hash, in an environment of their own: .cache/python/$1.
# What they need is in the file too; `./dev lock` writes it from the .in in the same folder.
set_up_python() {
    local name=$1 place=$ROOT/.cache/python/$1 log=$ROOT/.cache/pip.log
    local pins=$ROOT/packages/python/$name.txt
    [[ -r $pins ]] || die "there are no tools '$name': packages/python/$name.txt is missing"
    cmp -s "$pins" "$place/pins.txt" && return 0
    say "installing packages/python/$name.txt from PyPI into .cache/python/$name"
    rm -rf "$place"
    mkdir -p "${place%/*}"
    if ! /usr/bin/python3 -m venv "$place" >"$log" 2>&1 ||
        ! "$place/bin/pip" install --quiet --disable-pip-version-check --require-hashes --only-binary :all: -r "$pins" \
            >>"$log" 2>&1; then
        tail -n 10 "$log" >&2
        die "packages/python/$name.txt could not be installed (above; all of it in $log)"
    fi
    cp "$pins" "$place/pins.txt" # whole
}

# Updates packages/python/*.txt: the versions that the .in files name and what they need, with the hash of each of their files.
lock_python() {
    local file
    set_up_python lock
    for file in packages/python/*.in; do
        (cd packages/python && ../../.cache/python/lock/bin/pip-compile --quiet --generate-hashes --allow-unsafe --strip-extras \
            --no-header --no-emit-find-links --output-file "$(basename "$file" .in).txt" "$(basename "$file")")
    done
}

# npm's package $1 (NAME@VERSION) in .cache/NAME, held to the hashes of packages/NAME.sha256.
set_up_npm() {
    local name=${1%@*} place=$ROOT/.cache/${1%@*} work=$ROOT/.cache/${1%@*}-fetch
    npm_is_pinned "$name" "$place" && return 0
    command -v npm >/dev/null || install_packages npm
    say "fetching $1 from npm into .cache/$name"
    rm -rf "$work" "$place"
    mkdir -p "$work"
    if ! (cd "$work" && npm pack --silent "$1" && tar -xzf "$name"-*.tgz) >"$work/log" 2>&1 </dev/null; then
        tail -n 10 "$work/log" >&2
        die "$1 could not be fetched (above). Unpack its package from npm as .cache/$name"
    fi
    npm_is_pinned "$name" "$work/package" || die "$1 as npm has it is not the pinned one (packages/$name.sha256)"
    mv "$work/package" "$place"
    rm -rf "$work"
}

npm_is_pinned() {
    [[ -d $2 ]] && (cd "$2" && sha256sum --status --strict -c "$ROOT/packages/$1.sha256" 2>/dev/null)
}

# uPlot, which draws the report pages' curves, where CMake looks for it (cmake/iqfoc-uplot.cmake). UPLOT_DIR may name another folder.
set_up_uplot() {
    [[ -n ${UPLOT_DIR:-} ]] || set_up_npm uplot@1.6.32
}

# What lets the site's search run where it is opened from disk.
set_up_iframe_worker() {
    set_up_npm iframe-worker@1.0.4
}

# Unpacks the sources of Debian's source package $1 into .cache/$1, once; $2 is a file of theirs.
set_up_source() {
    local name=$1 work=$ROOT/.cache/$1-fetch
    [[ ! -r $ROOT/.cache/$name/$2 ]] || return 0
    say "fetching the sources of Debian's source package $name into .cache/$name"
    fetch_source "$name" "$work" || return 1
    mkdir "$work/$name"
    tar -C "$work/$name" --no-same-owner --strip-components=1 -xf "$(echo "$work/$name"_*.orig.tar.*)" || return 1
    rm -rf "$ROOT/.cache/$name"
    mv "$work/$name" "$ROOT/.cache/$name"
    rm -rf "$work"
}

# Sets and exports ZLIB_SOURCE_DIR: the caller's, or zlib's sources out of Debian's source package, for the static programs
# (presets static-*): the package zlib1g-dev is for this machine's processor alone.
set_up_zlib() {
    [[ -n ${ZLIB_SOURCE_DIR:-} ]] || set_up_source zlib zlib.h ||
        die "zlib's sources could not be fetched (above). Set ZLIB_SOURCE_DIR to their folder"
    export ZLIB_SOURCE_DIR=${ZLIB_SOURCE_DIR:-$ROOT/.cache/zlib}
}

musl_is_pinned() {
    [[ -d $1 ]] && (cd "$1" && sha256sum --status --strict -c "$ROOT/packages/musl.sha256" 2>/dev/null)
}

# Sets and exports MUSL_SOURCE_DIR: the caller's, or musl's sources. The program takes sine, exponential and similar functions
# from them, so that its results have the same bits everywhere. Without them it builds with this machine's functions.
set_up_math() {
    if [[ -z ${MUSL_SOURCE_DIR:-} ]] && ! set_up_source musl src/math/sin.c; then
        say "musl's sources could not be fetched (above): the last decimals of results may differ from another machine's"
        return 0
    fi
    export MUSL_SOURCE_DIR=${MUSL_SOURCE_DIR:-$ROOT/.cache/musl}
    musl_is_pinned "$MUSL_SOURCE_DIR" ||
        die "musl in $MUSL_SOURCE_DIR is not the pinned one (packages/musl.sha256): results would have other digits"
}

unity_is_pinned() {
    [[ -d $1 ]] && (cd "$1" && sha256sum --status --strict -c "$ROOT/packages/unity.sha256" 2>/dev/null)
}

# Sets and exports UNITY_DIR: the caller's, the one fetched before, an installed one, Debian 13's package, Debian 12's sources.
set_up_unity() {
    local fetched=$ROOT/.cache/unity installed=/usr/share/cmock/vendor/unity/src
    if [[ -n ${UNITY_DIR:-} ]]; then
        [[ -r $UNITY_DIR/unity.c ]] || die "UNITY_DIR is '$UNITY_DIR', and there is no unity.c in it"
    elif unity_is_pinned "$fetched"; then
        UNITY_DIR=$fetched
    else
        command -v apt-get >/dev/null ||
            die "the test framework Unity is missing, and there is no apt-get to fetch it. Set UNITY_DIR to the folder of unity.c"
        if [[ ! -r $installed/unity.c && -n $(apt-cache search --names-only '^cmock$' 2>/dev/null) ]]; then
            install_packages cmock
        fi
        if [[ -r $installed/unity.c ]]; then
            UNITY_DIR=$installed
        else
            fetch_unity "$fetched"
            UNITY_DIR=$fetched
        fi
    fi
    export UNITY_DIR
}
