# Sourced by ./dev: the parts of `./dev test` and `./dev check`, and the line that counts them all. A part is a function. Its output goes
# to build/logs/, and is printed if it fails.
# shellcheck shell=bash

# What each part ended with: passed, failed and name, a line each.
RESULTS=build/logs/results

# Runs a command that ends at the first one in it that fails.
in_subshell() (
    set -euo pipefail
    "$@"
)

# Runs the function $2... as the part named $1. A part that ends as ctest does counts that many tests, any other counts as one.
run_part() {
    local name=$1 log=build/logs/$1.log start=$SECONDS status=0 total=1 failed=0 count user system seconds
    local TIMEFORMAT='%0U %0S'
    shift
    printf '%s' "$name" >"$LANE"
    {
        set +e # a part that fails has a time, too
        time in_subshell "$@" >"$log" 2>&1 </dev/null
        exit $?
    } 2>"build/logs/$name.time" &
    wait $! || status=$?
    read -r user system <"build/logs/$name.time"
    seconds="$((SECONDS - start)) s, $((user + system)) s of processor time"

    count=$(sed -nE 's/^[0-9]+% tests passed, ([0-9]+) tests? failed out of ([0-9]+)$/\1 \2/p' "$log" | tail -n 1)
    if [[ -n $count ]]; then
        read -r failed total <<<"$count"
    fi
    if ((status != 0 && failed == 0)); then
        failed=1
        [[ -n $count ]] && total=$((total + 1))
    fi
    printf '%d %d %s\n' $((total - failed)) "$failed" "$name" >>"$RESULTS"
    [[ -t 1 ]] && printf '\r\033[K'
    if ((status == 0)); then
        printf '  ok    %-14s %5d test%s %s\n' "$name" "$total" "$( ((total == 1)) && printf ' ' || printf s)" "$seconds"
    else
        printf '%s\n' "$(
            printf '  FAIL  %-14s %5d of %d  %s\n' "$name" "$failed" "$total" "$seconds"
            tail -n 60 "$log" | sed 's/^/        /'
            printf '        (all of it: %s)' "$log"
        )"
    fi
}

# Runs a part unless a lane has begun it.
take_part() {
    mkdir "build/logs/$1.begun" 2>/dev/null || return 0
    run_part "$@"
}

# Waits until the part $1 of the other lane has ended.
wait_for() {
    until grep -q " $1\$" "$RESULTS"; do sleep 1; done
}

# Shows, on a terminal, which parts the lanes $2... are at, until the process $1 ends.
show_progress() {
    local lane names columns line start=$SECONDS pid=$1
    shift
    columns=$(tput cols 2>/dev/null || printf 80)
    while kill -0 "$pid" 2>/dev/null; do
        names=
        for lane in "$@"; do
            names+=" $(cat "build/logs/lane.$lane" 2>/dev/null || true)"
        done
        line=$(printf '  ... %4d s %s' $((SECONDS - start)) "$names")
        printf '\r\033[K%s' "${line:0:columns-1}"
        sleep 0.5
    done
    printf '\r\033[K'
}

# Runs the functions $@, each a lane of parts, at the same time, so that a part with one remaining job leaves the other
# cores to the other lane. Parts that build into one folder, or need another's output, are in the same lane. At the end: the failed parts,
# and one line in ctest's form.
run_lanes() {
    local lane pids=() passed=0 failed=0 names=() one two three
    rm -rf build/logs
    mkdir -p build/logs
    : >"$RESULTS"
    # A process group for each lane, so that an interrupt ends all that it started.
    set -m
    for lane in "$@"; do
        (
            set +m
            LANE=build/logs/lane.$lane
            "$lane"
            : >"$LANE"
        ) </dev/null &
        pids+=($!)
    done
    set +m
    # shellcheck disable=SC2064 # the lanes as they are now
    trap "kill -TERM -- ${pids[*]/#/-} 2>/dev/null; die interrupted" INT TERM
    for one in "${pids[@]}"; do
        [[ -t 1 ]] && show_progress "$one" "$@"
        wait "$one" || printf '%d %d %s\n' 0 1 "a lane that broke off" >>"$RESULTS"
    done
    trap - INT TERM

    while read -r one two three; do
        passed=$((passed + one))
        failed=$((failed + two))
        ((two)) && names+=("$three")
    done <"$RESULTS"
    ((failed)) && printf '\nFailed: %s\n' "${names[*]}"
    printf '%d%% tests passed, %d tests failed out of %d\n' $((100 * passed / (passed + failed))) "$failed" $((passed + failed))
    ((failed == 0))
}

