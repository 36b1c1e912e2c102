#!/usr/bin/env bash
# What another program sees in our recordings: tshark's fields against the ones that were written.
# usage: pcapng_by_tshark.sh WRITE_SAMPLE_PCAPNG
set -euo pipefail

if ! command -v tshark >/dev/null; then
    echo "skipped: no tshark here (apt-get install tshark); nobody else has read our recordings"
    exit 0
fi
file=$(mktemp --suffix=.pcapng)
trap 'rm -f "$file"' EXIT
"$1" "$file"

see() {
    tshark -r "$file" -T fields -E separator='|' "$@" 2>/dev/null
}
equal() {
    if [[ $2 != "$3" ]]; then
        printf '%s\n  written: %s\n  seen:    %s\n' "$1" "$2" "$3"
        exit 1
    fi
}

# Number, stamp, interface, direction (1 received, 2 sent), bytes.
equal records '1|1700000000.123456789|front|VLP-16|0x00000001|47
2|1700000000.123456790|can0|wheels|0x00000002|10
3|1700000000.123456791|can0|wheels||20
4|1700000000.123456792|rear|URG-04LX|0x00000001|5' \
    "$(see -e frame.number -e frame.time_epoch -e frame.interface_name -e frame.interface_description \
        -e frame.packet_flags -e frame.len)"
equal datagram '192.168.1.201|255.255.255.255|2368|2369|68656c6c6f|1' \
    "$(see -o ip.check_checksum:TRUE -Y udp -e ip.src -e ip.dst -e udp.srcport -e udp.dstport -e udp.payload \
        -e ip.checksum.status)"
equal can "$((0x18FEF100))|1|2
$((0x123))|0|12" "$(see -Y 'can or canfd' -e can.id -e can.flags.xtd -e can.len)"
equal comment 'the configuration' "$(capinfos -k "$file" | sed -n 's/^Capture comment: *//p')"
# A file cut within its last record still shows the ones before.
truncate -s -3 "$file"
equal cut 3 "$(see -e frame.number | wc -l)"
echo "tshark sees what was written"
