#include "drivers/sick/lmd_scandata.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
namespace {

constexpr std::size_t kPositionReals = 6;
constexpr std::size_t kEventName = 4;

bool is_channel_name(std::span<const std::uint8_t> text) {
    return text.size() == 5 &&
           std::all_of(text.begin(), text.begin() + 4, [](std::uint8_t c) { return c >= 'A' && c <= 'Z'; }) &&
           text[4] >= '0' && text[4] <= '9';
}

// Reads `count` channels whose values are T. False where they are no channels.
template <typename T>
bool read_channels(ColaFieldReader& in, std::size_t count, std::span<SickChannel> channels, LmdScandata& data,
                   std::size_t& used) {
    for (std::size_t i = 0; i < count; ++i) {
        SickChannel& channel = channels[i];
        const std::span<const std::uint8_t> name = in.text(channel.name.size());
        if (!is_channel_name(name)) {
            return false;
        }
        std::transform(name.begin(), name.end(), channel.name.begin(),
                       [](std::uint8_t c) { return static_cast<char>(c); });
        channel.scale = in.real();
        channel.offset = in.real();
        channel.start_1e4deg = in.number<std::int32_t>();
        channel.step_1e4deg = static_cast<std::int16_t>(in.number<std::uint16_t>());
        channel.count = in.number<std::uint16_t>();
        channel.first = static_cast<std::uint16_t>(used);
        if (!in.ok() || channel.count > data.values.size() - used || !is_finite(static_cast<double>(channel.scale)) ||
            !is_finite(static_cast<double>(channel.offset))) {
            return false;
        }
        in.numbers<T>(std::span(data.values).subspan(used, channel.count));
        used += channel.count;
        if (!in.ok()) {
            return false;
        }
    }
    return true;
}

// A block is there, is not, or the telegram is damaged.
bool read_flag(ColaFieldReader& in, bool& damaged) {
    const auto flag = in.number<std::uint16_t>();
    damaged = damaged || flag > 1;
    return flag == 1;
}

bool read_tail(ColaFieldReader& in, LmdScandata& data) {
    bool damaged = false;
    if (read_flag(in, damaged)) {
        for (std::size_t i = 0; i < kPositionReals; ++i) {
            in.real();
        }
        in.number<std::uint8_t>();  // kind of rotation
    }
    if (read_flag(in, damaged)) {
        in.counted_text();  // name
    }
    if (read_flag(in, damaged)) {
        in.counted_text();  // comment
    }
    data.has_time = read_flag(in, damaged);
    if (data.has_time) {
        data.year = in.number<std::uint16_t>();
        data.month_to_second = {in.number<std::uint8_t>(), in.number<std::uint8_t>(), in.number<std::uint8_t>(),
                                in.number<std::uint8_t>(), in.number<std::uint8_t>()};
        data.microsecond = in.number<std::uint32_t>();
    }
    // Older firmware ends here.
    if (in.left() > 0 && read_flag(in, damaged)) {
        in.text(kEventName);
        in.number<std::uint32_t>();  // encoder
        in.number<std::uint32_t>();  // time
        in.number<std::int32_t>();   // angle
    }
    return in.ok() && !damaged && in.left() == 0;
}

template <typename T>
void write_channels(ColaFieldWriter& out, std::span<const SickChannel> channels, const LmdScandata& data) {
    for (const SickChannel& channel : channels) {
        std::array<std::uint8_t, 5> name{};
        std::transform(channel.name.begin(), channel.name.end(), name.begin(),
                       [](char c) { return static_cast<std::uint8_t>(c); });
        out.text(name);
        out.real(channel.scale);
        out.real(channel.offset);
        out.number(channel.start_1e4deg);
        out.number(static_cast<std::uint16_t>(channel.step_1e4deg));
        out.number(channel.count);
        for (const std::uint16_t value : data.of(channel)) {
            out.number(static_cast<T>(value));
        }
    }
}

}  // namespace

std::span<const std::uint16_t> LmdScandata::of(const SickChannel& one) const {
    if (std::size_t{one.first} + one.count > values.size()) {
        return {};
    }
    return std::span(values).subspan(one.first, one.count);
}

