// What is wrong with a configuration file, place by place.
#pragma once

#include <toml++/toml.h>

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace crspf {

class Problems {
 public:
    /// @param name of the file, for the messages
    explicit Problems(std::string_view name) : name_(name) {}

    void add(const toml::source_position& at, std::initializer_list<std::string_view> text);
    /// InputError with all of them, in the order of their places.
    void throw_if_any();
    [[nodiscard]] std::string_view file() const { return name_; }

 private:
    struct Problem {
        toml::source_position at;
        std::string text;
    };

    std::string_view name_;
    std::vector<Problem> problems_;
};

}  // namespace crspf
