#!/usr/bin/env bash
# What the service does in a long run: without its sensors; a robot that stands for a day; and in real time, alone and
# with every processor under load, with SCHED_FIFO and without. cyclictest runs beside it on every processor, above every
# other thread: what it sees, the machine takes, and a thread of the service that was as late is not the service's doing.
# usage: soak.sh BUILD_DIRECTORY [SECONDS]    of each run of the service; default 300. Root's rights are for SCHED_FIFO.
set -euo pipefail
((EUID == 0)) || exec sudo --non-interactive "$0" "$@"
soak=$(realpath "$1")/tests/soak
seconds=${2:-300}
for program in cyclictest stress-ng; do
    command -v "$program" >/dev/null || { echo "no $program; tools/setup.sh --all installs it" >&2; exit 1; }
done

failed=0
# service TITLE ARGUMENTS...
service() {
    echo "--- $1"
    shift
    cyclictest --quiet --mlockall --smp --priority=95 --interval=1000 --histogram=100000 --duration="$seconds" \
        >"$work/cyclic" &
    "$soak/soak_service" --seconds "$seconds" "$@" || failed=1
    wait $!
    awk '/^[0-9]/ { at[++n] = $1 + 0; for (i = 2; i <= NF; i++) { count[n] += $i; all += $i } }
         END { for (i = 1; i <= n; i++) { sum += count[i]; if (count[i] > 0) max = at[i] + 1
                   if (!half && sum >= all / 2) half = at[i] + 1; if (!most && sum >= 0.999 * all) most = at[i] + 1
                   if (at[i] >= 1000) late += count[i]; if (at[i] >= 5000) very += count[i] }
               printf "cyclictest at priority 95: 50%% below %.3f ms, 99.9%% below %.3f ms, max %.3f ms; later than " \
                      "1 ms %d times of %d, than 5 ms %d\n", half / 1000, most / 1000, max / 1000, late, all, very }' \
        "$work/cyclic"
}

work=$(mktemp -d)
trap 'rm -rf "$work"; kill $(jobs -p) 2>/dev/null || true' EXIT
echo '--- nothing is plugged in'
"$(dirname "${BASH_SOURCE[0]}")/unplugged.sh" "$1/platform/crspfd/crspfd" || failed=1
echo '--- a robot that stands for 24 h'
"$soak/soak_standing" | tail -n 2 || failed=1
service 'alone'
stress-ng --quiet --cpu "$(nproc)" --vm 1 --vm-bytes 256M --timer 1 &
stress=$!
service 'under stress-ng'
echo '(what follows is to show misses)'
before=$failed
service 'under stress-ng, without SCHED_FIFO' --ordinary
failed=$before
kill "$stress"
exit $failed
