# Runs as root inside the virtual machine of ring.sh, with /ring its disk. Each check says `ring: ok` or `ring: FAILED`.
set -u
cd /ring || exit 1
exec 2>&1
export DEBIAN_FRONTEND=noninteractive

failed=0
# check NAME COMMAND...
check() {
    local name=$1
    shift
    if "$@" >/tmp/said; then
        echo "ring: ok      $name"
    else
        echo "ring: FAILED  $name"
        cat /tmp/said
        failed=1
    fi
}
# within SECONDS COMMAND...: until it succeeds
within() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        ((SECONDS < end)) || { status; return 1; }
        sleep 0.3
    done
}
status() { crspf ctl status --json; }
pose() { crspf ctl pose --json; }
has() { grep -q -- "$1" /tmp/has; }
says() { status >/tmp/has && has "$1"; }      # says PATTERN, in one line of the status
pose_says() { pose >/tmp/has && has "$1"; }
number() { status | sed -n "s/^ *\"$1\": \([0-9.]*\),\?\$/\1/p" | head -n 1; }  # number KEY: the first of that name
robot() { echo "$1" >/run/robot/words; }
known() { pose_says '"lost": false' && pose_says '"matched": true'; }
main_pid() { systemctl show --property=MainPID --value crspfd; }
restarts() { systemctl show --property=NRestarts --value crspfd; }
poses_on_bus() { wc -l </ring/out/pose.log; }
grows() { local before; before=$(poses_on_bus); sleep 1; (($(poses_on_bus) > before + 100)); }
logged() { journalctl --unit=crspfd --output=cat | grep -q -- "$1"; }

mkdir -p out
echo "ring: $(uname -rv)"
check 'a PREEMPT_RT kernel' grep -q 1 /sys/kernel/realtime
modprobe vcan
ip link add dev can0 type vcan
ip link set can0 up

# --- installed
check 'the package installs' dpkg --install crspf.deb
mkdir /run/robot
chown crspf: /run/robot
{
    /ring/live_robot --config /run/robot/tty can0
    printf '\n[pose_output]\ncan = "can0"\nrate_hz = 50.0\n\n[service]\nsave_every_s = 5.0\n'
} >/etc/crspf/crspfd.toml
chown root:crspf /etc/crspf/crspfd.toml
check 'the configuration is good' crspf config --check /etc/crspf/crspfd.toml
mkfifo /run/robot/words
chown crspf: /run/robot/words
# Sensors are hardware: they do not wait for the service's processor.
chrt --fifo 80 setpriv --reuid=crspf --regid=crspf --init-groups /ring/live_robot /run/robot/tty can0 <>/run/robot/words >/dev/null &
check 'the sensors are there' within 5 test -e /run/robot/tty
crspf doctor --config /etc/crspf/crspfd.toml | sed 's/^/    /'
systemd-analyze security --no-pager crspfd | tail -n 1 | sed 's/^/    /'
check 'exposure at most 2.0' bash -c 'systemd-analyze security --no-pager --threshold=20 crspfd'

