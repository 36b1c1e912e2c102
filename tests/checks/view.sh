#!/usr/bin/env bash
# The operator's page (crspf view) from end to end in headless Chromium: see view.mjs.
#   view.sh CRSPF CRSPFD [FOLDER]    FOLDER: keeps the screenshots there
# Says 'skipped: ' and leaves with 77 where chromium or node is absent.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
crspf=$1
crspfd=$2
for program in chromium node; do
    command -v "$program" >/dev/null || { echo "skipped: $program is absent"; exit 77; }
done
folder=${3:-$(mktemp -d)}
mkdir -p "$folder"
[[ -n ${3:-} ]] || trap 'rm -rf "$folder"' EXIT

"$crspf" sim --world office --lidar urg --robot differential --seed 1 --out "$folder/sim" --capture "$folder/run.pcapng" >/dev/null
(umask 077; printf '0123456789abcdef0123456789abcdef\n' >"$folder/token")
node "$here/view.mjs" "$crspf" "$crspfd" "$(realpath "$folder")"
