#!/usr/bin/env bash
# `crspf record` from outside: sensors that are not there, the end by duration and by Ctrl-C, a directory that cannot be.
# usage: record.sh CRSPF
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cat >"$folder/robot.toml" <<TOML
[source.lidar]
driver = "scip"
port = "$folder/no_such_tty"

[source.base]
driver = "can"
port = "nocan0"
record_only = true
TOML

"$1" record --config "$folder/robot.toml" --out "$folder/runs" --duration 0.5 --keep-free 1 2>"$folder/said"
grep -q 'lidar: 0 records' "$folder/said"
grep -q 'base: 0 records' "$folder/said"

"$1" record --config "$folder/robot.toml" --out "$folder/runs" --keep-free 1 2>"$folder/said" &
recorder=$!
# Not sooner: bash starts it with Ctrl-C ignored, and it would record for ever.
for _ in $(seq 400); do grep -q 'recording into' "$folder/said" && break; sleep 0.05; done
kill -INT "$recorder"
wait "$recorder"
grep -q 'no_such_tty: No such file' "$folder/said" || grep -q 'starting' "$folder/said"

touch "$folder/file"
if "$1" record --config "$folder/robot.toml" --out "$folder/file" --duration 0.5 2>"$folder/said"; then
    echo 'a file passed for a directory'
    exit 1
fi
grep -q "$folder/file: " "$folder/said"
