#!/usr/bin/env bash
# The example of docs/motion-protocol.md sends what the decoder takes for the motion that it says.
# usage: motion_example.sh CRSPF REPOSITORY
set -euo pipefail
folder=$(mktemp -d)
recorder=
cleanup() {
    [[ -z $recorder ]] || kill -KILL "$recorder" 2>/dev/null || true
    rm -r "$folder"
}
trap cleanup EXIT
port=$(python3 -c 'import socket; s = socket.socket(type=socket.SOCK_DGRAM); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
cat >"$folder/robot.toml" <<TOML
[source.stereo]
driver = "motion"
port = "udp://127.0.0.1:$port"
TOML
sed -n '/^```python$/,/^```$/p' "$2/docs/motion-protocol.md" | grep -v '^```' | sed "s/7750/$port/" >"$folder/example.py"
grep -q "$port" "$folder/example.py"

"$1" record --config "$folder/robot.toml" --out "$folder/runs" --keep-free 1 2>"$folder/said" &
recorder=$!
listens=$(printf '0100007F:%04X ' "$port")
for _ in $(seq 400); do grep -q "$listens" /proc/net/udp && break; sleep 0.05; done
python3 "$folder/example.py"
kill -INT "$recorder"
wait "$recorder"
recorder=

"$1" inspect "$folder"/runs/*.pcapng --decode >"$folder/decoded"
python3 - "$folder/decoded" <<'PY'
import sys
lines = open(sys.argv[1]).read().splitlines()
told = [line.split("motion  ")[1].split("  +- ") for line in lines if "motion  " in line]
motions = [motion for motion, *_ in told]
assert all(len(t) == 2 for t in told[1:]), told
assert motions[0] == "0.0000 m, 0.0000 m, 0.000 deg", motions
assert len(motions) == 30 and set(motions[1:]) == {"0.0250 m, 0.0000 m, 0.000 deg"}, motions
assert "stereo: 30 records, samples 30" in lines, lines
PY
