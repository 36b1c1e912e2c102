#!/usr/bin/env bash
# npm's @foxglove/ws-protocol, the protocol's own client, on crspf view.
#   foxglove.sh CRSPF
# Needs node and, in NODE_PATH or in $CRSPF_NODE_MODULES, the packages @foxglove/ws-protocol and ws
# (npm install --prefix FOLDER @foxglove/ws-protocol ws); says so and ends with 77 where they are absent.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
crspf=$1
export NODE_PATH=${CRSPF_NODE_MODULES:-${NODE_PATH:-}}
skip() {
    echo "skipped: $*"
    exit 77
}
command -v node >/dev/null || skip "node is absent"
node -e 'require("@foxglove/ws-protocol"); require("ws")' 2>/dev/null ||
    skip "the npm packages @foxglove/ws-protocol and ws are not in \$CRSPF_NODE_MODULES"

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
