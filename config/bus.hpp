// The signals of a CAN source, found in its DBC and put together to what they are to the odometry.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "config/sources.hpp"

namespace crspf {

struct DbcText {
    std::string name;  ///< for messages: "FILE" or "dbc_text"
    std::string text;
};

/// Fills `odometer`, and `dbc_text` with what the signals need. A message is sought in each text in turn.
/// @param problem told what is wrong, with the role (empty: the source as a whole) and the key it is about
void resolve_bus(
    CanSourceConfig& can, const std::vector<DbcText>& texts,
    const std::function<void(std::string_view role, std::string_view key, const std::string& text)>& problem);

}  // namespace crspf