# --- started by systemd
# Whoever listens ends when the interface goes down.
while :; do candump -L can0,780:7F8 >>out/pose.log 2>/dev/null; sleep 0.2; done &
begin=$(date +%s%N)
check 'systemd starts it, and hears that it is ready' systemctl start crspfd
echo "ring: ready after $((($(date +%s%N) - begin) / 1000000)) ms (emulated)"
check 'its pose is known' within 20 known
echo "ring: pose known after $((($(date +%s%N) - begin) / 1000000)) ms (emulated)"
check 'five frames a pose, 50 poses a second' grows
check 'it runs as its own user' test "$(ps -o user= -p "$(main_pid)")" = crspf
check 'its memory is locked' bash -c "(($(sed -n 's/^VmLck:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$(main_pid)/status") > 10000))"
for thread in output rx-lidar rx-base odometry filter map; do
    tid=$(grep -lx "$thread" /proc/"$(main_pid)"/task/*/comm | cut -d/ -f5)
    check "thread $thread is SCHED_FIFO" bash -c "chrt -p $tid | grep SCHED_FIFO"
done
check 'the socket is for owner and group' test "$(stat --format='%U:%G %a' /run/crspf/control)" = 'crspf:crspf 660'
# shellcheck disable=SC2016
check 'nobody else may command it' bash -c '! setpriv --reuid=nobody --regid=nogroup --clear-groups crspf ctl status'

# --- a lidar unplugged and plugged in again
robot unplug
check 'unplugged: the lidar is missed' within 5 logged 'source lidar: stale'
check 'unplugged: the pose is lost' within 5 pose_says '"lost": true'
robot plug-in
check 'plugged in: the pose is known' within 15 known
robot mute
check 'silent: the lidar is missed' within 5 says '"state": "\(stale\|failed\)"'
robot unmute
check 'it speaks again: the pose is known' within 15 known
robot garble
sleep 1
check 'garbage: the pose is known' within 15 known

# --- the bus down and up
ip link set can0 down
check 'bus down: said' within 5 says '"bus_open": false'
check 'bus down: the odometer is missed, the pose is lost' within 5 pose_says '"lost": true'
ip link set can0 up
check 'bus up: poses are sent' within 5 grows
check 'bus up: the pose is known' within 15 known

# --- who else speaks on it
cansend can0 001#FF
cansend can0 00000001#0102030405060708
cansend can0 7FF#0102030405060708
for _ in 1 2 3 4 5; do cansend can0 780#0000000000000000; done
check 'frames of others do no harm' within 5 known
head -c 100000 /dev/urandom | socat -u - UNIX-CONNECT:/run/crspf/control 2>/dev/null
check 'nonsense at the socket does no harm' within 5 known

# --- the calendar's clock
date --set='+1 hour' >/dev/null
check 'the clock an hour later: the pose is known' known
sleep 1
date --set='-1 hour' >/dev/null
check 'and back: the pose is known' known
restarted() { [[ $(restarts) == "$1" ]]; }
check 'no restart so far' restarted 0

# --- killed
# The claim of somebody who was killed stays on a pseudo terminal, whose other end the sensor has; that of a real line
# goes with its last descriptor.
new_line() { robot unplug; sleep 1; robot plug-in; }
check 'a map is saved' within 15 test -e /var/lib/crspf/state.json
sleep 6  # one with all that it has seen
kill -KILL "$(main_pid)"
new_line
check 'killed: systemd starts it again' within 10 restarted 1
check 'killed: the pose is known' within 20 known
check 'killed: it began with its map' says '"tiles": [1-9]'
before=$(main_pid)
kill -STOP "$before"
other_pid() { [[ $(main_pid) != 0 && $(main_pid) != "$before" ]]; }
check 'it hangs: the watchdog has it started again' within 20 other_pid
check 'it hangs: the watchdog is why' within 2 logged 'watchdog\|Watchdog'
new_line
check 'it hung: the pose is known' within 20 known

# --- a disk that is full
mount -t tmpfs -o size=4k tmpfs /mnt
dd if=/dev/zero of=/mnt/full bs=1k count=64 2>/dev/null
mount --bind /mnt /var/lib/crspf
check 'disk full: said' within 15 says '"problem": "..*"'
check 'disk full: the pose is known' known
umount /var/lib/crspf
check 'disk free: all is well' within 15 says '"problem": ""'

# --- stopped
check 'it stops' systemctl stop crspfd
check 'it said so' logged 'stopped, map saved'
before=$(poses_on_bus)
sleep 1
check 'nothing is sent any longer' test "$(poses_on_bus)" = "$before"
cp out/pose.log out/judged.log  # by poses.py; what follows is too much for an emulated processor's time

# --- cameras, as the kernel pretends them: the same picture in both
modprobe vivid n_devs=2 node_types=0x1,0x1  # each captures, and nothing else
printf '%s\n' 'P0: 300 0 160 0 0 300 180 0 0 0 1 0' 'P1: 300 0 160 -36 0 300 180 0 0 0 1 0' >out/calib.txt
# sees FOLDER KEY...: `crspf stereo` for some seconds; then whether it recorded pairs, two a second at least
sees() {
    printf '%s\n' '[source.visual]' 'driver = "motion"' 'port = "udp://127.0.0.1:7750"' '[stereo]' 'rate_hz = 10.0' \
        'height_px = 360' 'calibration = "/ring/out/calib.txt"' "${@:2}" >"out/$1.toml"
    crspf stereo --config "out/$1.toml" --duration 8 --record "out/$1" --keep-free 1 || return
    crspf inspect "out/$1"/*.pcapng --json | tee /tmp/inspected
    (($(sed -n 's/.*"records": \([0-9]*\).*/\1/p' /tmp/inspected | head -n 1) >= 16))
}
check 'a camera with both pictures side by side' sees together 'device = "/dev/video0"' 'width_px = 320'
check 'two cameras' sees apart 'device = "/dev/video0"' 'right_device = "/dev/video1"' 'width_px = 640'

# --- what the documents say
. ./documents.sh

# --- the tests that a user emulation cannot run, where they were brought along
robot unplug
for test in unit_*; do
    [[ ! -e $test ]] || check "$test" "./$test" '[real-kernel]'
done

journalctl --unit=crspfd --output=short-monotonic --no-hostname >out/journal
cp /var/lib/crspf/state.json out/
kill $(jobs -p) 2>/dev/null
pkill candump
check 'the package goes' dpkg --purge crspf
check 'nothing crashed' bash -c '! journalctl | grep -E "segfault|core-dump|general protection"'
sync
((failed == 0)) && echo 'ring: all is well'
