#!/usr/bin/env bash
# Everything that must hold before a merge.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage="usage: tests/run.sh [--quick | --arm | --vm | --all]
  (nothing)  rules, release tests, the demo, its digest on 64-bit and 32-bit ARM in qemu's user emulation, the tests but
             for whole drives and experiments under address and undefined-behaviour sanitizers, clang-tidy over what
             the real-time threads run: core and drivers
  --quick    rules and release tests
  --arm      rules, release tests, and for 64-bit and 32-bit ARM: the tests but for whole drives and the digests, in
             qemu's user emulation; the Debian package, the 64-bit one in a virtual machine, too
  --vm       rules, release tests, and the package on a PREEMPT_RT kernel with systemd and vcan in a virtual machine
  --all      all of this; clang-tidy over the rest; the tests without OpenCV, by clang, at -O0 but for the same, and,
             but for the same and replays of one thread, under the thread sanitizer; equal digests across
             compilers, optimisation levels and kernels; the documents' commands that take minutes; the Debian package in
             a Debian of its own; the virtual machine; each fuzz target for CRSPF_FUZZ_SECONDS (60); a day of standing,
             and the service in real time
Installs what is missing (tools/setup.sh). Recordings are looked for in \$CRSPF_DATA; tests that need one they do not
find say so. Logs are left in build/logs. Exit status 0 if everything passed."
mode=normal
case ${1:-} in
    '') ;;
    --quick | --arm | --vm | --all) mode=${1#--} ;;
    -h | --help) echo "$usage"; exit 0 ;;
    *) echo "$usage" >&2; exit 2 ;;
esac

jobs=$(nproc)
logs=build/logs
mkdir -p "$logs"
passed=()
failed=()
trap 'kill $(jobs -p) 2>/dev/null || true' EXIT  # the heartbeat, where Ctrl-C ends a step

# heartbeat LOG: each minute the last line of it, so that whoever waits sees where it is.
heartbeat() {
    local pipe begin=$SECONDS
    exec {pipe}<> <(:)  # nothing ever comes: a `sleep` would outlive what is killed here
    while ! read -rt 60 -u "$pipe"; do
        printf '\n    %4d s: %.120s ' $((SECONDS - begin)) "$(tail -n 1 "$1" | tr -d '\r')"
    done
}

# step NAME COMMAND...: runs it, shows its log only if it fails, and goes on either way.
step() {
    local name=$1 log="$logs/$1.log" begin=$SECONDS status pulse
    shift
    printf '==> %-18s ' "$name"
    : >"$log"
    heartbeat "$log" &
    pulse=$!
    set +e  # not `if` or `||`: within them bash ignores -e, and a step would run on after its first failure
    (set -e; "$@") >"$log" 2>&1
    status=$?
    kill "$pulse"
    wait "$pulse" 2>/dev/null
    set -e
    if ((status == 0)); then
        passed+=("$name")
        printf 'ok      %4d s\n' $((SECONDS - begin))
        # What ctest has to say at its end, and which proof is missing for lack of what.
        grep -hE 'tests passed, |skipped: |^ring: (FAILED|all)|^poses: ' "$log" | sort -u | sed 's/^ */    /' || true
    else
        failed+=("$name")
        printf 'FAILED  %4d s\n' $((SECONDS - begin))
        sed 's/^/    /' "$log"
    fi
}

sources() {
    local directory
    for directory in "$@"; do
        [[ ! -d $directory ]] || find "$directory" -name '*.hpp' -o -name '*.cpp'
    done
}

check_format() {
    sources core drivers config platform tools tests | xargs clang-format --dry-run --Werror
}

# build_and_test PRESET [CMAKE_OPTION...]
build_and_test() {
    local preset=$1
    shift
    cmake --preset "$preset" "$@"
    cmake --build --preset "$preset" -- -j "$jobs"
    ctest --preset "$preset" -j "$jobs"
    grep -h 'skipped: ' "build/$preset/Testing/Temporary/LastTest.log" || true  # ctest itself hides what a passing test says
}

