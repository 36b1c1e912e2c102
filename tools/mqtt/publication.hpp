// A message for a broker.
#pragma once

#include <string>

namespace crspf::mqtt {

struct Publication {
    std::string topic;
    std::string payload;        ///< JSON; empty and retained: the broker forgets what it has kept
    bool acknowledged = false;  ///< QoS 1, else QoS 0
    bool retained = false;      ///< the broker keeps it, for who subscribes later
};

}  // namespace crspf::mqtt