const SickChannel* LmdScandata::find(const SickName& name) const {
    for (const SickChannel& one : std::span(channel).first(std::min<std::size_t>(channels16, channel.size()))) {
        if (one.name == name) {
            return &one;
        }
    }
    return nullptr;
}

bool decode_lmd_scandata(const ColaTelegram& telegram, LmdScandata& data) {
    if (!telegram.is("sSN", "LMDscandata") && !telegram.is("sRA", "LMDscandata")) {
        return false;
    }
    ColaFieldReader in = telegram.fields();
    data.version = in.number<std::uint16_t>();
    data.device = in.number<std::uint16_t>();
    data.serial = in.number<std::uint32_t>();
    data.status = {in.number<std::uint8_t>(), in.number<std::uint8_t>()};
    data.telegram_counter = in.number<std::uint16_t>();
    data.scan_counter = in.number<std::uint16_t>();
    data.start_us = in.number<std::uint32_t>();
    data.transmit_us = in.number<std::uint32_t>();
    data.inputs = {in.number<std::uint8_t>(), in.number<std::uint8_t>()};
    data.outputs = {in.number<std::uint8_t>(), in.number<std::uint8_t>()};
    data.layer = in.number<std::uint16_t>();
    data.scan_frequency_centihertz = in.number<std::uint32_t>();
    data.beam_frequency_hectohertz = in.number<std::uint32_t>();
    data.encoders = in.number<std::uint16_t>();
    if (data.encoders > data.encoder.size()) {
        return false;
    }
    for (std::size_t i = 0; i < data.encoders; ++i) {
        data.encoder[i].ticks = in.number<std::int32_t>();
        data.encoder[i].speed = in.number<std::int16_t>();
    }
    std::size_t used = 0;
    data.channels8 = 0;
    data.channels16 = in.number<std::uint16_t>();
    if (data.channels16 > data.channel.size() ||
        !read_channels<std::uint16_t>(in, data.channels16, data.channel, data, used)) {
        return false;
    }
    data.channels8 = in.number<std::uint16_t>();
    const std::span<SickChannel> others = std::span(data.channel).subspan(data.channels16);
    return data.channels8 <= others.size() && read_channels<std::uint8_t>(in, data.channels8, others, data, used) &&
           read_tail(in, data);
}

std::size_t encode_lmd_scandata(const LmdScandata& data, ColaDialect dialect, std::span<std::uint8_t> out_bytes) {
    ColaFieldWriter out(out_bytes, dialect, "sSN LMDscandata");
    out.number(data.version);
    out.number(data.device);
    out.number(data.serial);
    out.number(data.status[0]);
    out.number(data.status[1]);
    out.number(data.telegram_counter);
    out.number(data.scan_counter);
    out.number(data.start_us);
    out.number(data.transmit_us);
    out.number(data.inputs[0]);
    out.number(data.inputs[1]);
    out.number(data.outputs[0]);
    out.number(data.outputs[1]);
    out.number(data.layer);
    out.number(data.scan_frequency_centihertz);
    out.number(data.beam_frequency_hectohertz);
    out.number(data.encoders);
    const std::size_t channels = std::size_t{data.channels16} + data.channels8;
    if (data.encoders > data.encoder.size() || channels > data.channel.size()) {
        return 0;
    }
    for (std::size_t i = 0; i < data.encoders; ++i) {
        out.number(data.encoder[i].ticks);
        out.number(data.encoder[i].speed);
    }
    out.number(data.channels16);
    write_channels<std::uint16_t>(out, std::span(data.channel).first(data.channels16), data);
    out.number(data.channels8);
    write_channels<std::uint8_t>(out, std::span(data.channel).subspan(data.channels16, data.channels8), data);
    out.number(std::uint16_t{0});  // position
    out.number(std::uint16_t{0});  // name
    out.number(std::uint16_t{0});  // comment
    out.number(static_cast<std::uint16_t>(data.has_time ? 1 : 0));
    if (data.has_time) {
        out.number(data.year);
        for (const std::uint8_t part : data.month_to_second) {
            out.number(part);
        }
        out.number(data.microsecond);
    }
    out.number(std::uint16_t{0});  // event
    return out.ok() ? out.position() : 0;
}

}  // namespace crspf
