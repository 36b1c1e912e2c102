#!/usr/bin/env bash
# Our DBC decoding against another program's, the npm package candied: the poses that we send, by config/crspf.dbc, what
# the simulated bases of the profiles say, by their DBC files, and a real car's log by its own, to the last bit.
set -euo pipefail

usage="usage: dbc_against_candied.sh CAN_DECODE SOURCE_DIR
  CAN_DECODE  the program of tests/checks/can_decode.cpp
Installs candied into \${XDG_CACHE_HOME:-~/.cache}/crspf/candied on its first run. Says 'skipped: ' with the reason, and
leaves with 77, where that cannot be. Looks for the car's log in \$CRSPF_DATA. Exit status 1 on any difference."
if (($# != 2)); then
    echo "$usage" >&2
    exit 2
fi
decode=$1
source=$2
version=2.2.0
cache=${XDG_CACHE_HOME:-$HOME/.cache}/crspf/candied

skip() {
    echo "skipped: $1"
    exit 77
}
command -v node >/dev/null || skip "node is not installed"
if [[ ! -d $cache/node_modules/candied ]]; then
    command -v npm >/dev/null || skip "npm is not installed"
    mkdir -p "$cache"
    npm install --silent --no-audit --no-fund --prefix "$cache" "candied@$version" >/dev/null 2>&1 ||
        skip "npm could not install candied $version"
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
compare() { node "$here/dbc_against_candied.js" "$cache/node_modules/candied" "$@"; }

"$decode" --poses >"$work/poses.log"
"$decode" "$source/config/crspf.dbc" "$work/poses.log" can0 >"$work/ours"
compare "$source/config/crspf.dbc" "$work/poses.log" can0 "$work/ours"

# Positive control: the same with one unit off in one value must be found.
awk 'NR == 777 { $3 += 1 } { print }' "$work/ours" >"$work/planted"
if compare "$source/config/crspf.dbc" "$work/poses.log" can0 "$work/planted" >/dev/null; then
    echo "FAILED: a planted difference was not found"
    exit 1
fi

# Not those with Motorola signals, which candied reads a bit off: 311#0403F2ED... is a LeftWay of 0x0403F2ED.
for pair in indoor_robot:canopen_402 sick_car:vw_mqb_wheels sick_canmod:canmod_gps; do
    "$decode" --base "$source/config/examples/${pair%:*}.toml" >"$work/base.log"
    "$decode" "$source/config/dbc/${pair#*:}.dbc" "$work/base.log" can0 >"$work/ours"
    compare "$source/config/dbc/${pair#*:}.dbc" "$work/base.log" can0 "$work/ours"
done

data=${CRSPF_DATA:-$source/../shared/data}/can
if [[ -f $data/car_imu.candump.log.xz ]] && command -v xz >/dev/null; then
    xz -dc "$data/car_imu.candump.log.xz" >"$work/car.log"
    "$decode" "$data/canmod-gps.dbc" "$work/car.log" can2 >"$work/ours"
    compare "$data/canmod-gps.dbc" "$work/car.log" can2 "$work/ours"
else
    echo "skipped: the car's log is absent; set CRSPF_DATA to its folder"
fi
