#!/usr/bin/env bash
# Installs what the build needs and the machine lacks, on Debian 12. Quick and silent about the rest when all is there.
set -euo pipefail

usage="usage: tools/setup.sh [--tests | --all | --libraries]
  --tests      also what tests/run.sh needs: clang, its sanitizer and fuzzing runtimes, clang-tidy, clang-format, python3,
               chromium, in which pages and reports are looked at, a broker for crspf mqtt; compilers for ARM, and qemu,
               which runs what they build
  --all        also what its --all, --arm and --vm need: what looks at packages, qemu for virtual machines, a load for
               the long runs, and prometheus, whose promtool reads the alerts
  --libraries  installs nothing: prints the libraries that a build links or includes, for toolchains/sysroot.sh"

libraries=(libeigen3-dev libtomlplusplus-dev libcli11-dev libarchive-dev libpng-dev nlohmann-json3-dev libbenchmark-dev
    nettle-dev catch2 libpugixml-dev libspdlog-dev libfmt-dev libsystemd-dev libopencv-calib3d-dev libopencv-video-dev
    libzstd-dev zlib1g-dev libwebsockets-dev libmosquitto-dev)
packages=(g++ cmake ninja-build ccache pkg-config dpkg-dev file "${libraries[@]}")
case ${1:-} in
    '') ;;
    --libraries) printf '%s\n' "${libraries[@]}"; exit 0 ;;
    --tests | --all)
        packages+=(clang clang-format clang-tidy lld libclang-rt-14-dev xz-utils python3 chromium zstd
            mosquitto mosquitto-clients openssl
            g++-aarch64-linux-gnu g++-arm-linux-gnueabihf qemu-user mmdebstrap) ;;
    -h | --help) echo "$usage"; exit 0 ;;
    *) echo "$usage" >&2; exit 2 ;;
esac

[[ ${1:-} != --all ]] || packages+=(
    lintian qemu-system-x86 qemu-system-arm qemu-user-static arch-test e2fsprogs rt-tests stress-ng tshark prometheus)

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "setup: not a Debian system, nothing installed. The build needs what Debian 12 calls: ${packages[*]}" >&2
    exit 0
fi

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ $status == *installed* && $status != *not-installed* ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
    echo "setup: all ${#packages[@]} packages are there"
    exit 0
fi

as_root=()
if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
        echo "setup: error: not root and no sudo; as root, run: apt-get install ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
    [[ -t 0 ]] || as_root+=(--non-interactive)  # nobody is there to type a password
fi
# No question may wait for an answer, and another apt that is at work is waited for.
apt() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive NEEDRESTART_MODE=a \
        apt-get --quiet --yes -o DPkg::Lock::Timeout=300 -o Dpkg::Options::=--force-confold "$@" </dev/null
}

echo "setup: installing ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { apt update && apt install --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    cat "$log" >&2
    echo "setup: error: apt-get failed, see above; is the network there, and are Debian 12's sources in /etc/apt?" >&2
    exit 1
fi
echo "setup: done"
