#include <algorithm>
#include <optional>

#include "platform/capture/byte_file.hpp"
#include "platform/capture/link_kind.hpp"
#include "platform/capture/pcap_reader.hpp"
#include "platform/capture/pcapng_blocks.hpp"
#include "platform/capture/wire.hpp"

namespace crspf {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kBlockMin = 12;                                      // [bytes] type and twice the length
constexpr std::size_t kBlockMax = CaptureRecord::kBytesMax + (1U << 20U);  // [bytes] a record and its options
constexpr std::size_t kPacketHeader = 20;                                  // [bytes] of an enhanced packet's body
constexpr std::size_t kInterfaceHeader = 8;
constexpr std::size_t kSectionHeaderBytes = 16;
constexpr std::size_t kSourcesMax = 4096;  // a bound on what a hostile file allocates

/// How an interface counts time.
struct TickScale {
    std::uint64_t per_second = 1'000'000;  ///< 0: a resolution that cannot be represented
    std::int64_t offset_s = 0;
};

std::uint64_t ticks_per_second(std::uint8_t resolution) {
    const unsigned exponent = resolution & 0x7FU;
    if ((resolution & 0x80U) != 0) {
        return exponent < 64 ? std::uint64_t{1} << exponent : 0;
    }
    if (exponent > 19) {
        return 0;
    }
    std::uint64_t per_second = 1;
    for (unsigned i = 0; i < exponent; ++i) {
        per_second *= 10;
    }
    return per_second;
}

std::optional<Stamp> stamp_of(std::uint64_t ticks, TickScale scale) {
    constexpr std::int64_t kSecondsMax = 9'000'000'000;  // of what 64 bits of nanoseconds hold
    if (scale.per_second == 0 || scale.offset_s > kSecondsMax || scale.offset_s < -kSecondsMax) {
        return std::nullopt;
    }
    const std::uint64_t whole = ticks / scale.per_second;
    std::uint64_t rest = ticks % scale.per_second;
    // Finer than a nanosecond: the last digits are dropped so that the product below fits.
    while (scale.per_second > std::uint64_t{1} << 33U) {
        scale.per_second /= 2;
        rest /= 2;
    }
    if (whole > static_cast<std::uint64_t>(2 * kSecondsMax)) {
        return std::nullopt;
    }
    const std::int64_t seconds = static_cast<std::int64_t>(whole) + scale.offset_s;
    if (seconds > kSecondsMax || seconds < -kSecondsMax) {
        return std::nullopt;
    }
    return Stamp{seconds * 1'000'000'000 + static_cast<std::int64_t>(rest * 1'000'000'000 / scale.per_second)};
}

/// Calls visit(code, value) for each option; ends quietly where the list is cut off: it has its end within the block.
template <typename Visit>
void for_each_option(Bytes options, wire::Order order, Visit visit) {
    while (options.size() >= 4) {
        const auto code = wire::get<std::uint16_t>(options, 0, order);
        const std::size_t length = wire::get<std::uint16_t>(options, 2, order);
        options = options.subspan(4);
        if (code == pcapng::kOptionEnd || length > options.size()) {
            return;
        }
        visit(code, options.first(length));
        options = options.subspan(std::min((length + 3) / 4 * 4, options.size()));
    }
}

std::string text_of(Bytes bytes) {
    return {bytes.begin(), bytes.end()};
}

class PcapngReader final : public CaptureReader {
 public:
    explicit PcapngReader(UnpackedFile file) : file_(std::move(file)) {}

    bool next(CaptureRecord& record) override {
        while (read_block()) {
            switch (type_) {
                case pcapng::kSectionHeader: begin_section(); break;
                case pcapng::kInterface: add_source(); break;
                case pcapng::kEnhancedPacket:
                    if (fill(record)) {
                        ++counts_.records;
                        return true;
                    }
                    break;
                case pcapng::kSimplePacket: count_unusable("a simple packet has no stamp"); break;
                default: ++counts_.ignored; break;
            }
        }
        return false;
    }

    [[nodiscard]] const std::vector<CaptureSource>& sources() const override { return sources_; }
    [[nodiscard]] const std::string& comment() const override { return comment_; }
    [[nodiscard]] const CaptureCounts& counts() const override { return counts_; }
    [[nodiscard]] double progress() const override { return file_.progress(); }
    [[nodiscard]] const char* format() const override { return "pcapng"; }

 private:
    template <typename T>
    [[nodiscard]] T number(std::size_t at) const {
        return wire::get<T>(body_, at, order_);
    }

    /// The next block into type_ and body_; false at the end, whole or cut short.
    bool read_block() {
        begin_ = file_.offset();
        buffer_.clear();
        if (counts_.cut_short || !read(kBlockMin)) {
            return false;
        }
        // A file system may leave zeros where the power went before the data came.
        if (std::all_of(buffer_.begin(), buffer_.end(), [](std::uint8_t byte) { return byte == 0; })) {
            counts_.cut_short = true;
            return false;
        }
        type_ = wire::get<std::uint32_t>(buffer_, 0, order_);
        if (type_ == pcapng::kSectionHeader) {
            order_ = section_order();
        }
        const std::size_t length = wire::get<std::uint32_t>(buffer_, 4, order_);
        if (length < kBlockMin || length % 4 != 0 || length > kBlockMax) {
            fail("a block of " + std::to_string(length) + " bytes");
        }
        if (!read(length - kBlockMin)) {
            return false;
        }
        if (wire::get<std::uint32_t>(buffer_, length - 4, order_) != length) {
            fail("the two lengths of a block differ");
        }
        body_ = Bytes(buffer_).subspan(8, length - kBlockMin);
        return true;
    }

