// Reads the text of a DBC file: the messages of a bus and the signals in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/can/can_signal.hpp"

namespace crspf {

struct DbcMessage {
    std::string_view name;
    std::uint32_t id = 0;  ///< 11 bits, or 29 where `extended`
    bool extended = false;
    std::uint16_t bytes = 0;  ///< payload
};

struct DbcSignal {
    std::string_view name;
    std::string_view unit;  ///< as written; escapes are left in
    CanSignal layout;       ///< integers: SIG_VALTYPE_, which says that they are floats, comes later in the file
    bool selector = false;  ///< M: its value says which other signals are in the frame
    bool selected = false;  ///< m<k>: in the frame only while the selector is `selection`
    std::uint32_t selection = 0;
};

/// SIG_VALTYPE_: the signal is a float of its length, or an integer after all.
struct DbcValueType {
    std::uint32_t raw_id = 0;  ///< as in the text, bit 31 for extended
    std::string_view signal;
    bool is_float = false;
};

/// SG_MUL_VAL_, one for each of its ranges: the signal is in the frame while `selector` is within [low, high].
struct DbcSelection {
    std::uint32_t raw_id = 0;
    std::string_view signal;
    std::string_view selector;
    std::uint32_t low = 0;
    std::uint32_t high = 0;
};

/// Where reading stopped, and why.
struct DbcError {
    std::size_t line = 0;    ///< from 1
    std::size_t column = 0;  ///< from 1 [bytes]
    const char* reason = nullptr;
};

/// A pull parser. Every statement is read through to its end; comments, attributes, value tables and the like are
/// passed over. The pseudo message VECTOR__INDEPENDENT_SIG_MSG and what belongs to it are not delivered: no frame
/// carries them. Names may have up to 128 characters. The text must outlive the reader and what it delivers.
/// No heap, no throw; time linear in the text.
class DbcReader {
 public:
    enum class Item : std::uint8_t { kMessage, kSignal, kValueType, kSelection, kEnd, kError };

    explicit DbcReader(std::string_view text);

    /// The next item. kEnd and kError stay. A signal belongs to the message before it.
    Item next();

    [[nodiscard]] const DbcMessage& message() const { return message_; }
    [[nodiscard]] const DbcSignal& signal() const { return signal_; }
    [[nodiscard]] const DbcValueType& value_type() const { return value_type_; }
    [[nodiscard]] const DbcSelection& selection() const { return selection_; }
    [[nodiscard]] const DbcError& error() const { return error_; }

 private:
    enum class Token : std::uint8_t { kName, kNumber, kString, kPunctuation, kEnd };

    void advance();
    [[nodiscard]] bool is_name(std::string_view name) const { return token_ == Token::kName && word_ == name; }
    [[nodiscard]] bool is_mark(char mark) const { return token_ == Token::kPunctuation && word_[0] == mark; }
    bool fail(const char* reason);

    bool take_mark(char mark, const char* reason);
    bool take_name(std::string_view& name);
    bool take_string(std::string_view& text);
    bool take_number(double& value);
    bool take_unsigned(std::uint32_t& value, const char* reason, std::uint32_t most = 0xFFFFFFFF);
    bool skip_names();
    bool skip_symbols();
    bool skip_bit_timing();
    bool skip_statement();

    bool read_message();
    bool read_signal();
    bool read_multiplexing();
    bool read_layout();
    bool read_value_type();
    bool begin_selection();
    bool read_range();

    std::string_view text_;
    std::size_t at_ = 0;  ///< behind the token
    Token token_ = Token::kEnd;
    std::string_view word_;      ///< the token; of a string what lies between the quotes
    std::size_t token_at_ = 0;   ///< where it begins
    bool open_string_ = false;   ///< the text ends within a string
    bool in_message_ = false;    ///< a BO_ has been read and nothing but SG_ since
    bool in_pseudo_ = false;     ///< and it was no frame's
    bool in_selection_ = false;  ///< within the ranges of a SG_MUL_VAL_
    Item stopped_ = Item::kMessage;

    DbcMessage message_;
    DbcSignal signal_;
    DbcValueType value_type_;
    DbcSelection selection_;
    DbcError error_;
};

}  // namespace crspf
