#!/usr/bin/env bash
# `crspf doctor` from outside: a sensor that is not there fails it and is named; as JSON; wrong words; a wrong file.
# usage: doctor.sh CRSPF
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# expect STATUS ARGUMENTS...: what it printed is left in out and said.
expect() {
    local wanted=$1 status=0
    shift
    "$crspf" doctor "$@" >"$folder/out" 2>"$folder/said" || status=$?
    if ((status != wanted)); then
        echo "doctor $*: exit status $status, not $wanted"
        cat "$folder/out" "$folder/said"
        exit 1
    fi
}
crspf=$1

cat >"$folder/robot.toml" <<TOML
[source.lidar]
driver = "scip"
port = "$folder/no_such_tty"
TOML
expect 1 --config "$folder/robot.toml"
grep -q "^failure .*source lidar .*$folder/no_such_tty: No such file" "$folder/out"
grep -q 'checks failed' "$folder/said"

expect 1 --config "$folder/robot.toml" --json
python3 - "$folder/out" <<'PY'
import json, sys
checks = {check["name"]: check for check in json.load(open(sys.argv[1]))["checks"]}
assert checks["source lidar"]["verdict"] == "failure" and checks["source lidar"]["remedy"], checks
assert set(checks["kernel"]) == {"name", "verdict", "found", "remedy"}, checks
assert all(bool(check["remedy"]) == (check["verdict"] != "ok") for check in checks.values()), checks
PY

expect 2 --no-such-option
echo 'nonsense' >"$folder/robot.toml"
expect 1 --config "$folder/robot.toml"
grep -q "$folder/robot.toml:1:" "$folder/said"
