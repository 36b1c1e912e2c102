#include "platform/capture/pcap_reader.hpp"

#include <algorithm>
#include <array>

#include "platform/capture/byte_file.hpp"
#include "platform/capture/link_kind.hpp"
#include "platform/capture/wire.hpp"

namespace crspf {
namespace {

constexpr std::uint32_t kMicroseconds = 0xA1B2C3D4;
constexpr std::uint32_t kNanoseconds = 0xA1B23C4D;
constexpr std::size_t kFileHeader = 24;      // [bytes]
constexpr std::size_t kRecordHeader = 16;    // [bytes]
constexpr std::uint32_t kLinkMask = 0xFFFF;  // the upper half tells of frame check sequences

struct Magic {
    wire::Order order = wire::Order::kLittle;
    bool known = false;
    bool nanoseconds = false;
};

Magic magic_of(std::span<const std::uint8_t> header) {
    for (const wire::Order order : {wire::Order::kLittle, wire::Order::kBig}) {
        const auto number = wire::get<std::uint32_t>(header, 0, order);
        if (number == kMicroseconds || number == kNanoseconds) {
            return {order, true, number == kNanoseconds};
        }
    }
    return {};
}

class PcapReader final : public CaptureReader {
 public:
    explicit PcapReader(UnpackedFile file) : file_(std::move(file)) {
        buffer_.reserve(CaptureRecord::kBytesMax);
        if (!file_.read(kFileHeader, buffer_)) {
            counts_.cut_short = true;
            return;
        }
        magic_ = magic_of(buffer_);
        sources_.push_back({.name = {}, .description = {}, .link = link_kind_of(number(20) & kLinkMask)});
    }

    bool next(CaptureRecord& record) override {
        while (!counts_.cut_short) {
            const std::uint64_t begin = file_.offset();
            buffer_.clear();
            if (!file_.read(kRecordHeader, buffer_)) {
                counts_.cut_short = !buffer_.empty();
                return false;
            }
            const std::uint32_t seconds = number(0);
            const std::uint32_t fraction = number(4);
            const std::uint32_t kept = number(8);
            const std::uint32_t had = number(12);
            // A file system may leave zeros where the power went before the data came.
            if ((seconds | fraction | kept | had) == 0) {
                break;
            }
            if (kept > CaptureRecord::kBytesMax) {
                file_.fail(begin, "a record of " + std::to_string(kept) +
                                      " bytes; the file is damaged from here on, copy it again or cut it off");
            }
            buffer_.clear();
            if (!file_.read(kept, buffer_)) {
                break;
            }
            const std::uint32_t per_second = magic_.nanoseconds ? 1'000'000'000 : 1'000'000;
            if (fraction >= per_second) {
                count_unusable(begin, "its stamp has a fraction of more than a second");
                continue;
            }
            record = {.source = 0,
                      .link = sources_.front().link,
                      .direction = Direction::kUnknown,
                      .cut = kept < had,
                      .stamp = {std::int64_t{seconds} * 1'000'000'000 +
                                std::int64_t{fraction} * (1'000'000'000 / per_second)},
                      .bytes = buffer_};
            ++counts_.records;
            return true;
        }
        counts_.cut_short = true;
        return false;
    }

    [[nodiscard]] const std::vector<CaptureSource>& sources() const override { return sources_; }
    [[nodiscard]] const std::string& comment() const override { return comment_; }
    [[nodiscard]] const CaptureCounts& counts() const override { return counts_; }
    [[nodiscard]] double progress() const override { return file_.progress(); }
    [[nodiscard]] const char* format() const override { return "pcap"; }

 private:
    [[nodiscard]] std::uint32_t number(std::size_t at) const {
        return wire::get<std::uint32_t>(buffer_, at, magic_.order);
    }

    void count_unusable(std::uint64_t at, const std::string& reason) {
        if (counts_.unusable++ == 0) {
            counts_.first_unusable = file_.at(at, reason);
        }
    }

    ByteFile file_;
    Magic magic_;
    std::vector<std::uint8_t> buffer_;
    std::vector<CaptureSource> sources_;
    std::string comment_;
    CaptureCounts counts_;
};

}  // namespace

bool looks_like_pcap(std::string_view content) {
    if (content.size() < sizeof(kMicroseconds)) {
        return false;
    }
    std::array<std::uint8_t, sizeof(kMicroseconds)> first{};
    std::copy_n(content.begin(), first.size(), first.begin());
    return magic_of(first).known;
}

std::unique_ptr<CaptureReader> open_pcap(UnpackedFile file) {
    return std::make_unique<PcapReader>(std::move(file));
}

}  // namespace crspf
