#!/usr/bin/env bash
# What crspf view and those who look cost the service: crspfd runs on a simulated robot in real time, in turns with nobody
# and with `crspf view` and three headless browsers, each with the page open. Of each period: the filter's latency, from a
# scan's reception to its pose, as `crspf ctl status` tells it, and how busy the processors were.
# usage: view_load.sh BUILD_DIRECTORY [SECONDS [PAIRS [ALONE]]]
#   SECONDS  of each period with viewers, default 120
#   PAIRS    of periods, default 5
#   ALONE    seconds of each period without, default SECONDS
# Root's rights are for SCHED_FIFO.
#
# The browsers draw on the same processors as the service, which those of an operator do not: what is measured is the worst
# case. Under SCHED_FIFO they cannot keep a thread of the service from running, but they take caches and memory's bandwidth
# away, make interrupts, and keep processors awake that would sleep: with them a latency may well be shorter.
set -euo pipefail
((EUID == 0)) || exec sudo --non-interactive "$0" "$@"
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
build=$(realpath "$1")
seconds=${2:-120}
pairs=${3:-5}
alone=${4:-$seconds}
settle=5  # seconds, after which processor time is counted; latencies are from the empty map on
viewers=3
crspf=$build/tools/crspf/crspf
for program in chromium node python3; do
    command -v "$program" >/dev/null || { echo "no $program; tools/setup.sh --tests installs chromium and python3" >&2; exit 1; }
done

folder=$(mktemp -d)
robot='' service='' view='' browsers=''
cleanup() {
    for each in $browsers $view $service $robot; do kill "$each" 2>/dev/null || true; done
    wait
    rm -rf "$folder"
}
trap cleanup EXIT
# give_up WHAT FILE: what went wrong, and what was said there.
give_up() { echo "view_load: FAILED: $1" >&2; cat "$2" >&2; exit 1; }
# said WORDS FILE: waits for them.
said() {
    for _ in $(seq 600); do grep -q "$1" "$2" && return; sleep 0.1; done
    return 1
}
ctl() { "$crspf" ctl --socket "$folder/control" "$@"; }
# ticks PID: of processor time, of all its threads.
ticks() { awk '{ print $14 + $15 }' "/proc/$1/stat"; }
# used: of the machine, ticks that were used and all.
used() { awk '/^cpu / { for (i = 2; i <= 9; i++) all += $i; print all - $5 - $6, all }' /proc/stat; }

base=udp://127.0.0.1:$(python3 -c 'import socket; s = socket.socket(type=socket.SOCK_DGRAM); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
mkfifo "$folder/words"
# Sensors are hardware, they do not wait for the service's processor.
chrt --fifo 80 "$build/tests/vm/live_robot" "$folder/tty" "$base" <>"$folder/words" >/dev/null &
robot=$!
{
    printf '[service]\ncontrol_socket = "%s/control"\nstate_directory = "%s/state"\n\n' "$folder" "$folder"
    "$build/tests/vm/live_robot" --config "$folder/tty" "$base"
} >"$folder/robot.toml"
"$build/platform/crspfd/crspfd" --config "$folder/robot.toml" --allow-degraded >"$folder/service" 2>&1 &
service=$!
for _ in $(seq 100); do [[ -S $folder/control ]] && break || sleep 0.1; done
[[ -S $folder/control ]] || give_up 'crspfd does not start' "$folder/service"

# period NAME SECONDS: begins with an empty map and counters at 0.
period() {
    local seconds=$2 before after view_before=0 view_after=0 service_before service_after
    ctl reset >/dev/null
    sleep "$settle"
    [[ -z $view ]] || view_before=$(ticks "$view")
    service_before=$(ticks "$service")
    before=$(used)
    sleep "$seconds"
    after=$(used)
    service_after=$(ticks "$service")
    [[ -z $view ]] || view_after=$(ticks "$view")
    ctl status --json >"$folder/status"
    kill -0 "$service" || give_up 'crspfd is gone' "$folder/service"
    python3 - "$folder" "$1" "$seconds" "$(getconf CLK_TCK)" $((view_after - view_before)) \
        $((service_after - service_before)) "$before $after" <<'PY'
import json, sys
folder, name = sys.argv[1:3]
seconds, hz, view, service, used_before, before, used, after = map(float, " ".join(sys.argv[3:]).split())
status = json.load(open(folder + "/status"))
status = status.get("result", status)
thread = next(thread for thread in status["threads"] if thread["name"] == "filter")
period = {"name": name, "p999_ms": thread["p999_below_us"] / 1000, "view": 100 * view / hz / seconds, "fifo": status["realtime"]["sched_fifo"]}
with open(folder + "/periods", "a") as file:
    file.write(json.dumps(period) + "\n")
print(f"{name:8} latency: 50% below {thread['median_below_us'] / 1000:.3f} ms, 99.9% below {period['p999_ms']:.3f} ms, "
      f"max {thread['max_us'] / 1000:.3f} ms; missed {thread['misses']}, scans {status['filter']['scans']}, "
      f"skipped {status['filter']['skipped']}; of a core: view {period['view']:.1f} %, crspfd {100 * service / hz / seconds:.1f} %; "
      f"processors busy {100 * (used - used_before) / (after - before):.0f} %", flush=True)
PY
}

for _ in $(seq "$pairs"); do
    period alone "$alone"
    "$crspf" view --socket "$folder/control" --port 0 >"$folder/view" 2>&1 &
    view=$!
    said '^foxglove' "$folder/view" || give_up 'crspf view does not start' "$folder/view"
    node "$here/viewers.mjs" "$(sed -n 's/^page *//p' "$folder/view")" "$viewers" >"$folder/viewers" 2>&1 &
    browsers=$!
    said '^seen' "$folder/viewers" || give_up 'the map does not appear' "$folder/viewers"
    period watched "$seconds"
    kill -TERM "$browsers"
    wait "$browsers" || give_up 'a page lost the map or complains' "$folder/viewers"
    browsers=
    kill -TERM "$view"
    wait "$view" || give_up 'crspf view does not end well' "$folder/view"
    view=
done

python3 - "$folder/periods" "$seconds" "$alone" <<'PY'
import json, statistics, sys
periods = [json.loads(line) for line in open(sys.argv[1])]
p999_ms = {name: [period["p999_ms"] for period in periods if period["name"] == name] for name in ("alone", "watched")}
middle_ms = {name: statistics.median(values) for name, values in p999_ms.items()}
print(f"filter, 99.9% below, median of {len(p999_ms['alone'])} periods: alone, of {sys.argv[3]} s, {middle_ms['alone']:.3f} ms, "
      f"watched, of {sys.argv[2]} s, {middle_ms['watched']:.3f} ms, ratio {middle_ms['watched'] / middle_ms['alone']:.2f}; "
      f"in the worst period {max(p999_ms['alone']):.3f} and {max(p999_ms['watched']):.3f} ms")
view = statistics.mean(period["view"] for period in periods if period["name"] == "watched")
print(f"crspf view with three viewers: {view:.1f} % of a core")
if min(map(float, sys.argv[2:4])) < 100:
    print("(ten scans a second: of fewer than 1000 the slowest is the 99.9 %; periods of 100 s and more tell more)")
if not all(period["fifo"] for period in periods):
    print("(without SCHED_FIFO: it was not to be had)")
PY
