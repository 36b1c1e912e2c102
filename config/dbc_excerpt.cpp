#include "config/dbc_excerpt.hpp"

#include <algorithm>
#include <cstdint>

#include "config/join.hpp"
#include "config/parameters.hpp"
#include "drivers/can/dbc_reader.hpp"

namespace crspf {

namespace {

constexpr std::uint32_t kExtendedBit = std::uint32_t{1} << 31U;

std::string signal_line(const DbcSignal& signal) {
    const CanSignal& layout = signal.layout;
    const std::string selection = signal.selected ? join({" m", std::to_string(signal.selection)}) : std::string();
    const char* const selector = signal.selector ? (signal.selected ? "M" : " M") : "";
    return join({" SG_ ",
                 signal.name,
                 selection,
                 selector,
                 " : ",
                 std::to_string(layout.start_bit),
                 "|",
                 std::to_string(layout.length),
                 "@",
                 layout.order == ByteOrder::kIntel ? "1" : "0",
                 layout.type == SignalType::kUnsigned ? "+" : "-",
                 " (",
                 real_text(layout.factor),
                 ",",
                 real_text(layout.offset),
                 ") [",
                 real_text(layout.minimum),
                 "|",
                 real_text(layout.maximum),
                 "] \"",
                 signal.unit,
                 "\" Vector__XXX\n"});
}

}  // namespace

std::string dbc_excerpt(std::string_view text,
                        const std::vector<std::pair<std::string_view, std::string_view>>& signals) {
    const auto wanted_message = [&](std::string_view message) {
        return std::any_of(signals.begin(), signals.end(), [&](const auto& s) { return s.first == message; });
    };
    const auto wanted = [&](std::string_view message, std::string_view signal) {
        return std::find(signals.begin(), signals.end(), std::pair(message, signal)) != signals.end();
    };
    std::string out;
    std::vector<std::pair<std::uint32_t, std::string_view>> messages;  // raw id, name
    const auto message_of = [&](std::uint32_t raw_id) -> std::string_view {
        const auto found =
            std::find_if(messages.begin(), messages.end(), [&](const auto& m) { return m.first == raw_id; });
        return found == messages.end() ? std::string_view{} : found->second;
    };
    std::vector<std::pair<std::string_view, std::string_view>> doubles;  // message, signal: 64 bits
    bool in_wanted = false;
    std::string_view message;
    DbcReader reader(text);
    for (;;) {
        switch (reader.next()) {
            case DbcReader::Item::kMessage: {
                const DbcMessage& m = reader.message();
                in_wanted = wanted_message(m.name);
                message = m.name;
                if (in_wanted) {
                    const std::uint32_t raw_id = m.id | (m.extended ? kExtendedBit : 0U);
                    messages.emplace_back(raw_id, m.name);
                    out += join(
                        {"BO_ ", std::to_string(raw_id), " ", m.name, ": ", std::to_string(m.bytes), " Vector__XXX\n"});
                }
                break;
            }
            case DbcReader::Item::kSignal:
                if (in_wanted && (reader.signal().selector || wanted(message, reader.signal().name))) {
                    out += signal_line(reader.signal());
                    if (reader.signal().layout.length == 64) {
                        doubles.emplace_back(message, reader.signal().name);
                    }
                }
                break;
            case DbcReader::Item::kValueType:
                if (const DbcValueType& v = reader.value_type(); v.is_float && wanted(message_of(v.raw_id), v.signal)) {
                    const bool is_double = std::find(doubles.begin(), doubles.end(),
                                                     std::pair(message_of(v.raw_id), v.signal)) != doubles.end();
                    out += join(
                        {"SIG_VALTYPE_ ", std::to_string(v.raw_id), " ", v.signal, is_double ? " : 2;\n" : " : 1;\n"});
                }
                break;
            case DbcReader::Item::kSelection:
                if (const DbcSelection& s = reader.selection(); wanted(message_of(s.raw_id), s.signal)) {
                    out += join({"SG_MUL_VAL_ ", std::to_string(s.raw_id), " ", s.signal, " ", s.selector, " ",
                                 std::to_string(s.low), "-", std::to_string(s.high), ";\n"});
                }
                break;
            case DbcReader::Item::kEnd:
            case DbcReader::Item::kError: return out;
        }
    }
}

}  // namespace crspf
