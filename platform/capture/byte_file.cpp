#include "platform/capture/byte_file.hpp"

#include <algorithm>

#include "platform/files/input_error.hpp"

namespace crspf {

bool ByteFile::read(std::size_t n, std::vector<std::uint8_t>& into) {
    while (n > 0) {
        if (rest_.empty()) {
            const bool more = file_.read_block();
            rest_ = file_.block();
            if (!more) {
                if (!file_.failure().empty()) {
                    fail(offset_,
                         "cannot be read on: " + file_.failure() + "; the file is damaged or cut short, copy it again");
                }
                return false;
            }
        }
        const std::string_view piece = rest_.substr(0, n);
        into.insert(into.end(), piece.begin(), piece.end());
        rest_.remove_prefix(piece.size());
        n -= piece.size();
        offset_ += piece.size();
    }
    return true;
}

std::string ByteFile::at(std::uint64_t at, const std::string& reason) const {
    return file_.name() + ": byte " + std::to_string(at) + ": " + reason;
}

void ByteFile::fail(std::uint64_t at, const std::string& reason) const {
    throw InputError(this->at(at, reason));
}

}  // namespace crspf
