// Parts of the service's status document (docs/service.md), whatever it is that stands there.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace crspf::view {

/// A part of an object; null where it has none, or is none.
inline const nlohmann::ordered_json& part_of(const nlohmann::ordered_json& json, const char* name) {
    static const nlohmann::ordered_json none;
    if (!json.is_object()) {
        return none;
    }
    const auto found = json.find(name);
    return found == json.end() ? none : *found;
}

/// Empty where it is none.
inline std::string text_at(const nlohmann::ordered_json& json, const char* name) {
    const nlohmann::ordered_json& value = part_of(json, name);
    return value.is_string() ? value.get<std::string>() : std::string();
}

/// 0 where it is none.
inline double number_at(const nlohmann::ordered_json& json, const char* name) {
    const nlohmann::ordered_json& value = part_of(json, name);
    return value.is_number() ? value.get<double>() : 0.0;
}

/// Whether a truth stands there, and this one.
inline bool says(const nlohmann::ordered_json& json, const char* name, bool wanted) {
    const nlohmann::ordered_json& value = part_of(json, name);
    return value.is_boolean() && value.get<bool>() == wanted;
}

}  // namespace crspf::view
