#!/usr/bin/env bash
# A robot PC for tests/vm/ring.sh: Debian with systemd and its PREEMPT_RT kernel, as files that qemu boots. Kept in
# ${XDG_CACHE_HOME:-~/.cache}/crspf and made where absent, which takes minutes, root and the network.
# usage: image.sh ARCHITECTURE PACKAGES    Debian's name of it; comma-separated, what else is installed there.
# Prints the folder: root.img vmlinuz initrd.img
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
architecture=$1
packages="$2,systemd,systemd-sysv,udev,dbus,iproute2,can-utils,procps,linux-image-rt-$architecture,zstd"
cache=${XDG_CACHE_HOME:-$HOME/.cache}/crspf
image=$cache/vm-$architecture-$(cat "$here/image.sh" "$here/ring.service" - <<<"$packages" | sha256sum | cut -c-12)

# Packages of another processor configure themselves by programs of that one; meanwhile the kernel knows who runs them.
binfmt=/proc/sys/fs/binfmt_misc
emulate_arm64() {
    [[ -e $binfmt/register ]] || mount -t binfmt_misc none $binfmt
    if [[ ! -e $binfmt/qemu-aarch64 ]]; then
        trap 'echo -1 >$binfmt/qemu-aarch64' EXIT
        cat /usr/lib/binfmt.d/qemu-aarch64.conf >$binfmt/register  # qemu-user-static's
    fi
}

if [[ ! -d $image ]]; then
    ((EUID == 0)) || exec sudo --non-interactive env XDG_CACHE_HOME="${XDG_CACHE_HOME:-$HOME/.cache}" "$0" "$@"
    if [[ $architecture == arm64 && $(uname -m) != aarch64 ]]; then
        emulate_arm64
    fi
    part=$image.part
    rm -rf "$part"
    mkdir -p "$part"
    # The initramfs needs only what leads to the disk.
    # shellcheck disable=SC2016  # $1: mmdebstrap's
    mmdebstrap --quiet --variant=minbase --architectures="$architecture" --include="$packages" \
        --essential-hook='mkdir -p "$1/etc/initramfs-tools/conf.d" "$1/usr/share/initramfs-tools/modules.d"' \
        --essential-hook='echo MODULES=list >"$1/etc/initramfs-tools/conf.d/modules"' \
        --essential-hook='printf "virtio_pci\nvirtio_blk\next4\n" >"$1/usr/share/initramfs-tools/modules.d/ring"' \
        --customize-hook="copy-in $here/ring.service /etc/systemd/system" \
        --customize-hook='chroot "$1" systemctl enable ring.service' \
        --customize-hook='chroot "$1" passwd --delete root' \
        --customize-hook='echo robot >"$1/etc/hostname"' \
        --customize-hook='mkdir "$1/ring"' \
        --customize-hook='cp "$1"/boot/vmlinuz-* "'"$part"'/vmlinuz"' \
        --customize-hook='cp "$1"/boot/initrd.img-* "'"$part"'/initrd.img"' \
        bookworm "$part/root.tar" >&2
    mkdir "$part/root"
    tar -xf "$part/root.tar" -C "$part/root" --exclude='./dev/*'
    /usr/sbin/mke2fs -q -t ext4 -d "$part/root" "$part/root.img" 3G >&2
    rm -rf "$part/root" "$part/root.tar"
    mv "$part" "$image"
fi
echo "$image"
