#!/usr/bin/env bash
# The Debian package: built, read by lintian, and installed, upgraded, removed and purged in a Debian of its own. That is
# a tar file in ${XDG_CACHE_HOME:-~/.cache}/crspf, made by mmdebstrap where it is absent, which needs the network.
# usage: package.sh BUILD_DIRECTORY    configured, as build/release is
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
build=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
    echo "package: $*" >&2
    exit 1
}
# refused TEXT COMMAND...: the command must fail, for its planted fault.
refused() {
    local text=$1
    shift
    if "$@" >"$folder/said" 2>&1; then
        cat "$folder/said"
        fail "passed, though $text"
    fi
}

targets=(crspf crspf_package_files)
ninja -C "$build" -t query crspfd >/dev/null 2>&1 && targets+=(crspfd)
cmake --build "$build" --target "${targets[@]}"
cpack --config "$build/CPackConfig.cmake" -B "$folder/made" >"$folder/cpack.log" || { cat "$folder/cpack.log"; exit 1; }
deb=$(echo "$folder"/made/crspf_*.deb)
version=$(dpkg-deb --field "$deb" Version)
architecture=$(dpkg-deb --field "$deb" Architecture)

# repacked NAME VERSION COMMAND...: the package with another version, changed by the command, which gets its folder.
repacked() {
    local name=$1 version=$2
    shift 2
    rm -rf "$folder/content"
    dpkg-deb --raw-extract "$deb" "$folder/content"
    sed -i "s/^Version: .*/Version: $version/" "$folder/content/DEBIAN/control"
    "$@" "$folder/content"
    dpkg-deb --build --root-owner-group "$folder/content" "$folder/$name.deb" >/dev/null
}

# --- what it says of itself
dpkg-deb --fsys-tarfile "$deb" | tar -xO ./usr/share/doc/crspf/changelog.Debian.gz | gunzip >"$folder/changelog"
[[ $(dpkg-parsechangelog --file "$folder/changelog" --show-field Version) == "$version" ]] ||
    fail "config/debian/changelog does not speak of $version"

if command -v lintian >/dev/null; then
    "$here/lint.sh" "$deb"
    without_copyright() { rm "$1/usr/share/doc/crspf/copyright"; }
    repacked bad "$version" without_copyright
    refused 'it has no copyright' "$here/lint.sh" "$folder/bad.deb"
else
    echo 'skipped: no lintian here (tools/setup.sh --all)'
fi

# --- a Debian with all that it depends on
if ((EUID != 0)) || ! command -v mmdebstrap >/dev/null; then
    echo 'skipped: installation in a Debian of its own needs root and mmdebstrap (tools/setup.sh --all)'
    exit 0
fi
depends=$(dpkg-deb --field "$deb" Depends | tr ',' '\n' | sed 's/[|(].*//; s/ //g' | sort -u | paste -sd,)
cache=${XDG_CACHE_HOME:-$HOME/.cache}/crspf
tar=$cache/bookworm-$architecture-$(sha256sum <<<"$depends" | cut -c-12).tar
if [[ ! -f $tar ]]; then
    mkdir -p "$cache"
    mmdebstrap --quiet --variant=minbase --architectures="$architecture" --include="$depends" bookworm "$tar.part.tar"
    mv "$tar.part.tar" "$tar"
fi
root=$folder/root
mkdir "$root"
tar -xf "$tar" -C "$root" --exclude='./dev/*'
mkdir "$root/packages"
cp "$deb" "$root/packages/first.deb"
# Without the machine's environment, and with a /proc and /dev that go with the command. No systemd runs there.
inside() {
    # shellcheck disable=SC2016  # the inner shell's
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive unshare --mount \
        sh -c 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && exec chroot "$0" "$@"' "$root" "$@" </dev/null
}
status() { inside dpkg-query --show --showformat='${db:Status-Status}' crspf; }
mask=$root/etc/systemd/system/crspfd.service
wanted=$root/etc/systemd/system/multi-user.target.wants/crspfd.service

