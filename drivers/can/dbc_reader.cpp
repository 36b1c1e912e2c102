#include "drivers/can/dbc_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>  // isfinite
#include <system_error>

namespace crspf {
namespace {

constexpr std::size_t kNameMax = 128;
constexpr std::uint32_t kExtendedBit = 0x80000000;
/// VECTOR__INDEPENDENT_SIG_MSG: signals that no message holds.
constexpr std::uint32_t kPseudoId = 0xC0000000;

constexpr std::array<std::string_view, 34> kKeywords = {"VERSION",
                                                        "NS_",
                                                        "BS_",
                                                        "BU_",
                                                        "BO_",
                                                        "SG_",
                                                        "EV_",
                                                        "CM_",
                                                        "VAL_",
                                                        "VAL_TABLE_",
                                                        "BA_",
                                                        "BA_DEF_",
                                                        "CAT_",
                                                        "CAT_DEF_",
                                                        "FILTER",
                                                        "BA_DEF_DEF_",
                                                        "EV_DATA_",
                                                        "ENVVAR_DATA_",
                                                        "SGTYPE_",
                                                        "SGTYPE_VAL_",
                                                        "BA_DEF_SGTYPE_",
                                                        "BA_SGTYPE_",
                                                        "SIG_TYPE_REF_",
                                                        "SIG_GROUP_",
                                                        "SIG_VALTYPE_",
                                                        "SIGTYPE_VALTYPE_",
                                                        "BO_TX_BU_",
                                                        "BA_DEF_REL_",
                                                        "BA_REL_",
                                                        "BA_DEF_DEF_REL_",
                                                        "BU_SG_REL_",
                                                        "BU_EV_REL_",
                                                        "BU_BO_REL_",
                                                        "SG_MUL_VAL_"};

bool is_keyword(std::string_view name) {
    return std::find(kKeywords.begin(), kKeywords.end(), name) != kKeywords.end();
}

constexpr bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}
constexpr bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
constexpr bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

}  // namespace

DbcReader::DbcReader(std::string_view text) : text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) {  // a byte order mark, which some editors write
        at_ = 3;
    }
    advance();
}

void DbcReader::advance() {
    while (at_ < text_.size() && is_space(text_[at_])) {
        ++at_;
    }
    token_at_ = at_;
    if (at_ == text_.size()) {
        token_ = Token::kEnd;
        word_ = {};
        return;
    }
    const char first = text_[at_];
    ++at_;
    const auto take_while = [&](auto belongs) {
        while (at_ < text_.size() && belongs(text_[at_])) {
            ++at_;
        }
        word_ = text_.substr(token_at_, at_ - token_at_);
    };
    const bool digit_follows = at_ < text_.size() && (is_digit(text_[at_]) || text_[at_] == '.');
    if (is_letter(first)) {
        token_ = Token::kName;
        take_while([](char c) { return is_letter(c) || is_digit(c) || c == '-'; });  // some node names have hyphens
    } else if (is_digit(first) || ((first == '-' || first == '+' || first == '.') && digit_follows)) {
        token_ = Token::kNumber;
        take_while([&](char c) {
            const char before = text_[at_ - 1];
            return is_digit(c) || c == '.' || c == 'e' || c == 'E' ||
                   ((c == '-' || c == '+') && (before == 'e' || before == 'E'));
        });
    } else if (first == '"') {
        token_ = Token::kString;
        while (at_ < text_.size() && (text_[at_] != '"' || text_[at_ - 1] == '\\')) {
            ++at_;
        }
        open_string_ = at_ == text_.size();
        word_ = text_.substr(token_at_ + 1, at_ - token_at_ - 1);
        at_ += open_string_ ? 0 : 1;
    } else {
        token_ = Token::kPunctuation;
        word_ = text_.substr(token_at_, 1);
    }
}

bool DbcReader::fail(const char* reason) {
    const std::string_view before = text_.substr(0, token_at_);
    const std::size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
    error_ = {.line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1,
              .column = token_at_ - line_begin + 1,
              .reason = open_string_ ? "a string that is never closed" : reason};
    stopped_ = Item::kError;
    return false;
}

bool DbcReader::take_mark(char mark, const char* reason) {
    if (!is_mark(mark)) {
        return fail(reason);
    }
    advance();
    return true;
}

bool DbcReader::take_name(std::string_view& name) {
    if (token_ != Token::kName) {
        return fail("expected a name");
    }
    if (word_.size() > kNameMax) {
        return fail("a name of more than 128 characters");
    }
    name = word_;
    advance();
    return true;
}

bool DbcReader::take_string(std::string_view& text) {
    if (token_ != Token::kString || open_string_) {
        return fail("expected a string in quotes");
    }
    text = word_;
    advance();
    return true;
}

