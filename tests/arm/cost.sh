#!/usr/bin/env bash
# What a scan costs on ARM boards, estimated without one: the instructions that `crspf replay` runs for the demo's
# capture, counted in qemu's user emulation, less those of its start. docs/arm.md says what follows from them, and how sure.
# usage: cost.sh    after tests/run.sh --arm, which builds the presets release, aarch64 and armhf
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=out/arm-cost
rm -rf "$out"
mkdir -p "$out"
build/release/tools/crspf/crspf sim --world office --lidar urg --robot differential --seed 1 --out "$out/sim" \
    --capture "$out/run.pcapng" >/dev/null

# count PRESET ARGUMENT...: the instructions of a run of crspf.
count() {
    local emulator
    case $1 in
        aarch64) emulator=(qemu-aarch64 -L build/sysroot/arm64) ;;
        armhf) emulator=(qemu-arm -L build/sysroot/armhf) ;;
        *) emulator=(qemu-x86_64 -cpu max) ;;
    esac
    "${emulator[@]}" -plugin build/release/tests/arm/libinstructions.so "build/$1/tools/crspf/crspf" "${@:2}" 2>&1 >"$out/stdout" |
        sed -n 's/^instructions: //p'
}

scans=$(grep -c . "$out/sim/truth.tum")
echo "instructions a scan ($scans scans), and time a scan at 1.5 GHz where a cycle has 0.7, 1.0, 1.5 of them"
for preset in release aarch64 armhf; do
    start=$(count "$preset" --version)
    for kernel in portable fastest; do
        all=$(count "$preset" replay "$out/run.pcapng" --kernel "$kernel" --out "$out/replay")
        awk -v name="$preset $kernel" -v each=$(((all - start) / scans)) \
            'BEGIN { printf "%-18s %9d   %.2f %.2f %.2f ms\n", name, each, each / 1.05e6, each / 1.5e6, each / 2.25e6 }'
    done
done
