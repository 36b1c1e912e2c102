#include "platform/capture/line_source.hpp"

#include <utility>

#include "platform/files/input_error.hpp"

namespace crspf {

LineSource::LineSource(UnpackedFile file) : file_(std::move(file)), block_(file_.block()) {
    if (!file_.failure().empty()) {
        fail();
    }
}

bool LineSource::read_block() {
    const bool more = file_.read_block();
    block_ = file_.block();
    return more;
}

bool LineSource::next(Line& line) {
    carry_.clear();
    line = {};
    bool begun = false;
    while (!block_.empty() || read_block()) {
        const std::size_t end = block_.find('\n');
        const std::string_view piece = block_.substr(0, end);
        block_.remove_prefix(end == block_.npos ? block_.size() : end + 1);
        if (line.too_long || carry_.size() + piece.size() > kLineMax) {
            line.too_long = true;
        } else if (begun || end == piece.npos) {
            carry_ += piece;
        }
        if (end != piece.npos) {
            // Most lines lie within one block and are handed on where they lie.
            line.text = line.too_long ? std::string_view{} : begun ? std::string_view(carry_) : piece;
            ++line_number_;
            return true;
        }
        begun = true;
    }
    if (!file_.failure().empty()) {
        fail();
    }
    if (begun) {
        line.text = line.too_long ? std::string_view{} : std::string_view(carry_);
        ++line_number_;
    }
    return begun;
}

void LineSource::fail() const {
    throw InputError(name() + ":" + std::to_string(line_number_ + 1) + ": cannot be read on: " + file_.failure() +
                     "; the file is damaged or cut short, copy it again");
}

}  // namespace crspf