# --- a package whose script fails is not installed
failing() { printf '#!/bin/sh\nexit 1\n' >"$1/DEBIAN/postinst"; }
repacked failing "$version" failing
cp "$folder/failing.deb" "$root/packages"
refused 'its postinst fails' inside dpkg --install /packages/failing.deb
inside dpkg --purge crspf >/dev/null 2>&1
[[ ! -e $root/usr/bin/crspf ]] || fail 'the purge of a half-installed package left files'

echo '--- install'
inside dpkg --install /packages/first.deb
[[ $(status) == installed ]] || fail "is $(status)"
[[ $(inside id -nG crspf) == 'crspf dialout' ]] || fail "the user crspf is in the groups $(inside id -nG crspf)"
[[ $(inside stat --format='%U:%G %a' /var/lib/crspf) == 'crspf:crspf 750' ]] || fail '/var/lib/crspf is not the service'"'s"
[[ ! -e $wanted && ! -e $mask ]] || fail 'the service is enabled, though it has no sensors, or masked'
inside crspf --version
inside crspf config --check /etc/crspf/crspfd.toml
for example in "$root"/usr/share/crspf/examples/*.toml; do  # their DBC files must be where they look for them
    inside crspf config --check "${example#"$root"}"
done
sed 's/^#//; s/^ .*//' "$root/etc/crspf/crspfd.toml" | grep -E '^(\[|[a-z_]+ = )' >"$root/packages/all.toml"
inside crspf config --check /packages/all.toml  # what is a comment at first, too
grep -q '^\[source.base.right\]' "$root/packages/all.toml" || fail 'no commented source was checked'
inside bash -c '. /usr/share/bash-completion/completions/crspf
    complete_line() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _crspf; echo "${COMPREPLY[*]}"; }
    [[ $(complete_line crspf do) == doctor ]] && [[ $(complete_line crspf eval lo) == loops ]] &&
        [[ $(complete_line crspf replay --ou) == --out ]] && [[ -z $(complete_line crspf replay x) ]] &&
        [[ $(complete_line crspf experiments tab) == table1 ]]' ||
    fail 'the completion is wrong'

echo '--- upgrade'
echo '# mine' >>"$root/etc/crspf/crspfd.toml"
echo map >"$root/var/lib/crspf/map"
inside systemctl enable crspfd.service crspf-mqtt.service
[[ -L $wanted && -L ${wanted%/*}/crspf-mqtt.service ]] || fail 'the services cannot be enabled'
changed() { echo '# new' >>"$1/etc/crspf/crspfd.toml"; }
repacked second "$version+1" changed
cp "$folder/second.deb" "$root/packages"
inside dpkg --force-confold --install /packages/second.deb
[[ $(inside dpkg-query --show --showformat='${Version}' crspf) == "$version+1" ]] || fail 'the version stayed'
grep -q '# mine' "$root/etc/crspf/crspfd.toml" || fail 'the configuration was overwritten'
[[ -L $wanted && -f $root/var/lib/crspf/map ]] || fail 'the service is no longer enabled, or its map is gone'

echo '--- remove'
inside dpkg --remove crspf
[[ ! -e $root/usr/bin/crspf ]] || fail 'the program stayed'
[[ -f $root/etc/crspf/crspfd.toml && -f $root/var/lib/crspf/map ]] || fail 'the configuration or the map went'

echo '--- install again'
inside dpkg --force-confold --install /packages/second.deb
[[ -L $wanted && -L ${wanted%/*}/crspf-mqtt.service && ! -e $mask ]] || fail 'what was enabled before the removal is not now'

echo '--- purge'
inside dpkg --purge crspf
[[ $(status 2>&1 || true) != *installed* ]] || fail "is $(status)"
left=$(find "$root" -xdev -ipath '*crspf*' -not -path "$root/proc/*")
[[ -z $left ]] || fail "left behind: $left"
inside id crspf >/dev/null || fail 'the user went: what it owns elsewhere would be the next user'"'s"
echo 'package: built, installed, upgraded, removed and purged'
