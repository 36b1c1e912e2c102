#!/usr/bin/env bash
# Our Velodyne decoder against another one, point by point, over the public recordings.
#   velodyne_against_foxglove.sh POINTS DATA    POINTS: the program velodyne_points; DATA: folder of
#                                               recordings, unless $CRSPF_DATA names one
# Needs node and npm's @foxglove/velodyne-cloud@1.0.1; says so and ends with 77 where they are absent.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
points=$1
data=${CRSPF_DATA:-$2}
source "$here/npm.sh"
need_packages @foxglove/velodyne-cloud
compare() {  # CAPTURE MODEL
    node "$here/velodyne_against_foxglove.js" "$points" "$1" "$2"
    # The control: a turn of a hundredth of a degree must be seen.
    if node "$here/velodyne_against_foxglove.js" "$points" "$1" "$2" --plant >/dev/null; then
        echo "a planted difference was not found" >&2
        exit 1
    fi
}
compare random vlp32c
for pair in vlp16:mrpt_sample_velodyne_vlp16_gps hdl32e:mrpt_sample_velodyne_hdl32; do
    capture=$data/velodyne/${pair#*:}.pcap
    [[ -f $capture ]] || skip "$capture is absent; set CRSPF_DATA to its folder"
    compare "$capture" "${pair%%:*}"
done