bool DbcReader::take_number(double& value) {
    if (token_ != Token::kNumber) {
        return fail("expected a number");
    }
    const std::string_view digits = word_.substr(word_[0] == '+' ? 1 : 0);  // from_chars knows no plus
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (read.ec != std::errc{} || read.ptr != digits.data() + digits.size() || !std::isfinite(value)) {
        return fail("a number that cannot be read");
    }
    advance();
    return true;
}

bool DbcReader::take_unsigned(std::uint32_t& value, const char* reason, std::uint32_t most) {
    const auto read = std::from_chars(word_.data(), word_.data() + word_.size(), value);
    if (token_ != Token::kNumber || read.ec != std::errc{} || read.ptr != word_.data() + word_.size() || value > most) {
        return fail(reason);
    }
    advance();
    return true;
}

// Nodes and receivers: with commas or without, to the next statement.
bool DbcReader::skip_names() {
    std::string_view name;
    while ((token_ == Token::kName && !is_keyword(word_)) || is_mark(',')) {
        if (is_mark(',')) {
            advance();
        } else if (!take_name(name)) {
            return false;
        }
    }
    return true;
}

// NS_: the keywords that the file may use, one by one. The first that something else follows is no longer one of them.
bool DbcReader::skip_symbols() {
    if (!take_mark(':', "expected ':' behind NS_")) {
        return false;
    }
    while (token_ == Token::kName) {
        const std::size_t begin = token_at_;
        advance();
        if (token_ != Token::kName && token_ != Token::kEnd) {
            at_ = begin;
            advance();
            return true;
        }
    }
    return true;
}

// BS_: nothing in most files, else 500:12,34.
bool DbcReader::skip_bit_timing() {
    if (!take_mark(':', "expected ':' behind BS_")) {
        return false;
    }
    while (token_ == Token::kNumber || is_mark(':') || is_mark(',') || is_mark(';')) {
        advance();
    }
    return true;
}

bool DbcReader::skip_statement() {
    while (!is_mark(';')) {
        if (token_ == Token::kEnd || open_string_) {
            return fail("the text ends within a statement; expected ';'");
        }
        advance();
    }
    advance();
    return true;
}

bool DbcReader::read_message() {
    advance();
    const std::size_t id_at = token_at_;
    std::uint32_t id = 0;
    std::uint32_t bytes = 0;
    message_ = {};
    if (!take_unsigned(id, "expected a message id")) {
        return false;
    }
    in_pseudo_ = id == kPseudoId;
    message_.extended = (id & kExtendedBit) != 0;
    message_.id = in_pseudo_ ? 0 : id & ~kExtendedBit;
    if (message_.id > (message_.extended ? 0x1FFFFFFFU : 0x7FFU)) {
        token_at_ = id_at;
        return fail("an id of more than 29 bits, or of more than 11 without bit 31 that marks an extended one");
    }
    if (!take_name(message_.name) || !take_mark(':', "expected ':' behind the message's name")) {
        return false;
    }
    // The longest that J1939 puts together from frames.
    if (!take_unsigned(bytes, "expected the message's length, at most 1785 bytes", 1785)) {
        return false;
    }
    message_.bytes = static_cast<std::uint16_t>(bytes);
    std::string_view sender;
    in_message_ = true;
    return take_name(sender);
}

bool DbcReader::read_multiplexing() {
    if (is_mark(':')) {
        return true;
    }
    if (token_ != Token::kName || (word_[0] != 'M' && word_[0] != 'm')) {
        return fail("expected ':', M or m<number> behind the signal's name");
    }
    std::string_view rest = word_;
    if (rest[0] == 'm') {
        const auto read = std::from_chars(rest.data() + 1, rest.data() + rest.size(), signal_.selection);
        if (read.ec != std::errc{}) {
            return fail("expected a number behind m");
        }
        signal_.selected = true;
        rest.remove_prefix(static_cast<std::size_t>(read.ptr - rest.data()));
    }
    signal_.selector = rest == "M";
    if (!rest.empty() && !signal_.selector) {
        return fail("expected M, m<number> or m<number>M");
    }
    advance();
    return true;
}

