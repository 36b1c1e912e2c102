# 32-bit ARM with Debian (armhf): any ARMv7-A that has NEON, which Debian itself does not ask for.
set(architecture armhf)
set(triplet arm-linux-gnueabihf)
set(emulator qemu-arm)
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(CMAKE_CXX_FLAGS_INIT "-march=armv7-a+neon -mtune=cortex-a53")
include(${CMAKE_CURRENT_LIST_DIR}/cross.cmake)
