#!/usr/bin/env bash
# What the service costs while none of its sensors is there: of one processor, in percent. Status 1 if it is 1 or more.
# usage: unplugged.sh CRSPFD [SECONDS]
set -euo pipefail
crspfd=$(realpath "$1")
seconds=${2:-20}
folder=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -r "$folder"' EXIT

# One source of each kind of port.
cat >"$folder/robot.toml" <<TOML
[service]
control_socket = "$folder/control"
state_directory = "$folder/state"

[source.lidar]
driver = "scip"
port = "$folder/no_such_tty"

[source.sick]
driver = "sick"
port = "tcp://127.0.0.1:9"  # nobody listens
record_only = true

[source.velodyne]
driver = "velodyne"
port = "udp://127.0.0.1:42368"  # nobody sends
record_only = true

[source.base]
driver = "can"
port = "nocan0"
dbc = "$(realpath "$(dirname "${BASH_SOURCE[0]}")/../../config/dbc/vw_mqb_wheels.dbc")"
[source.base.left]
signal = "ESP_19.SpeedRearLeft"
is_speed = true
[source.base.right]
signal = "ESP_19.SpeedRearRight"
is_speed = true

[pose_output]
can = "nocan1"
TOML

# ticks: of processor time, of the service and all its threads.
ticks() { awk '{ print $14 + $15 }' "/proc/$service/stat"; }

"$crspfd" --config "$folder/robot.toml" --allow-degraded 2>"$folder/said" &
service=$!
for _ in $(seq 100); do [[ -S $folder/control ]] && break || sleep 0.1; done
[[ -S $folder/control ]] || { cat "$folder/said" >&2; exit 1; }
before=$(ticks)
sleep "$seconds"
awk -v ticks=$(($(ticks) - before)) -v hz="$(getconf CLK_TCK)" -v seconds="$seconds" \
    'BEGIN { share = 100 * ticks / hz / seconds; printf "%.2f %% of a processor in %d s\n", share, seconds; exit share >= 1 }'