# Labels of tests that one build is enough for: exhaustive ones, and those that run none of the C code, or run it by the program
# that the host preset built; studies and `long` tests, which call for longer what shorter tests call too.
NO_STUDY='^(sweep|blind|tool|study|long)$'
# Coverage is the library's and the parts', by their unit tests: the program as its user meets it adds nothing.
UNIT_ONLY='^(sweep|blind|tool|cli|study|long)$'

# Builds all of a preset and runs its tests but for those with a label that matches $2.
test_preset() {
    build_preset "$1" all -DBUILD_TESTING=ON -DIQFOC_TESTS=all
    UBSAN_OPTIONS=print_stacktrace=1 ctest --test-dir "build/$1" -j "$JOBS" --no-tests=error --output-on-failure \
        ${2:+--label-exclude "$2"}
}

# The library's unit tests by an optimising clang. Of the host's code the asan preset has clang's warnings.
test_clang() {
    build_preset clang tests/unit/library/all -DBUILD_TESTING=ON -DIQFOC_TESTS=all
    ctest --test-dir build/clang/tests/unit/library -j "$JOBS" --no-tests=error --output-on-failure --label-exclude "$NO_STUDY"
}

# The library for a target without an operating system needs nothing of a C library.
test_freestanding() {
    build_preset "$1" all
    python3 tools/check_freestanding.py "$2" "build/$1/src/libiqfoc.a"
}

# All C and C++ files of the tree, tracked or about to be, but for headers that the diagnosis wrote.
source_files() {
    git ls-files -co --exclude-standard -- '*.c' '*.h' '*.cpp' '*.hpp' ':!:*iqfoc_extension.h' | sort -u
}

check_format() {
    source_files | xargs clang-format --dry-run -Werror
}

# The C and C++ files that the clang preset compiles.
compiled_files() {
    python3 - <<'END'
import json, os
root = os.getcwd() + "/"
files = {entry["file"] for entry in json.load(open("build/clang/compile_commands.json"))}
# (What a build writes is not ours to read.)
print("\n".join(sorted(f for f in files if f.startswith(root) and not f.startswith((root + ".cache/", root + "build/")))))
END
}

