#!/usr/bin/env bash
# Makes the pictures of docs/how-it-works.md again, each by the program's own commands, which it prints, and the figures that
# stand beside them.
# usage: make.sh CRSPF [FOLDER [--short]]     into docs/pictures; one minute and a half
#   --short: runs of a few seconds, and not `crspf experiments match`, which takes half a minute: to see that the commands work
# Needs chromium and node for the two pictures of `crspf view`; says so where they are absent.
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
out=$(realpath "${2:-$here}")
short=${3:-}
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
cd "$work"

crspf() {
    printf '$ crspf %s\n' "$*"
    "$program" "$@" >said 2>&1 || { cat said >&2; exit 1; }
}
# spread RUN: what the filter made of its scans, medians.
spread() {
    crspf export "$1.pcapng" --csv "$1.csv"
    python3 - "$1.csv" "$1" <<'PY'
import csv, math, statistics, sys
rows = list(csv.DictReader(open(sys.argv[1])))[20:]
median = lambda value: statistics.median(map(value, rows))
def sigmas_mm(row):
    xx, xy, yy = (float(row[f"covariance_{axes}_m2"]) for axes in ("xx", "xy", "yy"))
    mean, spread = (xx + yy) / 2, math.hypot((xx - yy) / 2, xy)
    return [1000 * math.sqrt(max(mean + sign * spread, 0)) for sign in (1, -1)]
print(f"{sys.argv[2]}: M {median(lambda row: float(row['M'])):.0f}, search +-{1000 * median(lambda row: float(row['range_m'])):.0f} mm, "
      f"{median(lambda row: float(row['evaluations'])):.0f} evaluations, sigma {median(lambda row: sigmas_mm(row)[0]):.1f} mm and across "
      f"{median(lambda row: sigmas_mm(row)[1]):.1f} mm; one direction unseen in {sum(row['degenerate'] == '1' for row in rows)} of {len(rows)} scans")
PY
}
office_s=120 office_at_s=40 corridor_s=60 corridor_at_s=30
if [[ $short == --short ]]; then
    office_s=12 office_at_s=6 corridor_s=8 corridor_at_s=4
fi

# Drift: an office with three people, wheels that tell 2 % too much; by odometry alone, and matched.
crspf sim --world office --lidar urg --robot differential --people 3 --odom-scale-error 0.02 --duration $office_s --seed 1 \
    --out office --capture office.pcapng
cat - office/config.toml >odometry_alone.toml <<'TOML'
# The pose is the odometry's, and each scan is drawn there.
[particle_filter]
range_min_m = 0.0001
range_max_m = 0.0001
angle_min_deg = 0.001
angle_max_deg = 0.001
range_stddevs = 0.0
evaluations_max = 1
refinement = false
degeneracy = false

[analyser]
draw_on = 0.0
draw_off = 0.0

TOML
crspf export office.pcapng --config odometry_alone.toml --svg "$out/drift-odometry.svg" --tum odometry.tum
crspf export office.pcapng --svg "$out/drift-matched.svg" --tum matched.tum
for each in odometry matched; do
    crspf eval ate $each.tum office/truth.tum
    tail -n 1 said
done

# Critical rays of single scans.
crspf experiments rays --out rays
cp rays/rays-lms.svg rays/rays-office.svg "$out"

# M, its thresholds, and what follows from it.
if [[ $short == --short ]]; then
    crspf experiments --list
    grep -q '^ *match ' said
else
    crspf experiments match --out match
    cp match/match-carried.svg match/match-feedback.svg "$out"
fi

# How far the particles spread: in rooms, and where only shallow doors tell how far along a corridor the robot is.
crspf sim --world corridor --lidar urg --max-range 5 --speed 1.5 --duration $corridor_s --seed 1 --out corridor --capture corridor.pcapng
spread office
spread corridor

# The operator's page.
for each in chromium node; do
    command -v "$each" >/dev/null || { echo "skipped: $each is absent, and with it the pictures of crspf view"; exit 0; }
done
page() {
    printf '$ node docs/pictures/page.mjs crspf %s\n' "$*"
    node "$here/page.mjs" "$program" "$@"
}
page office.pcapng $office_at_s "$out/view-scan.png" 760x520 1.4
page corridor.pcapng $corridor_at_s "$out/view-cells.png" 760x420 4 --no-scan
