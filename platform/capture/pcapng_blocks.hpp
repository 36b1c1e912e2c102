// Numbers of the pcapng format that its writer and its reader share.
#pragma once

#include <cstdint>

namespace crspf::pcapng {

inline constexpr std::uint32_t kSectionHeader = 0x0A0D0D0A;  // reads the same in both byte orders
inline constexpr std::uint32_t kInterface = 1;
inline constexpr std::uint32_t kSimplePacket = 3;
inline constexpr std::uint32_t kEnhancedPacket = 6;

inline constexpr std::uint32_t kByteOrderMagic = 0x1A2B3C4D;

inline constexpr std::uint16_t kOptionEnd = 0;
inline constexpr std::uint16_t kOptionComment = 1;
inline constexpr std::uint16_t kOptionSectionProgram = 4;
inline constexpr std::uint16_t kOptionInterfaceName = 2;
inline constexpr std::uint16_t kOptionInterfaceDescription = 3;
inline constexpr std::uint16_t kOptionInterfaceResolution = 9;
inline constexpr std::uint16_t kOptionInterfaceOffset = 14;
inline constexpr std::uint16_t kOptionPacketFlags = 2;

inline constexpr std::uint32_t kFlagsDirection = 3;  // mask
inline constexpr std::uint32_t kFlagsReceived = 1;
inline constexpr std::uint32_t kFlagsSent = 2;

}  // namespace crspf::pcapng
