// How the evaluations print: the same table and the same JSON keys for all.
#pragma once

#include <nlohmann/json.hpp>

#include "core/base/pose.hpp"
#include "tools/eval/summary.hpp"

namespace crspf::cli {

using Json = nlohmann::ordered_json;

[[nodiscard]] Json to_json(const eval::Summary& s);
[[nodiscard]] Json to_json(const Pose2& pose);
void print_json(const Json& json);

/// Column heads of print_summary.
void print_heading();
void print_summary(const char* name, const eval::Summary& s);
void print_alignment(const Pose2& pose);

/// printf's own results are not looked at one by one: a full disk shows here. Throws InputError.
void check_output();

}  // namespace crspf::cli
