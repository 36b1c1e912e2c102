// What the service has to say of itself, for the log.
#pragma once

#include <string>

namespace crspf {

struct ServiceEvent {
    bool bad = false;
    std::string text;  ///< one line
};

}  // namespace crspf
