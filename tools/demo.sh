#!/usr/bin/env bash
# From a bare Debian 12 to a map: installs, builds, drives a simulated robot through an office, records what its lidar
# and its wheels say on their lines, maps it from these bytes, and measures the result against the truth. Everything
# lands in out/demo.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
if command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
preset=demo
[[ ! -f build/release/build.ninja ]] || preset=release  # where there is a build, there need not be another
echo "demo: building (build/$preset)"
cmake --preset "$preset" --log-level=WARNING >/dev/null
cmake --build --preset "$preset" --target crspf

crspf() {
    printf '\n$ crspf %s\n' "$*"
    "build/$preset/tools/crspf/crspf" "$@"
}
rm -rf out/demo
mkdir -p out/demo
crspf sim --world office --lidar urg --robot differential --seed 1 --out out/demo/sim --capture out/demo/run.pcapng
crspf inspect out/demo/run.pcapng
crspf replay out/demo/run.pcapng --out out/demo/replay
crspf eval ate out/demo/replay/trajectory.tum out/demo/sim/truth.tum
# The robot's map begins where it stood; it looked along x there.
start=$(head -n 1 out/demo/sim/truth.tum | awk '{ printf "%s,%s,0", $2, $3 }')
crspf eval map out/demo/replay/map.yaml out/demo/sim/world.yaml --initial "$start"

printf '\nThe map: %s\n' "$PWD/out/demo/replay/map.png"
