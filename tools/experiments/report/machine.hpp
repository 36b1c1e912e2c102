// What a measurement of time was made on.
#pragma once

#include <string>
#include <string_view>

namespace crspf::experiments {

/// "AMD EPYC 7B13, 2 cores, Linux 6.1.0-18-amd64".
[[nodiscard]] std::string this_machine();

/// The processor's name in the text of /proc/cpuinfo; empty where there is none.
[[nodiscard]] std::string processor_in(std::string_view cpuinfo);

/// Now, in ISO 8601, UTC.
[[nodiscard]] std::string this_date();

}  // namespace crspf::experiments
