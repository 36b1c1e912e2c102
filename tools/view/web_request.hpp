// What an HTTP request says, and what it is told where it may not have what it wants.
#pragma once

#include <libwebsockets.h>

#include "tools/view/access.hpp"

namespace crspf::view {

[[nodiscard]] Request request_of(lws* wsi);
/// A sentence for the one who asked; empty where it was granted.
[[nodiscard]] const char* reason_of(Access access);
/// Of HTTP, where it was not granted.
[[nodiscard]] unsigned status_of(Access access);

}  // namespace crspf::view