bool DbcReader::read_layout() {
    CanSignal& layout = signal_.layout;
    const std::size_t begin = token_at_;
    std::uint32_t start = 0;
    std::uint32_t length = 0;
    std::uint32_t order = 0;
    if (!take_unsigned(start, "expected the start bit") || !take_mark('|', "expected '|' behind the start bit") ||
        !take_unsigned(length, "expected the length") || !take_mark('@', "expected '@' behind the length")) {
        return false;
    }
    if (!take_unsigned(order, "expected the byte order, 0 or 1", 1)) {
        return false;
    }
    if (!is_mark('+') && !is_mark('-')) {
        return fail("expected the sign, + or -");
    }
    layout.type = is_mark('-') ? SignalType::kSigned : SignalType::kUnsigned;
    layout.order = order == 0 ? ByteOrder::kMotorola : ByteOrder::kIntel;
    advance();
    layout.start_bit = static_cast<std::uint16_t>(std::min(start, std::uint32_t{0xFFFF}));
    layout.length = static_cast<std::uint8_t>(std::min(length, std::uint32_t{0xFF}));
    if (!fits(layout, message_.bytes) && !in_pseudo_) {
        token_at_ = begin;
        return fail("the signal has no bits, more than 64, or reaches beyond its message");
    }
    return take_mark('(', "expected '(' before the factor") && take_number(layout.factor) &&
           take_mark(',', "expected ',' between factor and offset") && take_number(layout.offset) &&
           take_mark(')', "expected ')' behind the offset") && take_mark('[', "expected '[' before the minimum") &&
           take_number(layout.minimum) && take_mark('|', "expected '|' between minimum and maximum") &&
           take_number(layout.maximum) && take_mark(']', "expected ']' behind the maximum");
}

bool DbcReader::read_signal() {
    if (!in_message_) {
        return fail("a signal outside of a message");
    }
    advance();
    signal_ = {};
    return take_name(signal_.name) && read_multiplexing() && take_mark(':', "expected ':' behind the signal's name") &&
           read_layout() && take_string(signal_.unit) && skip_names();
}

bool DbcReader::read_value_type() {
    advance();
    std::uint32_t type = 0;
    if (!take_unsigned(value_type_.raw_id, "expected a message id") || !take_name(value_type_.signal)) {
        return false;
    }
    if (is_mark(':')) {  // some writers leave it out
        advance();
    }
    if (!take_unsigned(type, "expected a value type, 0 to 2", 2)) {
        return false;
    }
    value_type_.is_float = type != 0;
    return take_mark(';', "expected ';' behind the value type");
}

bool DbcReader::begin_selection() {
    advance();
    in_selection_ = true;
    return take_unsigned(selection_.raw_id, "expected a message id") && take_name(selection_.signal) &&
           take_name(selection_.selector);
}

bool DbcReader::read_range() {
    // 3-5 reads as the numbers 3 and -5.
    double high = 0.0;
    if (!take_unsigned(selection_.low, "expected a range as in 3-5")) {
        return false;
    }
    if (is_mark('-')) {
        advance();
    }
    const std::size_t high_at = token_at_;
    if (!take_number(high)) {
        return false;
    }
    high = high < 0.0 ? -high : high;
    if (high < static_cast<double>(selection_.low) || high > 4294967295.0) {
        token_at_ = high_at;
        return fail("a range that ends before it begins, or beyond 32 bits");
    }
    selection_.high = static_cast<std::uint32_t>(high);
    if (is_mark(',')) {
        advance();
        return true;
    }
    in_selection_ = false;
    return take_mark(';', "expected ',' or ';' behind the range");
}

DbcReader::Item DbcReader::next() {
    while (stopped_ == Item::kMessage) {
        if (in_selection_) {
            if (read_range() && selection_.raw_id != kPseudoId) {
                return Item::kSelection;
            }
        } else if (token_ == Token::kEnd) {
            stopped_ = Item::kEnd;
        } else if (token_ != Token::kName || !is_keyword(word_)) {
            fail("expected a keyword, as BO_, SG_ or CM_");
        } else if (word_ == "BO_") {
            if (read_message() && !in_pseudo_) {
                return Item::kMessage;
            }
        } else if (word_ == "SG_") {
            if (read_signal() && !in_pseudo_) {
                return Item::kSignal;
            }
        } else {
            in_message_ = false;
            if (word_ == "SIG_VALTYPE_") {
                if (read_value_type() && value_type_.raw_id != kPseudoId) {
                    return Item::kValueType;
                }
            } else if (word_ == "SG_MUL_VAL_") {
                begin_selection();
            } else if (word_ == "VERSION") {
                advance();
                std::string_view version;
                take_string(version);
            } else if (word_ == "NS_") {
                advance();
                skip_symbols();
            } else if (word_ == "BS_") {
                advance();
                skip_bit_timing();
            } else if (word_ == "BU_") {
                advance();
                if (take_mark(':', "expected ':' behind BU_")) {
                    skip_names();
                }
            } else {
                skip_statement();
            }
        }
    }
    return stopped_;
}

}  // namespace crspf
