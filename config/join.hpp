// Text from its parts. Says `join({...})` where a chain of + would do, because GCC 12 warns of those without cause
// (-Wrestrict, GCC bug 105651).
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace crspf {

[[nodiscard]] inline std::string join(std::initializer_list<std::string_view> parts) {
    std::string text;
    for (const std::string_view part : parts) {
        text += part;
    }
    return text;
}

}  // namespace crspf
