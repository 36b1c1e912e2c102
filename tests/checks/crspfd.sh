#!/usr/bin/env bash
# The service's process from outside: its start and what it tells systemd, `crspf ctl`, its end, a kill and a restart.
# usage: crspfd.sh CRSPFD CRSPF
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
crspfd=$1
crspf=$2
folder=$(mktemp -d)
service=
cleanup() {
    [[ -z $service ]] || kill -KILL "$service" 2>/dev/null || true
    rm -r "$folder"
}
trap cleanup EXIT
fail() {
    echo "$*" >&2
    cat "$folder"/said* >&2
    exit 1
}

sed "s|FOLDER|$folder|" "$here/no_sensors.toml" >"$folder/robot.toml"

ctl() {
    "$crspf" ctl --socket "$folder/control" "$@"
}
# ctl_says TEXT ARGUMENT...: not by a pipe, whose early end would be the tool's failure.
ctl_says() {
    local text=$1
    shift
    ctl "$@" >"$folder/said_ctl"
    grep -q "$text" "$folder/said_ctl" || fail "crspf ctl $*: no $text"
}
start() {
    rm -f "$folder/notify"
    # Stands in for systemd: what is notified, a line each.
    python3 - "$folder/notify" >"$folder/notified" <<'PY' &
import socket, sys
s = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
s.bind(sys.argv[1])
s.settimeout(20)
try:
    while True:
        text = s.recv(4096).decode()
        print(text, flush=True)
        if "STOPPING=1" in text:
            break
except TimeoutError:  # it was killed
    pass
PY
    for _ in $(seq 100); do [[ -S $folder/notify ]] && break || sleep 0.05; done
    NOTIFY_SOCKET=$folder/notify "$crspfd" --config "$folder/robot.toml" --allow-degraded 2>"$folder/said" &
    service=$!
    for _ in $(seq 200); do grep -q READY=1 "$folder/notified" && return; sleep 0.05; done
    fail 'it was not ready in time'
}

"$crspfd" --config "$folder/robot.toml" --check >"$folder/said_check"
grep -q 'are good' "$folder/said_check"
! "$crspfd" --config "$folder/nowhere.toml" 2>"$folder/said_nowhere" || fail 'a missing configuration passed'
grep -q 'nowhere.toml' "$folder/said_nowhere"
! ctl status 2>"$folder/said_alone" || fail 'nobody answered'
grep -q 'does crspfd run?' "$folder/said_alone"

start
ctl status --json >"$folder/status"
python3 - "$folder/status" <<'PY'
import json, sys
status = json.load(open(sys.argv[1]))
assert status["version"] == 1
assert status["pose"]["lost"] is True, "a pose without sensors"
assert [s["name"] for s in status["sources"]] == ["base", "lidar"]
assert all(s["state"] in ("starting", "failed") for s in status["sources"])
assert "no_such_tty" in status["sources"][1]["says"]
assert {t["name"] for t in status["threads"]} == {"rx-base", "rx-lidar", "odometry", "filter", "map", "output"}
assert all(t["alive"] for t in status["threads"])
PY
python3 - "$folder/control" <<'PY'
import json, socket, sys
peer = socket.socket(socket.AF_UNIX)
peer.settimeout(20)
peer.connect(sys.argv[1])
lines = peer.makefile("rw")
lines.write('{"version": 1, "command": "watch"}\n')
lines.flush()
assert json.loads(lines.readline()) == {"version": 1, "ok": True, "result": {}}
missing = {"ready", "status", "tiles"}
while missing:
    event = json.loads(lines.readline())
    assert event["version"] == 1
    if event["event"] == "status":
        assert event["status"]["pose"]["lost"] is True
    if event["event"] == "tiles":
        assert event["fresh"] is True and event["tiles"] == [], "tiles without a sensor"
    missing.discard(event["text"] if event["event"] == "log" else event["event"])
PY
ctl_says 'rx-lidar' status
ctl_says done set-pose 1.5 -2 90
ctl_says done log-level debug
"$crspf" top --once --socket "$folder/control" >"$folder/top"
grep -q 'LOST' "$folder/top" || fail 'top does not say that the pose is lost'
grep -q '^lidar .*no_such_tty' "$folder/top" || fail 'top does not say what is wrong with the lidar'
! ctl relocalize >"$folder/said_search" 2>&1 || fail 'a robot without a lidar was found'
grep -q 'no scan has come' "$folder/said_search"
! ctl set-pose 1e9 0 0 2>"$folder/said_far" || fail 'a pose beyond the world passed'
grep -q 'x \[m\], y \[m\], heading \[deg\]' "$folder/said_far"
map=$(ctl save-map --json | python3 -c 'import json, sys; print(json.load(sys.stdin)["path"])')
[[ -f $map && -f ${map%.yaml}.pgm ]] || fail 'no map'
! "$crspfd" --config "$folder/robot.toml" --allow-degraded 2>"$folder/said_second" || fail 'two services at one socket'
grep -q 'another service listens there' "$folder/said_second"
for _ in $(seq 100); do grep -q WATCHDOG=1 "$folder/notified" && break; sleep 0.05; done
grep -q WATCHDOG=1 "$folder/notified" || fail 'the watchdog was not fed'

kill -TERM "$service"
wait "$service" || fail 'it did not end well'
grep -q STOPPING=1 "$folder/notified"
grep -q 'stopped, map saved' "$folder/said"
[[ ! -e $folder/control ]] || fail 'it left its socket'

start
kill -KILL "$service"
wait "$service" 2>/dev/null || true
start
ctl_says '"lost": true' pose --json
kill -INT "$service"
wait "$service" || fail 'it did not end well after a kill'
service=

# What was saved and has been damaged since is told of.
truncate -s -1 "$folder"/state/map-*.pgm
! "$crspfd" --config "$folder/robot.toml" --check 2>"$folder/said_damaged" || fail 'a damaged map passed'
grep -q 'is not what was saved' "$folder/said_damaged"
