#!/usr/bin/env bash
# The alerts for Prometheus: their metrics are those of crspf view on a running service, promtool reads them, each fires
# where it should, and none for a robot that is well. Each check first has to fail on a planted fault.
#   alerts.sh CRSPF CRSPFD LIVE_ROBOT SOURCE_DIRECTORY
# Says 'skipped: ' and leaves with 77 where promtool is absent.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
crspf=$1
crspfd=$2
live_robot=$3
rules=$4/config/prometheus/crspf-alerts.yml
source "$here/free_port.sh"
folder=$(mktemp -d)
running=()
cleanup() {
    kill -KILL "${running[@]}" 2>/dev/null || true
    wait 2>/dev/null
    rm -rf "$folder"
}
trap cleanup EXIT
fail() {
    echo "FAILED: $*" >&2
    tail -n 20 "$folder"/said_* >&2
    exit 1
}

# --- names: of all that a service with a bus and a recording tells
base=udp://127.0.0.1:$(free_port SOCK_DGRAM)
{
    "$live_robot" --config "$folder/tty" "$base"
    printf '\n[service]\ncontrol_socket = "%s"\nstate_directory = "%s"\n' "$folder/control" "$folder/state"
    printf 'record_directory = "%s/runs"\n[pose_output]\ncan = "nocan0"\n' "$folder"
} >"$folder/robot.toml"
mkfifo "$folder/words"
"$live_robot" "$folder/tty" "$base" <>"$folder/words" >"$folder/said_robot" 2>&1 &
running+=($!)
"$crspfd" --config "$folder/robot.toml" --allow-degraded >"$folder/said_service" 2>&1 &
running+=($!)
"$crspf" view --socket "$folder/control" --port 0 >"$folder/said_view" 2>&1 &
running+=($!)
fetch() {
    local url
    url=$(sed -n 's/^page *//p' "$folder/said_view")
    [[ -n $url ]] && python3 -c 'import sys, urllib.request
print(urllib.request.urlopen(sys.argv[1]).read().decode())' "$url/metrics" >"$folder/metrics" 2>/dev/null &&
        grep -q '^crspf_pose_age_seconds ' "$folder/metrics"
}
for _ in $(seq 300); do fetch && break || sleep 0.2; done
grep -q '^crspf_pose_age_seconds ' "$folder/metrics" || fail 'no scan in /metrics'
python3 "$here/alerts.py" names "$rules" "$folder/metrics"
# planted SED: the rules with a fault.
planted() {
    sed "$1" "$rules" >"$folder/crspf-alerts.yml"
    ! cmp -s "$rules" "$folder/crspf-alerts.yml" || fail "nothing was planted: $1"
}
for fault in 's/crspf_pose_lost == 1/crspf_pose_loss == 1/' 's/stale|blind/stale|asleep/' 's/docs.service.md, Maps/there/' \
    's/service.md, Maps/service.md, Mops/'; do
    planted "$fault"
    ! python3 "$here/alerts.py" names "$folder/crspf-alerts.yml" "$folder/metrics" >/dev/null || fail "passed: $fault"
done

# --- what they do
command -v promtool >/dev/null || { echo 'skipped: promtool is absent (tools/setup.sh --all)'; exit 77; }
python3 "$here/alerts.py" firing "$rules" >"$folder/firing.yml"
cp "$here/alerts_test.yml" "$folder"
in_folder() { (cd "$folder" && promtool "$@"); }
planted 's/expr: crspf_up == 0/expr: crspf_up === 0/'
! in_folder check rules crspf-alerts.yml >/dev/null 2>&1 || fail 'an expression that is none passed'
planted 's/crspf_map_problem == 1/crspf_map_problem == 2/'
! in_folder test rules firing.yml >/dev/null 2>&1 || fail 'an alert that never fires passed'
planted 's/increase(crspf_view_mistakes_total\[10m\]) > 20/increase(crspf_view_mistakes_total[10m]) > 2/'
! in_folder test rules alerts_test.yml >/dev/null 2>&1 || fail 'an alert for a robot that is well passed'
cp "$rules" "$folder"
in_folder check rules crspf-alerts.yml
in_folder test rules firing.yml alerts_test.yml
