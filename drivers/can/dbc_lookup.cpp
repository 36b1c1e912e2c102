#include "drivers/can/dbc_lookup.hpp"

namespace crspf {
namespace {

/// What one pass over the text has gathered so far.
struct Search {
    std::string_view message_name;
    std::string_view signal_name;
    bool in_message = false;  ///< reading its signals
    bool message_found = false;
    bool signal_found = false;
    bool selector_found = false;
    bool bad_multiplex = false;
    bool is_float = false;
    bool extended_ranges = false;  ///< SG_MUL_VAL_ overrules m<k>
    std::uint32_t raw_id = 0;
    DbcSignal wanted;
    DbcSignal selector;
    FrameSignal out;

    void on_message(const DbcMessage& message) {
        in_message = !message_found && message.name == message_name;
        if (in_message) {
            message_found = true;
            out.id = message.id;
            out.extended = message.extended;
            raw_id = message.id | (message.extended ? 0x80000000U : 0U);
        }
    }
    void on_signal(const DbcSignal& signal) {
        if (!in_message) {
            return;
        }
        if (!signal_found && signal.name == signal_name) {
            signal_found = true;
            wanted = signal;
            out.layout = signal.layout;
        }
        if (signal.selector && signal.selected) {
            // Which selector rules which signal is then told by SG_MUL_VAL_ only, and down more than one step.
            bad_multiplex = true;
        } else if (signal.selector && !selector_found) {
            selector_found = true;
            selector = signal;
        }
    }
    void on_value_type(const DbcValueType& type) {
        if (signal_found && type.raw_id == raw_id && type.signal == wanted.name) {
            is_float = type.is_float;
        }
    }
    void on_selection(const DbcSelection& selection) {
        if (!signal_found || selection.raw_id != raw_id || selection.signal != wanted.name) {
            return;
        }
        if (selection.selector != selector.name || out.range_count == out.ranges.size()) {
            bad_multiplex = true;
            return;
        }
        extended_ranges = true;
        out.ranges[out.range_count++] = {.low = selection.low, .high = selection.high};
    }

    [[nodiscard]] DbcLookup::Status finish() {
        if (!message_found) {
            return DbcLookup::Status::kNoMessage;
        }
        if (!signal_found) {
            return DbcLookup::Status::kNoSignal;
        }
        if (wanted.selected) {
            if (!selector_found || bad_multiplex) {
                return DbcLookup::Status::kMultiplex;
            }
            out.selector = selector.layout;
            if (!extended_ranges) {
                out.ranges[0] = {.low = wanted.selection, .high = wanted.selection};
                out.range_count = 1;
            }
        }
        if (is_float) {
            if (out.layout.length != 32 && out.layout.length != 64) {
                return DbcLookup::Status::kFloat;
            }
            out.layout.type = out.layout.length == 32 ? SignalType::kFloat32 : SignalType::kFloat64;
        }
        return DbcLookup::Status::kFound;
    }
};

}  // namespace

DbcLookup find_signal(std::string_view text, std::string_view message, std::string_view signal) {
    Search search;
    search.message_name = message;
    search.signal_name = signal;
    DbcLookup found;
    DbcReader reader(text);
    while (true) {
        switch (reader.next()) {
            case DbcReader::Item::kMessage: search.on_message(reader.message()); break;
            case DbcReader::Item::kSignal: search.on_signal(reader.signal()); break;
            case DbcReader::Item::kValueType: search.on_value_type(reader.value_type()); break;
            case DbcReader::Item::kSelection: search.on_selection(reader.selection()); break;
            case DbcReader::Item::kError:
                found.status = DbcLookup::Status::kBadText;
                found.error = reader.error();
                return found;
            case DbcReader::Item::kEnd:
                found.status = search.finish();
                found.signal = search.out;
                found.unit = search.wanted.unit;
                return found;
        }
    }
}

}  // namespace crspf
