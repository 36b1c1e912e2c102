// How a sensor is, as its own thread tells it: plain values that another thread may hold.
#pragma once

#include "core/base/fixed_text.hpp"
#include "core/base/time.hpp"
#include "platform/capture/source_report.hpp"

namespace crspf {

using StateText = FixedText<160>;

struct LiveReport {
    bool streaming = false;
    StateText state;  ///< for people: "streaming", or why not
    SourceCounts counts;
    Duration blind{};  ///< for how long an odometer has measured nothing
};

}  // namespace crspf
