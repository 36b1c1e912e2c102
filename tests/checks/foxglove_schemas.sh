#!/usr/bin/env bash
# Every message that Foxglove and Lichtblick get from us is what the JSON schemas of npm's @foxglove/schemas say.
#   foxglove_schemas.sh CRSPF
# Needs node, zstd and npm's @foxglove/schemas, ajv and @mcap/core; says so and ends with 77 where they are absent.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
crspf=$1
source "$here/npm.sh"
need_packages @foxglove/schemas ajv @mcap/core
command -v zstd >/dev/null || skip 'zstd is absent'

folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$crspf" sim --world office --duration 25 --out "$folder/sim" >/dev/null
# A damaged line is a line in the run's log.
sed -i '500s/.*/FLASER nonsense/' "$folder/sim/log.clf"
"$crspf" export "$folder/sim/log.clf" --config "$folder/sim/config.toml" --mcap "$folder/run.mcap" >/dev/null 2>&1
node "$here/foxglove_schemas.mjs" "$folder/run.mcap"
