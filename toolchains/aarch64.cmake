# 64-bit ARM with Debian or Raspberry Pi OS: any ARMv8-A, scheduled for what most boards have in common.
set(architecture arm64)
set(triplet aarch64-linux-gnu)
set(emulator qemu-aarch64)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_FLAGS_INIT "-mtune=cortex-a72.cortex-a53")
include(${CMAKE_CURRENT_LIST_DIR}/cross.cmake)
