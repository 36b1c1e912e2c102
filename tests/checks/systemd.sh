#!/usr/bin/env bash
# The units and their companions before systemd: nothing that it does not know, hardened services, the user, the
# directory, the keys of the CAN network. Each check first has to fail on a planted fault.
# usage: systemd.sh SOURCE_DIRECTORY
set -euo pipefail
config=$1/config
for tool in systemd-analyze systemd-sysusers systemd-tmpfiles; do
    if ! command -v $tool >/dev/null; then
        echo "skipped: no $tool here"
        exit 77
    fi
done
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
mkdir "$folder/good" "$folder/bad" "$folder/root" "$folder/root/etc"

# The programs need not be installed to look at their units.
unit() { sed 's|^ExecStart=/usr/bin/.*|ExecStart=/bin/true|' "$config/systemd/$1.service"; }

# verify passes what it does not know, with a word about it: silence is the proof.
knows_all() {
    local said
    said=$(systemd-analyze verify --man=no "$1" 2>&1 | grep -F "$(basename "$1")" || true)
    [[ -z $said ]] || { echo "$said"; return 1; }
}
# On systemd's scale of 0.0 to 10.0.
is_hardened() { systemd-analyze security --offline=true --threshold=20 --no-pager "$1"; }
for name in crspfd crspf-mqtt; do
    good=$folder/good/$name.service
    bad=$folder/bad/$name.service
    unit "$name" >"$good"
    { unit "$name"; echo '[Service]'; echo 'LimitRTPRIOS=95'; } >"$bad"
    knows_all "$good"
    if knows_all "$bad" >/dev/null; then
        echo 'a key that systemd does not know passed'
        exit 1
    fi
    sed '/^# Hardening/,/^\[Install\]/{/^\[Install\]/!d}' "$good" >"$bad"
    is_hardened "$good"
    if is_hardened "$bad" >/dev/null; then
        echo 'a unit without hardening passed'
        exit 1
    fi
done

makes_user() {
    systemd-sysusers --root="$folder/root" "$1" && grep -q '^crspf:.*:/var/lib/crspf:' "$folder/root/etc/passwd" &&
        grep -q '^crspf:' "$folder/root/etc/group" && grep -q '^dialout:.*:crspf$' "$folder/root/etc/group"
}
sed 's/^m /# /' "$config/systemd/crspf.sysusers.conf" >"$folder/bad/sysusers.conf"
if makes_user "$folder/bad/sysusers.conf" 2>/dev/null; then
    echo 'a user outside dialout passed'
    exit 1
fi
makes_user "$config/systemd/crspf.sysusers.conf"

if ((EUID == 0)); then
    systemd-tmpfiles --root="$folder/root" --create "$config/systemd/crspf.tmpfiles.conf"
    user=$(awk -F: '$1 == "crspf" { print $3 ":" $4 }' "$folder/root/etc/passwd")
    [[ $(stat --format='%a %u:%g' "$folder/root/var/lib/crspf") == "750 $user" ]]
else
    echo 'skipped: only root can give a directory away (crspf.tmpfiles.conf)'
fi

# networkd has no verify; its table of keys is in the program.
networkd=/lib/systemd/systemd-networkd
if [[ -f $networkd ]]; then
    knows() { grep -qaF "$1" "$networkd"; }
    section=''
    while IFS= read -r line; do
        case $line in
            '['*) section=${line//[\[\]]/} ;;
            [A-Z]*) knows "$section.${line%%=*}" || { echo "networkd does not know $line"; exit 1; } ;;
        esac
    done <"$config/network/80-can0.network"
    if knows 'CAN.BitRates'; then
        echo 'a key that networkd does not know passed'
        exit 1
    fi
else
    echo 'skipped: no systemd-networkd here'
fi
