#!/usr/bin/env bash
# The service on a robot PC of its own: Debian with systemd and a PREEMPT_RT kernel in a virtual machine (qemu, without
# KVM), the .deb installed, sensors at a pseudo terminal and on a virtual CAN bus, the poses read back from that, and what
# the documents tell a user to do. guest.sh is what happens inside. What is emulated tells nothing about speed.
# usage: ring.sh BUILD_DIRECTORY    build/release, or build/aarch64: a 64-bit ARM board, on which those tests run, too, that
#                                   want more of a kernel than qemu's user emulation has
#                                   The log and what was recorded: BUILD_DIRECTORY/ring
set -euo pipefail
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")")
build=$(realpath "$1")
out=$build/ring
minutes=30
others=socat,sudo,adduser,openssh-server,openssh-client,ca-certificates,openssl,mosquitto,mosquitto-clients
case $(basename "$build") in
    aarch64)
        machine=(qemu-system-aarch64 -machine virt -cpu cortex-a72) console=ttyAMA0
        tests=(unit_ports unit_live unit_service unit_crspfd)
        ;;
    *) machine=(qemu-system-x86_64 -cpu max) console=ttyS0 tests=() ;;
esac
for program in "${machine[0]}" mmdebstrap; do
    command -v "$program" >/dev/null || { echo "skipped: no $program (tools/setup.sh --all)"; exit 77; }
done

cmake --build "$build" --target crspf crspfd crspf_package_files live_robot "${tests[@]}"
rm -rf "$out"
mkdir -p "$out/disk"
cpack --config "$build/CPackConfig.cmake" -B "$out/made" >"$out/cpack.log" || { cat "$out/cpack.log"; exit 1; }
cp "$out"/made/crspf_*.deb "$out/disk/crspf.deb"
cp "$build/tests/vm/live_robot" "$here/guest.sh" "$here/documents.sh" "$out/disk"
"$here/../checks/docs_blocks.py" "$out/disk/documents"
for test in "${tests[@]}"; do
    find "$build/tests/unit" -name "$test" -type f -exec cp {} "$out/disk" \;
done
depends=$(dpkg-deb --field "$out/disk/crspf.deb" Depends | tr ',' '\n' | sed 's/[|(].*//; s/ //g' | sort -u | paste -sd,)
image=$("$here/image.sh" "$(dpkg-deb --field "$out/disk/crspf.deb" Architecture)" "$depends,$others")
/usr/sbin/mke2fs -q -t ext4 -d "$out/disk" "$out/disk.img" 64M

timeout $((60 * minutes)) "${machine[@]}" -accel tcg,thread=multi -smp 2 -m 1536 -display none -no-reboot \
    -kernel "$image/vmlinuz" -initrd "$image/initrd.img" -append "root=/dev/vda rw console=$console quiet systemd.mask=serial-getty@$console.service" \
    -drive file="$image/root.img",format=raw,if=virtio,snapshot=on -drive file="$out/disk.img",format=raw,if=virtio \
    -nic none -serial stdio </dev/null | stdbuf -oL tr -d '\r' | tee "$out/console" | grep --line-buffered -E '^ring: |^    ' ||
    { tail -n 40 "$out/console"; echo "ring: the machine did not come to its end in $minutes minutes"; exit 1; }
/usr/sbin/debugfs -R "rdump /out $out" "$out/disk.img" 2>/dev/null
grep -q '^ring: all is well' "$out/console" || { cat "$out/out/journal"; exit 1; }
"$here/poses.py" "$here/../../config/crspf.dbc" "$out/out/judged.log"
