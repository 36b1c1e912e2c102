#!/usr/bin/env bash
# `crspf export` of a simulated capture, its MCAP file read by another program: checksums, channels, poses. A damaged byte
# is refused. The CARMEN log of the same capture is the run again.
#   mcap.sh CRSPF
# Needs node, zstd and npm's @mcap/core; says so and ends with 77 where they are absent.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
crspf=$1
source "$here/npm.sh"
need_packages @mcap/core
command -v zstd >/dev/null || skip 'zstd is absent'

folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$crspf" sim --world office --duration 25 --capture "$folder/sim/run.pcapng" --out "$folder/sim" >/dev/null
run=$folder/sim/run.pcapng
"$crspf" export "$run" --mcap "$folder/run.mcap" --tum "$folder/run.tum" --carmen "$folder/run.clf" >"$folder/said"
grep -q "written: .*run.mcap, .*run.tum" "$folder/said"
node "$here/mcap.mjs" "$folder/run.mcap" "$folder/run.tum"

# The controls: in the middle of a chunk, of the index, of the messages' channel names.
size=$(stat -c %s "$folder/run.mcap")
for at in 3000 $((size / 2)) $((size - 200)); do
    cp "$folder/run.mcap" "$folder/damaged.mcap"
    byte=$(od -An -tu1 -j "$at" -N 1 "$folder/run.mcap")
    printf "\\x$(printf %02x $((byte ^ 1)))" | dd of="$folder/damaged.mcap" bs=1 seek="$at" conv=notrunc status=none
    if node "$here/mcap.mjs" "$folder/damaged.mcap" "$folder/run.tum" --bytes >/dev/null 2>&1; then
        echo "a damaged byte at $at of $size was not found" >&2
        exit 1
    fi
done
head -c $((size - 100)) "$folder/run.mcap" >"$folder/cut.mcap"
if node "$here/mcap.mjs" "$folder/cut.mcap" "$folder/run.tum" --bytes >/dev/null 2>&1; then
    echo "a file that is cut off was not found" >&2
    exit 1
fi

# The CARMEN log, played with the robot's own configuration.
"$crspf" export "$folder/run.clf" --config "$folder/sim/config.toml" --tum "$folder/again.tum" >/dev/null
python3 - "$folder/run.tum" "$folder/again.tum" <<'PY'
import math, sys
first, again = ([[float(v) for v in line.split()] for line in open(name)] for name in sys.argv[1:])
assert len(first) == len(again) > 50, (len(first), len(again))
far = max(math.dist(a[1:3], b[1:3]) for a, b in zip(first, again))
way = sum(math.dist(a[1:3], b[1:3]) for a, b in zip(first, first[1:]))
assert far < 0.03 < 0.5 < way, (far, way)
print(f"CARMEN log: {len(again)} scans again, {1000 * far:.1f} mm from the first run at most, over {way:.1f} m")
PY

# What cannot be done is said.
! "$crspf" export "$run" 2>"$folder/error"
grep -q -- "--mcap --tum --kitti --carmen --csv --svg --png --map --planning" "$folder/error"
! "$crspf" export "$folder/sim/world.yaml" --mcap "$folder/x.mcap" 2>"$folder/error"
grep -q "world.yaml: a map" "$folder/error"
"$crspf" export "$folder/sim/world.yaml" --planning "$folder/planning" >/dev/null
[[ -s $folder/planning.pgm && -s $folder/planning.yaml && ! -e $folder/x.mcap ]]
