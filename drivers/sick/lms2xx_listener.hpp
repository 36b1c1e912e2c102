// What an LMS2xx says, understood by listening only; see sick_listener.hpp.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/sick/lms2xx_params.hpp"
#include "drivers/sick/lms2xx_parser.hpp"

namespace crspf {

/// Wait-free.
class Lms2xxListener {
 public:
    explicit Lms2xxListener(const Lms2xxParams& params) : params_(params) {}

    /// The port was opened anew.
    void on_open() { parser_.reset(); }

    /// Calls visit(const Lms2xxMessage&, Stamp received, bool scan) for each message; `scan`: it gave a new scan().
    template <typename Visit>
    void on_bytes(std::span<const std::uint8_t> bytes, Stamp received, Visit&& visit) {
        parser_.feed(bytes, received,
                     [&](const Lms2xxMessage& message, Stamp stamp) { visit(message, stamp, on_message(message)); });
    }

    [[nodiscard]] const Lms2xxScan& scan() const { return scan_; }
    /// The sensor has no clock: when scan() began, if it was received so, less its time on the line and its sweep. The
    /// line runs at the configured speed whenever scans come: the session sees to that.
    [[nodiscard]] Stamp beam0(Stamp received) const;
    /// Scans whose count fits no variant or not their length. Never reset.
    [[nodiscard]] std::uint64_t undecodable() const { return undecodable_; }
    [[nodiscard]] const Lms2xxCounters& parser_counters() const { return parser_.counters(); }

 private:
    bool on_message(const Lms2xxMessage& message);

    Lms2xxParams params_;
    Lms2xxParser parser_;
    Lms2xxScan scan_;
    std::uint64_t undecodable_ = 0;
};

}  // namespace crspf
