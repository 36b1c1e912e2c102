#!/usr/bin/env bash
# crspf mqtt from end to end: crspfd on a simulated robot, mosquitto as the broker, mosquitto_sub as the subscriber, and
# npm's mqtt where it is (mqtt.mjs). Brokers and services go and come, refuse, and stand still.
#   mqtt.sh CRSPF CRSPFD LIVE_ROBOT SOURCE_DIRECTORY
# Says 'skipped: ' and leaves with 77 where the broker is absent.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
crspf=$1
crspfd=$2
live_robot=$3
source_directory=$4
source "$here/free_port.sh"
PATH=$PATH:/usr/sbin
for program in mosquitto mosquitto_sub mosquitto_passwd openssl python3; do
    command -v "$program" >/dev/null || { echo "skipped: $program is absent (tools/setup.sh --tests)"; exit 77; }
done
folder=$(mktemp -d)
chmod 711 "$folder"  # a broker that root starts runs as the user mosquitto
declare -A running=()
cleanup() {
    local each
    for each in "${running[@]}"; do
        kill -CONT "$each" 2>/dev/null || true
        kill -KILL "$each" 2>/dev/null || true
    done
    wait 2>/dev/null
    rm -rf "$folder"
}
trap cleanup EXIT
fail() {
    echo "FAILED: $*" >&2
    tail -n 30 "$folder"/said_* >&2
    exit 1
}
# start NAME COMMAND...: its words go to said_NAME, anew.
start() {
    local name=$1
    shift
    : >"$folder/said_$name"  # not only by the child: until that runs, the words of the one before would be read
    "$@" >"$folder/said_$name" 2>&1 &
    running[$name]=$!
}
# stop NAME SIGNAL: its exit status.
stop() {
    local status=0
    kill "-$2" "${running[$1]}"
    wait "${running[$1]}" 2>/dev/null || status=$?
    unset "running[$1]"
    return "$status"
}
# until_true WHAT COMMAND...: within a minute.
until_true() {
    local what=$1
    shift
    for _ in $(seq 300); do
        "$@" && return
        sleep 0.2
    done
    fail "not in time: $what"
}
said() { grep -qF -- "$2" "$folder/said_$1"; }
export ASAN_OPTIONS=quarantine_size_mb=1  # what is freed is gone, as in builds without a sanitizer
port=$(free_port SOCK_STREAM)
tls_port=$(free_port SOCK_STREAM)
cert_port=$(free_port SOCK_STREAM)
base=udp://127.0.0.1:$(free_port SOCK_DGRAM)

# --- a CA, a broker's certificate for localhost, a robot's, another CA that has signed another robot's
for ca in ca other; do
    openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj "/CN=$ca of a test" \
        -keyout "$folder/$ca.key" -out "$folder/$ca.pem" 2>/dev/null
done
# certificate NAME COMMON_NAME CA
certificate() {
    openssl req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj "/CN=$2" -keyout "$folder/$1.key" \
        -out "$folder/$1.csr" 2>/dev/null
    openssl x509 -req -in "$folder/$1.csr" -CA "$folder/$3.pem" -CAkey "$folder/$3.key" -CAcreateserial -days 2 \
        -extfile <(echo "subjectAltName=DNS:$2") -out "$folder/$1.pem" 2>/dev/null
}
certificate broker localhost ca
certificate robot forklift-7 ca
certificate stranger forklift-7 other
chmod a+r "$folder/broker.key"
printf 'right-password\n' >"$folder/password"
printf 'wrong-password\n' >"$folder/wrong"
chmod 600 "$folder/password" "$folder/wrong"
mosquitto_passwd -b -c "$folder/users" forklift right-password 2>/dev/null
chmod a+r "$folder/users"