    bool read(std::size_t n) {
        if (!file_.read(n, buffer_)) {
            counts_.cut_short = counts_.cut_short || !buffer_.empty();
            return false;
        }
        return true;
    }

    [[nodiscard]] wire::Order section_order() const {
        for (const wire::Order order : {wire::Order::kLittle, wire::Order::kBig}) {
            if (wire::get<std::uint32_t>(buffer_, 8, order) == pcapng::kByteOrderMagic) {
                return order;
            }
        }
        fail("a section without a byte order");
    }

    void begin_section() {
        if (body_.size() < kSectionHeaderBytes || number<std::uint16_t>(4) != 1) {
            fail("a section of a version other than 1");
        }
        section_first_ = sources_.size();
        for_each_option(body_.subspan(kSectionHeaderBytes), order_, [&](std::uint16_t code, Bytes value) {
            if (code == pcapng::kOptionComment && comment_.size() + value.size() <= kCommentMax) {
                comment_ += comment_.empty() ? "" : "\n";
                comment_ += text_of(value);
            }
        });
    }

    void add_source() {
        if (body_.size() < kInterfaceHeader || sources_.size() == kSourcesMax) {
            fail(body_.size() < kInterfaceHeader ? "an interface without a link type" : "too many interfaces");
        }
        CaptureSource source;
        TickScale scale;
        source.link = link_kind_of(number<std::uint16_t>(0));
        for_each_option(body_.subspan(kInterfaceHeader), order_, [&](std::uint16_t code, Bytes value) {
            if (code == pcapng::kOptionInterfaceName) {
                source.name = text_of(value);
            } else if (code == pcapng::kOptionInterfaceDescription) {
                source.description = text_of(value);
            } else if (code == pcapng::kOptionInterfaceResolution && value.size() == 1) {
                scale.per_second = ticks_per_second(value[0]);
            } else if (code == pcapng::kOptionInterfaceOffset && value.size() == 8) {
                scale.offset_s = static_cast<std::int64_t>(wire::get<std::uint64_t>(value, 0, order_));
            }
        });
        sources_.push_back(std::move(source));
        scales_.push_back(scale);
    }

    bool fill(CaptureRecord& record) {
        if (body_.size() < kPacketHeader || number<std::uint32_t>(12) > body_.size() - kPacketHeader) {
            return count_unusable("a packet that is longer than its block");
        }
        const std::size_t size = number<std::uint32_t>(12);
        const std::size_t source = section_first_ + number<std::uint32_t>(0);
        if (size > CaptureRecord::kBytesMax) {
            return count_unusable("a packet of " + std::to_string(size) + " bytes");
        }
        if (source >= sources_.size()) {
            return count_unusable("a packet of an interface that is not described");
        }
        const std::uint64_t ticks = std::uint64_t{number<std::uint32_t>(4)} << 32U | number<std::uint32_t>(8);
        const std::optional<Stamp> stamp = stamp_of(ticks, scales_[source]);
        if (!stamp) {
            return count_unusable("a stamp out of range");
        }
        record = {.source = static_cast<std::uint32_t>(source),
                  .link = sources_[source].link,
                  .direction = Direction::kUnknown,
                  .cut = size < number<std::uint32_t>(16),
                  .stamp = *stamp,
                  .bytes = body_.subspan(kPacketHeader, size)};
        const std::size_t padded = std::min((size + 3) / 4 * 4, body_.size() - kPacketHeader);
        for_each_option(body_.subspan(kPacketHeader + padded), order_, [&](std::uint16_t code, Bytes value) {
            if (code == pcapng::kOptionPacketFlags && value.size() == 4) {
                const std::uint32_t flags = wire::get<std::uint32_t>(value, 0, order_) & pcapng::kFlagsDirection;
                record.direction = flags == pcapng::kFlagsReceived ? Direction::kReceived
                                   : flags == pcapng::kFlagsSent   ? Direction::kSent
                                                                   : Direction::kUnknown;
            }
        });
        return true;
    }

    bool count_unusable(const std::string& reason) {
        if (counts_.unusable++ == 0) {
            counts_.first_unusable = file_.at(begin_, reason);
        }
        return false;
    }

    [[noreturn]] void fail(const std::string& reason) const {
        file_.fail(begin_, reason + "; the file is damaged from here on, copy it again or cut it off");
    }

    static constexpr std::size_t kCommentMax = std::size_t{1} << 20U;

    ByteFile file_;
    std::uint64_t begin_ = 0;  ///< of the block that is being read, in the file
    wire::Order order_ = wire::Order::kLittle;
    std::vector<std::uint8_t> buffer_;  ///< the block
    std::uint32_t type_ = 0;
    Bytes body_;                     ///< between its two lengths
    std::size_t section_first_ = 0;  ///< source 0 of this section
    std::vector<CaptureSource> sources_;
    std::vector<TickScale> scales_;  ///< of each source
    std::string comment_;
    CaptureCounts counts_;
};

}  // namespace

bool looks_like_pcapng(std::string_view content) {
    return content.starts_with("\n\r\r\n");
}

std::unique_ptr<CaptureReader> open_pcapng(UnpackedFile file) {
    return std::make_unique<PcapngReader>(std::move(file));
}

}  // namespace crspf
