# What the documents tell a user to do who may become root, sourced by guest.sh, whose robot and service it uses. Their
# blocks are documents/PHASE/DOCUMENT-LINE.sh; tests/checks/docs.py finds phases in here.

# by_keeper BLOCK: from a login of its own
by_keeper() { runuser --login keeper -c "bash -euo pipefail $1"; }
# documents PHASE
documents() {
    local block
    for block in documents/"$1"/*; do check "document ${block#documents/*/}" by_keeper "/ring/$block"; done
}

# --- a user, and what a machine has that was installed by hand
printf '%s\n' '127.0.1.1 robot' '127.0.0.1 broker.example' >>/etc/hosts
adduser --quiet --disabled-password --gecos '' keeper
mkdir ~keeper/bin ~keeper/.ssh /usr/local/as-root
# Ctrl-C after some seconds ends what has no end of its own; it must have said something. 27: mosquitto_sub's -W is over.
cat >~keeper/bin/candump <<'SHIM'
#!/bin/bash
timeout --foreground --preserve-status --signal=INT 15 "/usr/bin/${0##*/}" "$@" 2>&1 | tee "/tmp/$$"
status=${PIPESTATUS[0]}
[[ -s /tmp/$$ ]] || { echo "$0 says nothing"; exit 1; }
[[ $status == 130 || ${0##*/}:$status == mosquitto_sub:27 ]] || exit "$status"
SHIM
chmod +x ~keeper/bin/candump
ln -s candump ~keeper/bin/crspf
ln -s candump ~keeper/bin/mosquitto_sub
cp ~keeper/bin/candump /usr/local/as-root/journalctl
echo 'export SUDO_EDITOR=true' >>~keeper/.profile  # what it would write is there already
printf 'keeper ALL=(ALL) NOPASSWD: ALL\nDefaults secure_path="/usr/local/as-root:/usr/sbin:/usr/bin:/sbin:/bin"\n' \
    >/etc/sudoers.d/keeper
cp crspf.deb ~keeper/"crspf_1.0_$(dpkg --print-architecture).deb"
mkdir /dev/crspf
ln -s /run/robot/tty /dev/crspf/hokuyo  # udev's, for a real one
chmod a+rw "$(realpath /run/robot/tty)"

echo 'crspf ctl --socket /nowhere status | cat; true' >/tmp/planted
refused() { ! by_keeper "$1"; }
check 'a command that fails is seen' refused /tmp/planted

[[ $(dpkg --print-architecture) != arm64 ]] || documents arm64
documents sensors
cp ~keeper/runs/crspf-*.pcapng ~keeper/lidar.pcapng

# --- a broker
systemctl stop mosquitto
(
    cd ~keeper || exit 1
    key() { openssl req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout "$1.key" -subj "/CN=$1" "${@:2}" 2>/dev/null; }
    key ca -x509 -days 3650 -out ca.pem
    for name in broker.example forklift-7; do
        key "$name" -out "$name.csr"
        openssl x509 -req -in "$name.csr" -CA ca.pem -CAkey ca.key -CAcreateserial -days 3650 \
            -extfile <(echo "subjectAltName=DNS:$name") -out "$name.pem" 2>/dev/null
    done
    cp ca.pem /usr/local/share/ca-certificates/ring.crt
    cp ca.pem broker.example.pem broker.example.key /etc/mosquitto/certs
    update-ca-certificates
    mosquitto_passwd -b -c /etc/mosquitto/users forklift-7 secret
    chmod a+r /etc/mosquitto/users /etc/mosquitto/certs/*
    chown keeper: ./*
) >/dev/null
cat >/etc/mosquitto/conf.d/ring.conf <<'CONF'
per_listener_settings true
listener 1883
allow_anonymous true
listener 8883
allow_anonymous true
password_file /etc/mosquitto/users
cafile /etc/mosquitto/certs/ca.pem
certfile /etc/mosquitto/certs/broker.example.pem
keyfile /etc/mosquitto/certs/broker.example.key
CONF
install -m 640 -g crspf <(echo secret) /etc/crspf/mqtt.password
echo 'CRSPF_MQTT_OPTIONS="--broker broker.example --tls --robot forklift-7"' >/etc/default/crspf-mqtt
check 'a broker' systemctl start mosquitto
documents service
kept() { mosquitto_sub -h broker.example -t "crspf/forklift-7/$1" --retained-only -C 1 -W 5 >/tmp/kept 2>/dev/null; }
check 'the unit tells the broker of the map' within 30 kept map
check 'its connection is by TLS' bash -c "ss -tnp state established dport = 8883 | grep crspf"
systemctl stop crspf-mqtt
documents broker
check 'the broker has no map any longer' bash -c '! mosquitto_sub -h broker.example -t "crspf/forklift-7/map/#" --retained-only -C 1 -W 5'

# --- a desk from which the robot is reached
ip netns add desk
ip link add at-desk netns desk type veth peer name at-robot
ip address add 192.0.2.1/24 dev at-robot && ip link set at-robot up
ip -netns desk address add 192.0.2.2/24 dev at-desk && ip -netns desk link set at-desk up && ip -netns desk link set lo up
mkdir -p /etc/netns/desk
echo '192.0.2.1 robot' >/etc/netns/desk/hosts
ssh-keygen -q -t ed25519 -N '' -f ~keeper/.ssh/id_ed25519
cp ~keeper/.ssh/id_ed25519.pub ~keeper/.ssh/authorized_keys
echo 'StrictHostKeyChecking accept-new' >~keeper/.ssh/config
chown -R keeper: ~keeper/.ssh
chmod 700 ~keeper/.ssh
systemctl start ssh
page() { ip netns exec desk bash -c 'exec 3<>/dev/tcp/127.0.0.1/8765 && printf "GET / HTTP/1.1\r\nHost: 127.0.0.1:8765\r\n\r\n" >&3 && timeout 5 grep -m 1 -q "<title>" <&3'; }
watched() {
    local desk status=0
    ip netns exec desk runuser --login keeper -c "script --quiet --return --command 'bash -euo pipefail $1' /dev/null" &
    desk=$!
    within 40 page || status=1
    pkill -f '^ssh -'
    wait "$desk"
    return "$status"
}
for block in documents/desk/*; do check "document ${block#documents/*/}" watched "/ring/$block"; done
check 'nobody watches any longer' within 10 bash -c '! pgrep --full "[c]rspf view"'

documents network
check 'networkd has left the bus up' grows
check 'its pose is known to the end' known
systemctl stop crspfd

{
    ./live_robot --config /run/robot/tty udp://127.0.0.1:7750
    sed -n '/^\[stereo\]/,$p' out/together.toml
} >~keeper/robot.toml
usermod --append --groups video keeper
documents cameras
