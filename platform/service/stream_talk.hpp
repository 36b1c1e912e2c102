// The conversations with lidars on byte streams, all seen alike by the owner of the port.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "config/sources.hpp"
#include "core/base/lidar_params.hpp"
#include "platform/service/live_report.hpp"
#include "platform/service/stream_input.hpp"

namespace crspf {

/// What a conversation wants done with the port.
struct StreamWish {
    enum class Kind : std::uint8_t {
        kNothing,
        kReopen,   ///< close it and open it again, then on_open(); on_close() whenever it is lost
        kSetBaud,  ///< have the line run at `baud`
        kSend,     ///< send `bytes`; on_sent() just before
    };
    Kind kind = Kind::kNothing;
    std::uint32_t baud = 0;
    std::span<const std::uint8_t> bytes;  ///< valid until the next call
};

class StreamTalk : public StreamInput {
 public:
    virtual void on_close(Stamp now) = 0;
    /// At least every 10 ms, before next_wish().
    virtual void on_time(Stamp now) = 0;
    /// To be asked until it is kNothing.
    [[nodiscard]] virtual StreamWish next_wish(Stamp now) = 0;
    [[nodiscard]] virtual bool streaming() const = 0;
    /// What the sensor refused or reported last, for a human; empty: nothing.
    [[nodiscard]] virtual StateText trouble() const = 0;
    /// Model, serial number, firmware, as far as they are known.
    [[nodiscard]] virtual StateText identity() const { return {}; }
};

/// For a source whose driver is kScip, kSick, kLms2xx or kLd06.
[[nodiscard]] std::unique_ptr<StreamTalk> talk_to(const SourceConfig& source, const LidarParams& lidar);

}  // namespace crspf