cat >"$folder/broker.conf" <<CONF
log_type error
log_type warning
per_listener_settings true
listener $port 127.0.0.1
allow_anonymous true
listener $tls_port 127.0.0.1
allow_anonymous false
password_file $folder/users
certfile $folder/broker.pem
keyfile $folder/broker.key
listener $cert_port 127.0.0.1
require_certificate true
use_identity_as_username true
cafile $folder/ca.pem
certfile $folder/broker.pem
keyfile $folder/broker.key
CONF
listens() { (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; }
start_broker() {
    start broker mosquitto -c "$folder/broker.conf"
    until_true 'the broker listens' listens
}

# --- the robot
{
    "$live_robot" --config "$folder/tty" "$base"
    printf '\n[service]\ncontrol_socket = "%s"\nstate_directory = "%s"\n' "$folder/control" "$folder/state"
} >"$folder/robot.toml"
mkfifo "$folder/words"
start_robot() {
    # shellcheck disable=SC2016  # the inner shell's
    start robot sh -c 'exec "$0" "$1/tty" "$2" <>"$1/words"' "$live_robot" "$folder" "$base"
}
start_service() {
    start service "$crspfd" --config "$folder/robot.toml" --allow-degraded
}
publish() {
    local name=$1
    shift
    start "$name" "$crspf" mqtt --socket "$folder/control" "$@"
}
# kept TOPIC: what the broker has kept of it.
kept() { mosquitto_sub -p "$port" -t "crspf/$1" --retained-only -C 1 -W 2 2>/dev/null; }
is_kept() { [[ $(kept "$1") == *"$2"* ]]; }

# --- nobody there yet: it waits, and says so
publish mqtt --broker "127.0.0.1:$port" --robot seven --rate 20
until_true 'a broker that is absent is told of' said mqtt 'does the broker run there?'
until_true 'a service that is absent is told of' said mqtt 'does crspfd run?'
start_broker
until_true 'it connects when the broker comes' said mqtt "127.0.0.1:$port: connected"
until_true 'it is online' is_kept seven/online true
until_true 'the service is away' is_kept seven/health '"state":"Service away","service":false'

# --- pose, health and map
start_robot
start_service
until_true 'the robot tracks' is_kept seven/health '"state":"Tracking","service":true'
until_true 'its scans match well' is_kept seven/health '"result":true'
until_true 'there is a map' is_kept seven/map '"encoding":"zlib+base64"'
until_true 'there are tiles' is_kept 'seven/map/0/0' '"cells"'
mosquitto_sub -p "$port" -t 'crspf/seven/#' -F '%r %q %t %p' -W 8 >"$folder/heard" 2>/dev/null || true
python3 - "$folder/heard" <<'PY'
import base64, json, math, sys, zlib
heard = [line.rstrip("\n").split(" ", 3) for line in open(sys.argv[1])]
def of(leaf): return [(r, json.loads(p)) for r, q, t, p in heard if t == "crspf/seven/" + leaf and p]
assert [p for r, p in of("online")] == [True] and of("online")[0][0] == "1"
poses = [p for r, p in of("pose")]
assert len(poses) > 10 and all(r == "0" for r, p in of("pose")), len(poses)
stamps = [p["stamp_ns"] for p in poses]
assert stamps == sorted(stamps) and len(set(stamps)) == len(stamps)
for p in poses:  # the circle of live_robot.hpp: never farther than its diameter
    assert math.hypot(p["x_m"], p["y_m"]) < 1.5 and abs(p["heading_deg"]) <= 180.0, p
    assert len(p["covariance"]) == 6 and isinstance(p["lost"], bool) and isinstance(p["matched"], bool), p
assert any(p["matched"] for p in poses) and not poses[-1]["lost"]
r, health = of("health")[0]
assert r == "1" and health["versions"]["status"] == 1 and health["versions"]["crspf"], health
assert {s["name"]: s["state"] for s in health["sensors"]} == {"lidar": "ok", "base": "ok"}, health
assert health["M"] > 500 and health["map"]["tiles"] > 0 and isinstance(health["counters"], dict), health
r, about = of("map")[0]
tiles = {t.split("/map/")[1]: json.loads(p) for r, q, t, p in heard if "/map/" in t and p}
assert len(tiles) > 3, tiles.keys()
taken = free = 0
for name, tile in tiles.items():
    column, row = map(int, name.split("/"))
    cells = zlib.decompress(base64.b64decode(tile["cells"]))
    side = about["side_cells"]
    assert len(cells) == side * side == 4096 and all(c <= 100 or c == about["unseen"] for c in cells)
    assert tile["map_id"] == about["map_id"]
    assert math.isclose(tile["x_m"], column * side * tile["resolution_m"], abs_tol=1e-9)
    assert math.isclose(tile["y_m"], row * side * tile["resolution_m"], abs_tol=1e-9)
    for i, c in enumerate(cells):
        if c <= 100 and c >= 50:
            taken += 1
            x = tile["x_m"] + (i % side + 0.5) * tile["resolution_m"]
            y = tile["y_m"] + (i // side + 0.5) * tile["resolution_m"]
            # the room's walls, those of the corner it lacks, and its pillar
            near = min(abs(x - 3), abs(x + 2), abs(y - 2.5), abs(y + 1.5), abs(math.hypot(x - 2, y + 0.5) - 0.2),
                       abs(x - 1.6) if y > 1.4 else 1, abs(y - 1.4) if x > 1.6 else 1)
            assert near < 0.3, (x, y)
        free += c < 50
assert taken > 50 and free > 2000, (taken, free)
print(f"{len(poses)} poses, {len(tiles)} tiles, {taken} cells taken, {free} free")
PY
# The words of the state are the page's.
python3 - "$source_directory" <<'PY'
import re, sys
ours = re.findall(r'return "([A-Z][^"]+)";', open(sys.argv[1] + "/tools/mqtt/robot_health.cpp").read())
ours += re.findall(r'\? "([A-Z][^"]+)" : "([A-Z][^"]+)"', open(sys.argv[1] + "/tools/mqtt/robot_health.cpp").read())[0]
page = open(sys.argv[1] + "/tools/view/page/view.js").read()
assert len(ours) == 7 and all(f'"{word}"' in page for word in ours), ours
# And so are the counters that should be 0.
pairs = re.findall(r'\{"(\w+)", "(\w+)"\},', open(sys.argv[1] + "/tools/view/troubles.cpp").read())
groups = re.search(r"TROUBLES = \{(.*?)\n\};", open(sys.argv[1] + "/tools/view/page/panel.js").read(), re.S)[1]
page = [(group, name) for group, names in re.findall(r"(\w+): \[(.*?)\]", groups) for name in re.findall(r'"(\w+)"', names)]
assert pairs and pairs == page, set(pairs) ^ set(page)
PY
export NODE_PATH=${CRSPF_NODE_MODULES:-${NODE_PATH:-}}
if command -v node >/dev/null && node -e 'require("mqtt")' 2>/dev/null; then
    node "$here/mqtt.mjs" "mqtt://127.0.0.1:$port" crspf/seven
else
    echo "skipped: the second subscriber, npm's mqtt, is not in \$CRSPF_NODE_MODULES"
fi

# --- the service goes and comes; a warning goes out
mosquitto_sub -p "$port" -t 'crspf/seven/log' -C 1 >"$folder/log" &
running[log]=$!
stop service KILL || true
until_true 'the end of the service is told' is_kept seven/health '"state":"Service away"'
rm -f "$folder/control"
start_service
until_true 'it is back' is_kept seven/health '"service":true'
stop robot KILL || true
until_true 'the lidar is missed' is_kept seven/health '"state":"LOST"'
until_true 'a warning goes out' test -s "$folder/log"
grep -q '"level":"\(warning\|error\)"' "$folder/log" || fail "no warning: $(cat "$folder/log")"
unset 'running[log]'
start_robot

# --- another map: what the broker has kept of the one before goes
old=$(kept seven/map)
until_true 'there are tiles' is_kept 'seven/map/0/0' '"cells"'
stop robot KILL || true
"$crspf" ctl --socket "$folder/control" reset >/dev/null
no_tiles() { [[ -z $(mosquitto_sub -p "$port" -t 'crspf/seven/map/+/+' --retained-only -C 1 -W 2 2>/dev/null) ]]; }
until_true 'the old tiles are gone' no_tiles
[[ $(kept seven/map) != "$old" ]] || fail 'the map has the id of the one before'
start_robot
until_true 'the new map comes' is_kept 'seven/map/0/0' '"cells"'

# --- the broker is killed, without what it had kept, and started again
stop broker KILL || true
until_true 'the loss is told' said mqtt 'the connection is lost'
start_broker
until_true 'it is online again' is_kept seven/online true
until_true 'its health is there again' is_kept seven/health '"service":true'
until_true 'its map is there again' is_kept 'seven/map/0/0' '"cells"'
[[ $(grep -c 'does the broker run there?' "$folder/said_mqtt") -le 3 ]] || fail 'it says the same again and again'

# --- the broker stands still: no memory, and it goes on afterwards
memory() { awk '$1 == "VmRSS:" { print $2 }' "/proc/${running[mqtt]}/status"; }
before=$(memory)
kill -STOP "${running[broker]}"
sleep 12
grown=$(($(memory) - before))
kill -CONT "${running[broker]}"
((grown < 2048)) || fail "it has grown by $grown KiB"
moves() { [[ -n $(mosquitto_sub -p "$port" -t crspf/seven/pose -C 1 -W 2 2>/dev/null) ]]; }
until_true 'poses come again' moves

# --- killed: the will. Ended: its own word.
stop mqtt KILL || true
until_true 'the will is executed' is_kept seven/online false
publish mqtt --broker "127.0.0.1:$port" --robot seven
until_true 'it is online' is_kept seven/online true
stop mqtt TERM || fail 'it does not end well'
is_kept seven/online false || fail 'it has not said goodbye'

# --- TLS and password: right, and each wrong in its own way
publish mqtt --broker "localhost:$tls_port" --robot tls --tls --ca "$folder/ca.pem" --user forklift --password-file "$folder/password"
until_true 'it connects by TLS' said mqtt "localhost:$tls_port: connected"
stop broker KILL || true
until_true 'the loss is told' said mqtt "localhost:$tls_port: the connection is lost"
start_broker
connected_again() { [[ $(grep -c connected "$folder/said_mqtt") == 2 ]]; }
until_true 'it connects by TLS again' connected_again
stop mqtt INT || fail 'it does not end well'
shown=(--cert "$folder/robot.pem" --key "$folder/robot.key")
publish mqtt --broker "localhost:$cert_port" --robot cert --tls --ca "$folder/ca.pem" "${shown[@]}"
until_true 'it connects by its certificate' said mqtt "localhost:$cert_port: connected"
stop mqtt INT || fail 'it does not end well'
# refused WORDS ARGUMENT...: it goes on trying, and says why.
refused() {
    local words=$1
    shift
    publish wrong "$@" --robot wrong
    until_true "$words" said wrong "$words"
    ! said wrong connected || fail "connected all the same: $*"
    stop wrong TERM || fail 'it does not end well'
}
login=(--user forklift --password-file "$folder/password")
refused "not signed by $folder/other.pem" --broker "localhost:$tls_port" --tls --ca "$folder/other.pem" "${login[@]}"
refused 'not signed by any that this machine trusts' --broker "localhost:$tls_port" --tls "${login[@]}"
refused 'certificate is for another host than 127.0.0.1' --broker "127.0.0.1:$tls_port" --tls --ca "$folder/ca.pem" "${login[@]}"
refused 'does it want --cert?' --broker "localhost:$cert_port" --tls --ca "$folder/ca.pem"
refused "does it know who signed $folder/stranger.pem?" --broker "localhost:$cert_port" --tls --ca "$folder/ca.pem" \
    --cert "$folder/stranger.pem" --key "$folder/stranger.key"
refused 'refuses the user forklift' --broker "localhost:$tls_port" --tls --ca "$folder/ca.pem" --user forklift --password-file "$folder/wrong"
refused 'refuses us without a user' --broker "localhost:$tls_port" --tls --ca "$folder/ca.pem"
refused 'one without TLS?' --broker "localhost:$tls_port"
refused 'no such host' --broker no-such-host.invalid
# ends_with WORDS STATUS ARGUMENT...: at once.
ends_with() {
    local words=$1 wanted=$2 status=0
    shift 2
    timeout 20 "$crspf" mqtt --socket "$folder/control" "$@" >"$folder/said_end" 2>&1 || status=$?
    [[ $status == "$wanted" ]] && said end "$words" || fail "$*: status $status"
}
chmod a+r "$folder/wrong"
ends_with 'everybody can read this secret; chmod o-r' 1 --broker localhost --user forklift --password-file "$folder/wrong"
ends_with 'PEM' 1 --broker "localhost:$tls_port" --tls --ca "$folder/robot.toml"
ends_with 'cannot be read' 1 --broker "localhost:$tls_port" --tls --ca "$folder/absent.pem"
ends_with 'cannot stand in a topic' 1 --broker localhost --robot a/b
ends_with 'is no UTF-8' 1 --broker localhost --robot $'\xff'
ends_with 'is no HOST[:PORT]' 1 --broker localhost:0
ends_with '--broker' 2 --robot nobody
ends_with 'requires --tls' 2 --broker localhost --ca "$folder/ca.pem"
echo 'mqtt: right'