# arm PRESET ARCHITECTURE
arm() {
    toolchains/sysroot.sh "$2"
    build_and_test "$1"
    cpack --config "build/$1/CPackConfig.cmake" -B "build/$1/made"
    [[ $(dpkg-deb --field "build/$1/made"/crspf_*.deb Architecture) == "$2" ]]
    tests/checks/lint.sh "build/$1/made"/crspf_*.deb
}

# digests_on_arm [--demo]
digests_on_arm() {
    toolchains/sysroot.sh arm64
    toolchains/sysroot.sh armhf
    tests/digests.sh "$@" release aarch64 armhf
}

clang_tidy() {
    cmake --preset clang
    tools/checks/tidy.py build/clang "$@"
}

# fuzz_one TARGET: new finds go to a folder of their own; the committed corpus stays as it is.
fuzz_one() {
    local name corpus status=0
    name=$(basename "$1")
    corpus=$(mktemp -d)
    "$1" -max_total_time="${CRSPF_FUZZ_SECONDS:-60}" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
        -artifact_prefix="$logs/$name-" "$corpus" "tests/fuzz/corpus/$name" >"$logs/$name.log" 2>&1 || status=$?
    rm -rf "$corpus"
    echo "--- $name"
    grep -E '^stat::(number_of_executed_units|average_exec_per_sec)|ERROR|SUMMARY|panic' "$logs/$name.log" || true
    return $status
}

fuzz() {
    cmake --preset fuzz
    cmake --build --preset fuzz -- -j "$jobs"
    export -f fuzz_one
    export logs
    find build/fuzz/tests/fuzz -maxdepth 1 -name 'fuzz_*' -type f -executable | sort |
        xargs -P "$jobs" -I {} bash -c 'fuzz_one "$1"' - {}
}

case $mode in
    all | arm | vm) tools/setup.sh --all ;;
    *) tools/setup.sh --tests ;;
esac
if command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi

step format check_format
step layers tools/checks/layers.py
step words tools/checks/words.py
[[ $mode != all ]] || step demo tools/demo.sh  # before there is a build, it makes its own
step release build_and_test release  # headers compile alone and the core's symbols are checked in here, too
if [[ $mode == normal || $mode == all ]]; then
    drives=ON
    if [[ $mode == normal ]]; then
        step demo tools/demo.sh
        step demo-on-arm digests_on_arm --demo
        drives=OFF
    fi
    step asan-ubsan build_and_test asan-ubsan -DCRSPF_DRIVES=$drives
    step clang-tidy clang_tidy core drivers
fi
if [[ $mode == all ]]; then
    step no-opencv build_and_test no-opencv
    step tsan build_and_test tsan
    step clang build_and_test clang
    step dev build_and_test dev
    step clang-tidy-rest clang_tidy config platform tools tests
    step digests tests/digests.sh
    step documents tests/checks/docs.py --long build/release/{tools/crspf/crspf,platform/crspfd/crspfd,tests/vm/live_robot}
    step package tests/checks/package.sh build/release
    step fuzz fuzz
    step soak tests/soak/soak.sh build/release 30
fi
if [[ $mode == vm || $mode == all ]]; then
    step vm tests/vm/ring.sh build/release
fi
if [[ $mode == arm || $mode == all ]]; then
    step aarch64 arm aarch64 arm64
    step aarch64-vm tests/vm/ring.sh build/aarch64
    step armhf arm armhf armhf
    step digests-on-arm digests_on_arm
fi

echo
echo "passed: ${passed[*]:-none}"
if ((${#failed[@]} > 0)); then
    echo "FAILED: ${failed[*]}   (logs in $logs)"
fi
echo "${#passed[@]} steps passed, ${#failed[@]} failed in $SECONDS s"
((${#failed[@]} == 0))