# A file at a time: over several, the va_list checker of Debian 12's clang-tidy carries one file's state into the next. In C++ the
# checkers of malloc and new follow Eigen into its headers, and take memory that a destructor frees, and the allocation that Eigen fails
# by, for lost. The analyzer follows a function through 20,000 states instead of 225,000: a tenth of the time. Tests get the other
# checks alone: the sanitizers run their paths.
# shellcheck disable=SC2016 # the inner shell expands its $1
check_tidy() {
    configure_preset clang -DBUILD_TESTING=ON
    compiled_files | xargs -P "$JOBS" -n 1 sh -c 'echo "$1"
        case $1 in
        */tests/*) checks=--checks=-clang-analyzer-* ;;
        *.cpp) checks=--checks=-clang-analyzer-unix.Malloc,-clang-analyzer-unix.MismatchedDeallocator,-clang-analyzer-cplusplus.NewDeleteLeaks ;;
        *) checks= ;;
        esac
        deep="-Xclang --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=max-nodes=20000"
        exec clang-tidy --quiet -p build/clang $checks --extra-arg=$deep "$1" 2>/dev/null' sh |
        tee build/clang-tidy.txt || {
        printf '\nFindings:\n'
        grep -A 3 -E '(error|warning):' build/clang-tidy.txt
        return 1
    }
}

check_cppcheck() {
    mkdir -p build/cppcheck
    cppcheck --quiet -j "$JOBS" --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
        --suppressions-list=tools/cppcheck.suppress --cppcheck-build-dir=build/cppcheck -I include -I sim_host \
        -UIQFOC_TARGET_HEADER src sim_host port
}

# The library's lines and branches that its unit tests reach, headers with inline functions included. A condition in
# cycle_check.h is one of constants wherever it is used, and gcc counts every use's: its branches are left out.
check_coverage() {
    # Tests of the library that need parts of the host, in addition to those of tests/unit/library.
    local more=(recorder wire_damage adapt induction mean_modulated half_period host_drive synchronous_drive commission)
    configure_preset coverage -DBUILD_TESTING=ON
    cmake --build build/coverage --target tests/unit/library/all "${more[@]/#/test_}" -j "$JOBS"
    find build/coverage -name '*.gcda' -delete
    ctest --test-dir build/coverage/tests/unit/library -j "$JOBS" --no-tests=error --output-on-failure --label-exclude "$UNIT_ONLY"
    ctest --test-dir build/coverage -j "$JOBS" --no-tests=error --output-on-failure -R "^($(printf '%s|' "${more[@]}")none)$"
    local measured=(--root . --object-directory build/coverage --filter src/ --filter include/ --exclude-throw-branches)
    gcovr "${measured[@]}" --json-summary build/coverage/summary.json --txt --fail-under-line 98
    gcovr "${measured[@]}" --exclude include/iqfoc/cycle_check.h --txt --branches --fail-under-branch 90
}

check_scripts() {
    shellcheck -x dev .ci/run tools/*.sh python/*.sh
}

static_checks() {
    run_part format check_format
    run_part clang-tidy check_tidy
    run_part cppcheck check_cppcheck
    run_part shellcheck check_scripts
}

check_everything() {
    run_lanes static_checks
}

# A bound that was taken out is found, then a little of what `./dev fuzz` does.
check_fuzz() {
    build_preset fuzz fuzzers
    tests/fuzz/run.py --build build/fuzz --planted --seconds 60
    tests/fuzz/run.py --build build/fuzz --seconds 10 --jobs "$JOBS"
}

# No undefined behaviour, and the error bounds: docs/proofs.md.
check_prove() {
    python3 -B tools/prove.py
    python3 -B tools/bounds.py
}

# The program in one file, for this processor and another, and the object that links with another C library.
build_static() {
    local preset
    for preset in static-x86-64 static-arm64; do
        cmake --preset "$preset"
        cmake --build "build/$preset" -j "$JOBS" --target iqfoc_cli iqfoc_object
    done
}

# docs/licences.md lists the parts of others in the static programs.
check_static() {
    build_static
    python3 -B tests/cli/static.py build/host/iqfoc build/static-x86-64/iqfoc build/static-arm64/iqfoc
    python3 -B tests/cli/relink.py build/static-x86-64 build/static-arm64
    python3 -B tools/licences.py build/static-x86-64
}

# What the program built by gcc does, and what the targets' compilers make of the library.
# The page in the browser against the program that the host preset built.
test_web() {
    web
    python3 -B tests/browser/web_page.py build/host/iqfoc build/web/index.html
    build_preset cortex-m4 iqfoc_pil
    python3 -B tests/browser/live_page.py build/host/iqfoc build/web/index.html
}

# The pages, and that a search of them leads to the right ones.
check_site() {
    python3 -B tools/site/build.py
    python3 -B tests/browser/site_search.py build/site
}

# At its end, where other lanes may have nothing left to do, are parts that fill all cores.
program_lane() {
    run_part host test_preset host
    run_part cortex-m4 test_freestanding cortex-m4 arm-none-eabi-nm
    run_part rv32 test_freestanding rv32 riscv64-unknown-elf-nm
    run_part web test_web
    run_part misra python3 tools/misra.py check
    run_part site check_site
    run_part target tests/target/run.sh
    run_part golden python3 tools/golden.py check
    run_part bench bench/run.sh --check
    free_parts
}

# Other compilers, sanitizers, static analysis.
source_lane() {
    run_part clang test_clang
    run_part asan test_preset asan "$NO_STUDY"
    static_checks
    run_part fuzz check_fuzz
    run_part coverage check_coverage
    free_parts
}

# Once the host's tests have ended, parts remain that wait: for a browser, for an emulator, for one long job.
third_lane() {
    wait_for host
    free_parts
}

# What needs no other part's folder, and of their outputs the host's build alone: a lane that has done its own takes the next, the longest
# first.
free_parts() {
    take_part prove check_prove
    take_part consume tests/consume/run.py
    wait_for host
    take_part python python/test.sh
    take_part blind tests/blind/run.py --ci --jobs "$JOBS"
    take_part figures python3 tools/figures.py check
    take_part mutate python3 -B tools/mutate.py --check --jobs "$JOBS"
    take_part static check_static
    take_part third tests/blind/third.py --ci --jobs "$JOBS"
    take_part examples python3 tools/check_examples.py
}

# What a developer without the further packages runs: ./dev test. The tests of the built program, and those of the target.
quick_host_lane() {
    run_part host quick_host
    run_part blind tests/blind/run.py --quick --jobs "$JOBS"
}

quick_target_lane() {
    run_part cortex-m4 test_freestanding cortex-m4 arm-none-eabi-nm
    run_part target tests/target/run.sh --quick
    run_part bench bench/run.sh --check --quick
    run_part examples python3 tools/check_examples.py --quick
}

quick_host() {
    build_preset host all -DBUILD_TESTING=ON -DIQFOC_TESTS=quick
    ctest --test-dir build/host -j "$JOBS" --no-tests=error --output-on-failure --label-exclude '^(sweep|study|tool|blind|long)$'
}

test_quickly() {
    run_lanes quick_host_lane quick_target_lane
}

test_everything() {
    run_lanes program_lane source_lane third_lane
}
