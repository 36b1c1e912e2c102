#include "platform/linux/proc_text.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

#include "platform/files/fields.hpp"
#include "platform/files/unique_fd.hpp"

namespace crspf {
namespace {

constexpr std::size_t kBytesMax = 65536;
constexpr int kCpusMax = 8192;  // the kernel's own bound

}  // namespace

std::optional<std::string> read_text(const std::filesystem::path& file) {
    // O_NONBLOCK: a pipe that somebody put there must not stop us.
    const UniqueFd fd(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (!fd.valid()) {
        return std::nullopt;
    }
    std::string text(kBytesMax, '\0');
    std::size_t filled = 0;
    while (filled < text.size()) {
        const ssize_t got = ::read(fd.get(), text.data() + filled, text.size() - filled);
        if (got < 0) {
            return std::nullopt;
        }
        if (got == 0) {
            break;
        }
        filled += static_cast<std::size_t>(got);
    }
    text.resize(filled);
    text.erase(text.find_last_not_of(" \t\n") + 1);
    return text;
}

std::string_view word_after(std::string_view text, std::string_view label) {
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        if (line.starts_with(label)) {
            return Fields(line.substr(label.size())).word();
        }
        text.remove_prefix(std::min(line.size() + 1, text.size()));
    }
    return {};
}

std::optional<std::uint64_t> to_number(std::string_view word, int base) {
    if (word == "unlimited") {
        return std::numeric_limits<std::uint64_t>::max();
    }
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, base);
    return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

std::vector<int> parse_cpu_list(std::string_view text) {
    std::vector<int> cpus;
    while (!text.empty()) {
        const std::string_view item = text.substr(0, text.find(','));
        text.remove_prefix(std::min(item.size() + 1, text.size()));
        const std::size_t dash = item.find('-');
        const std::optional<std::uint64_t> first = to_number(item.substr(0, dash));
        const std::optional<std::uint64_t> last =
            dash == std::string_view::npos ? first : to_number(item.substr(dash + 1));
        if (!first || !last || *last < *first || *last >= kCpusMax) {
            return {};
        }
        for (std::uint64_t cpu = *first; cpu <= *last; ++cpu) {
            cpus.push_back(static_cast<int>(cpu));
        }
    }
    return cpus;
}

}  // namespace crspf
