#!/usr/bin/env bash
# `crspf inspect` against a recording whose content is known, a part of it, and a file that is none.
# usage: inspect.sh WRITE_SAMPLE_PCAPNG CRSPF
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$1" "$folder/whole.pcapng"
head -c -20 "$folder/whole.pcapng" >"$folder/cut.pcapng"
echo 'no recording at all' >"$folder/other"

"$2" inspect "$folder/whole.pcapng" "$folder/cut.pcapng" --json >"$folder/seen.json"
python3 - "$folder/seen.json" <<'PY'
import json, sys
whole, cut = json.load(open(sys.argv[1]))
front, can0, rear = whole["sources"]
assert whole["format"] == "pcapng" and whole["records"] == 4 and not whole["cut_short"], whole
assert whole["comment"] == "the configuration"
assert [s["name"] for s in whole["sources"]] == ["front", "can0", "rear"]
flow, = front["flows"].items()
assert flow[0] == "192.168.1.201:2368 -> 255.255.255.255:2369, 5 bytes" and flow[1]["records"] == 1, flow
assert set(can0["flows"]) == {"18FEF100", "123"} and can0["sent"] == 1, can0
assert abs(can0["longest_gap_s"] - 1e-9) < 1e-12, can0
assert rear["bytes"] == 5 and "flows" not in rear, rear
assert cut["cut_short"] and cut["records"] == 3, cut
PY
"$2" inspect "$folder/whole.pcapng" >"$folder/said"
grep -q 'rear (bytes)' "$folder/said"
if "$2" inspect "$folder/other" 2>"$folder/error"; then
    echo 'a file that is no recording passed'
    exit 1
fi
grep -q "$folder/other: " "$folder/error"
