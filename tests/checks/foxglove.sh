#!/usr/bin/env bash
# npm's @foxglove/ws-protocol, the protocol's own client, on crspf view.
#   foxglove.sh CRSPF
# Needs node and npm's @foxglove/ws-protocol and ws; says so and ends with 77 where they are absent.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
crspf=$1
source "$here/npm.sh"
need_packages @foxglove/ws-protocol ws

folder=$(mktemp -d)
view=
cleanup() {
    [[ -z $view ]] || kill -KILL "$view" 2>/dev/null || true
    rm -rf "$folder"
}
trap cleanup EXIT
"$crspf" sim --world office --lidar urg --robot differential --seed 1 --out "$folder/sim" --capture "$folder/run.pcapng" >/dev/null
"$crspf" view "$folder/run.pcapng" --port 0 >"$folder/said" 2>&1 &
view=$!
for _ in $(seq 600); do
    grep -q '^foxglove' "$folder/said" && break
    sleep 0.05
done
url=$(sed -n 's/^foxglove *//p' "$folder/said")
[[ -n $url ]] || { cat "$folder/said"; echo 'FAILED: crspf view does not start'; exit 1; }
node "$here/foxglove.mjs" "$url"
kill -TERM "$view"
wait "$view" || { cat "$folder/said"; echo 'FAILED: crspf view does not end well'; exit 1; }
view=
