#include "platform/capture/source_report.hpp"

namespace crspf {

std::string text_of(const SourceReport& source) {
    std::string text = source.name + ": " + std::to_string(source.records) + " records";
    for (const auto& [name, count] : source.counts) {
        if (count > 0) {
            text += std::string(", ") + name + " " + std::to_string(count);
        }
    }
    return text;
}

}  // namespace crspf
