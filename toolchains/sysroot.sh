#!/usr/bin/env bash
# Debian's libraries of another architecture, for the presets aarch64 and armhf: unpacked into a folder beside the system,
# not installed, since Debian's armhf is at times behind in security updates and apt wants equal versions of both. Kept in
# ${XDG_CACHE_HOME:-~/.cache}/crspf and made where absent, which takes a minute and the network; build/sysroot/ARCH leads
# there. usage: sysroot.sh arm64|armhf
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
architecture=$1
case $architecture in
    arm64) multiarch=aarch64-linux-gnu ;;
    armhf) multiarch=arm-linux-gnueabihf ;;
    *) echo "usage: toolchains/sysroot.sh arm64|armhf" >&2; exit 2 ;;
esac
packages=$("$here/../tools/setup.sh" --libraries | paste -sd,),libc6-dev,libstdc++-12-dev
cache=${XDG_CACHE_HOME:-$HOME/.cache}/crspf
root=$cache/sysroot-$architecture-$(cat "${BASH_SOURCE[0]}" - <<<"$packages" | sha256sum | cut -c-12)

if [[ ! -d $root ]]; then
    # The mirror that this machine uses; Debian's name for what it serves.
    # shellcheck disable=SC2016  # $(REPO_URI): apt-get's
    uri=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Codename: bookworm' 'Component: main' | head -n 1)
    part=$root.part
    rm -rf "$part"
    mkdir -p "$cache"
    # shellcheck disable=SC2016  # $1: mmdebstrap's
    mmdebstrap --quiet --mode=chrootless --variant=extract --architectures="$architecture" --include="$packages" \
        --extract-hook='cp -al "$1/var/cache/apt/archives" "$1/debs"' \
        bookworm "$part" "deb ${uri:-http://deb.debian.org/debian} bookworm main" >&2
    # Which package a library is in and which version of it is enough, as dpkg would have noted it (dpkg-shlibdeps -L).
    for deb in "$part"/debs/*.deb; do
        dpkg-deb --control "$deb" "$part/control"
        [[ ! -e $part/control/shlibs ]] || cat "$part/control/shlibs" >>"$part/shlibs.local"
        rm -r "$part/control"
    done
    # From outside, an absolute link would lead into the machine that builds.
    find "$part" -type l -lname '/*' -printf '%p\t%l\n' | while IFS=$'\t' read -r link target; do
        ln -srfT "$part$target" "$link"
    done
    rm -rf "${part:?}/dev" "$part/debs"
    # What the packages' scripts would have chosen.
    for library in blas lapack; do
        ln -sf "$library/lib$library.so.3" "$part/usr/lib/$multiarch/lib$library.so.3"
    done
    mv "$part" "$root"
fi
mkdir -p "$here/../build/sysroot"
ln -sfnT "$root" "$here/../build/sysroot/$architecture"
echo "$root"
