// The settings of a serial line that only Linux's own headers know, which do not go together with the C library's.
#pragma once

#include <cstdint>

namespace crspf {

/// 8 data bits, no parity, 1 stop bit, no flow control, no translation, any speed that the hardware can do within 3 %.
/// 0, or errno.
[[nodiscard]] int set_serial_line(int fd, std::uint32_t baud);

/// For this process alone; as fast as the driver can hand bytes on, where it knows how; nothing old in its buffers.
/// 0, or errno: EBUSY where somebody else has it.
[[nodiscard]] int claim_serial_line(int fd);
/// Before it is closed: others may have it from then on. The claim is the terminal's, not the descriptor's, and
/// outlives it where somebody else has the terminal open.
void release_serial_line(int fd);

}  // namespace crspf
