// Kinds of links and their numbers in pcap and pcapng files.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "platform/capture/capture_reader.hpp"

namespace crspf {

inline constexpr std::array<std::pair<LinkKind, std::uint16_t>, 8> kLinkTypes{{{LinkKind::kEthernet, 1},
                                                                               {LinkKind::kRawIp, 101},
                                                                               {LinkKind::kLinuxCooked, 113},
                                                                               {LinkKind::kStream, 147},
                                                                               {LinkKind::kJournal, 148},
                                                                               {LinkKind::kStereo, 149},
                                                                               {LinkKind::kCan, 227},
                                                                               {LinkKind::kLinuxCooked2, 276}}};

[[nodiscard]] constexpr LinkKind link_kind_of(std::uint32_t link_type) {
    for (const auto& [kind, number] : kLinkTypes) {
        if (number == link_type) {
            return kind;
        }
    }
    return LinkKind::kOther;
}

/// 0 for LinkKind::kOther.
[[nodiscard]] constexpr std::uint16_t link_type_of(LinkKind link) {
    for (const auto& [kind, number] : kLinkTypes) {
        if (kind == link) {
            return number;
        }
    }
    return 0;
}

}  // namespace crspf
