#!/usr/bin/env bash
# One recording, one result: replays the same recordings with differently built programs and with each match kernel, and
# demands the same digest from all of them. As a control, another seed must give another digest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage="usage: tests/digests.sh [--demo] [PRESET...]
  Builds tests/replay/replay_digest by each preset of CMakePresets.json (default: release profile dev clang, which are
  g++ -O3 in few large units, -O2, -O0, and clang -O3) and compares. aarch64 and armhf run in qemu's user emulation;
  the first preset simulates, too. The logs are simulated runs of a planar lidar, as a log and as the demo's capture,
  and of a spatial one and, where it is found, intel.clf.xz of \$CRSPF_DATA/carmen.
  --demo  only the demo's capture"
demo=
case ${1:-} in
    -h | --help) echo "$usage"; exit 0 ;;
    --demo) demo=1; shift ;;
    -*) echo "$usage" >&2; exit 2 ;;
esac
presets=("$@")
((${#presets[@]} > 0)) || presets=(release profile dev clang)

kernels=(portable fastest)
grep -qw avx2 /proc/cpuinfo || echo "digests: this processor has no AVX2; its fastest kernel is the portable one"

first=${presets[0]}
for preset in "${presets[@]}"; do
    targets=(replay_digest)
    [[ $preset != "$first" ]] || targets+=(crspf)
    cmake --preset "$preset" --log-level=WARNING >/dev/null
    cmake --build --preset "$preset" --target "${targets[@]}"
done
crspf=build/$first/tools/crspf/crspf

out=out/digests
rm -rf "$out"
mkdir -p "$out"

# replay PRESET KERNEL RECORDING CONFIG: prints the digest.
replay() {
    local emulator=()
    case $1 in
        aarch64) emulator=(qemu-aarch64 -L build/sysroot/arm64) ;;
        armhf) emulator=(qemu-arm -L build/sysroot/armhf) ;;
    esac
    "${emulator[@]}" "build/$1/tests/replay/replay_digest" "$2" "$4" "$3"
}

failed=0
# told RECORDING CONFIG PRESET KERNEL: a line with the digest.
told() {
    local digest
    digest=$(replay "$3" "$4" "$1" "$2")
    printf '  %-8s %-8s %s\n' "$3" "$4" "$digest"
}
export -f replay told
# compare RECORDING CONFIG: by all presets and kernels, as many at a time as there are processors.
# shellcheck disable=SC2016  # the inner shell's
compare() {
    local lines
    echo "digests: $1"
    lines=$(
        for preset in "${presets[@]}"; do
            printf "$preset %s\n" "${kernels[@]}"
        done | xargs -P "$(nproc)" -L 1 bash -euc 'told "$@"' told "$1" "$2" | sort
    )
    echo "$lines"
    if [[ $(awk '{ print $3 }' <<<"$lines" | sort -u | wc -l) != 1 ]]; then
        echo '  ^ differ'
        failed=1
    fi
}

# As tools/demo.sh does.
sim_log=$out/sim/log.clf
sim_config=$out/sim/config.toml
capture=$out/run.pcapng
"$crspf" sim --world office --lidar urg --robot differential --seed 1 --out "$out/sim" --capture "$capture" >/dev/null
compare "$capture" "$sim_config"

# The control: were the digest blind to the result, it would not see the seed either.
other_config=$out/other_seed.toml
sed '/^ *seed *=/d' "$sim_config" >"$other_config"
if grep -q '^\[particle_filter\]' "$other_config"; then
    sed -i 's/^\[particle_filter\].*/&\nseed = 424242/' "$other_config"
else
    printf '\n[particle_filter]\nseed = 424242\n' >>"$other_config"
fi
if [[ $(replay "$first" portable "$capture" "$sim_config") == \
    $(replay "$first" portable "$capture" "$other_config") ]]; then
    echo "digests: control failed: another seed gives the same digest, so the comparison proves nothing"
    failed=1
else
    echo "digests: control: another seed gives another digest"
fi
[[ -z $demo ]] || exit $failed

compare "$sim_log" "$sim_config"

# What stands on the ground, from the packets of a spatial lidar.
obstacles_config=$out/obstacles.toml
"$crspf" sim --lidar velodyne --places 3 --out "$out/sim3d" --capture "$out/obstacles.pcapng" >/dev/null
sed 's/^driver *= *"velodyne"/&\nplanar = "obstacles"/' "$out/sim3d/config.toml" >"$obstacles_config"
grep -q '^planar' "$obstacles_config"
compare "$out/obstacles.pcapng" "$obstacles_config"

intel=${CRSPF_DATA:-../shared/data}/carmen/intel.clf.xz
if [[ -r $intel ]]; then
    compare "$intel" config/examples/intel.toml
else
    echo "digests: skipped: no $intel; set CRSPF_DATA to the folder of the recordings"
fi
exit $failed
