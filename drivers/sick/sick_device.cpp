#include "drivers/sick/sick_device.hpp"

namespace crspf {
namespace {

constexpr std::uint8_t kAccessDenied = 1;
constexpr std::uint8_t kUnknownMethod = 2;
constexpr std::uint8_t kUnknownVariable = 3;
constexpr std::uint8_t kUnknownCommand = 12;
constexpr std::uint16_t kBusy = 1;

}  // namespace

void SickDevice::on_connect() {
    params_.dialect = next_dialect_;
    parser_.reset();
    streams_ = false;
    logged_in_ = false;
    out_size_ = 0;
}

void SickDevice::on_bytes(std::span<const std::uint8_t> bytes, Stamp now) {
    if (now - power_on_ < params_.silence) {
        return;
    }
    parser_.feed(bytes, now, [this](const ColaTelegram& telegram, Stamp stamp) {
        if (telegram.dialect == params_.dialect) {
            on_command(telegram, stamp);
        }
    });
}

void SickDevice::reply(const ColaFieldWriter& fields) {
    const std::size_t size =
        encode_cola(params_.dialect, std::span(payload_).first(fields.position()), std::span(out_).subspan(out_size_));
    if (!fields.ok() || size == 0) {
        ++output_dropped_;
        return;
    }
    out_size_ += size;
}

void SickDevice::refuse(std::uint8_t number) {
    ColaFieldWriter fields(payload_, params_.dialect, "sFA");
    fields.number(number);
    reply(fields);
}

void SickDevice::on_command(const ColaTelegram& telegram, Stamp now) {
    ColaFieldReader in = telegram.fields();
    if (telegram.is("sMN", "SetAccessMode")) {
        const auto level = in.number<std::uint8_t>();
        const auto password = in.number<std::uint32_t>();
        logged_in_ = params_.takes_password && in.ok() && level == 3 && password == 0xF4724744;
        ColaFieldWriter out(payload_, params_.dialect, "sAN SetAccessMode");
        out.number(static_cast<std::uint8_t>(logged_in_ ? 1 : 0));
        return reply(out);
    }
    if (telegram.is("sRN", "STlms")) {
        if (!params_.knows_status) {
            return refuse(kUnknownVariable);
        }
        ColaFieldWriter out(payload_, params_.dialect, "sRA STlms");
        out.number(now - power_on_ < params_.until_ready ? kBusy : kSickReady);
        out.number(std::uint8_t{0});
        return reply(out);
    }
    if (telegram.is("sMN", "Run")) {
        logged_in_ = false;
        ColaFieldWriter out(payload_, params_.dialect, "sAN Run");
        out.number(std::uint8_t{1});
        return reply(out);
    }
    if (telegram.is("sEN", "LMDscandata")) {
        const bool on = in.number<std::uint8_t>() == 1 && in.ok();
        streams_ = on;
        next_scan_ = now;
        ColaFieldWriter out(payload_, params_.dialect, "sEA LMDscandata");
        out.number(static_cast<std::uint8_t>(on ? 1 : 0));
        return reply(out);
    }
    if (!spells(telegram.kind(), "sMN") && !spells(telegram.kind(), "sWN")) {
        return refuse(kUnknownCommand);
    }
    if (!logged_in_) {
        return refuse(kAccessDenied);
    }
    if (telegram.is("sWN", "EIHstCola")) {
        const auto dialect = in.number<std::uint8_t>();
        next_dialect_ = dialect == 1 ? ColaDialect::kBinary : ColaDialect::kAscii;
        return reply(ColaFieldWriter(payload_, params_.dialect, "sWA EIHstCola"));
    }
    if (telegram.is("sMN", "mLMPsetscancfg") && params_.knows_scan_config) {
        scan_config_.frequency_centihertz = in.number<std::uint32_t>();
        in.number<std::int16_t>();
        scan_config_.resolution_1e4deg = in.number<std::uint32_t>();
        scan_config_.start_1e4deg = in.number<std::int32_t>();
        scan_config_.stop_1e4deg = in.number<std::int32_t>();
        ColaFieldWriter out(payload_, params_.dialect, "sAN mLMPsetscancfg");
        out.number(static_cast<std::uint8_t>(in.ok() ? 0 : 5));
        return reply(out);
    }
    if (telegram.is("sWN", "LMDscandatacfg")) {
        return reply(ColaFieldWriter(payload_, params_.dialect, "sWA LMDscandatacfg"));
    }
    if (telegram.is("sMN", "LMCstartmeas")) {
        ColaFieldWriter out(payload_, params_.dialect, "sAN LMCstartmeas");
        out.number(std::uint8_t{0});
        return reply(out);
    }
    refuse(kUnknownMethod);
}

void SickDevice::on_time(Stamp now) {
    if (!streams_ || now < next_scan_ || measurement_.scan_frequency_centihertz == 0) {
        return;
    }
    const Duration period{100'000'000'000 / static_cast<std::int64_t>(measurement_.scan_frequency_centihertz)};
    // A scan that is due now began one period ago.
    const Stamp began = next_scan_ - period;
    next_scan_ = next_scan_ + period;
    on_sweep(began, now);
}

void SickDevice::on_sweep(Stamp began, Stamp now) {
    if (!streams_) {
        return;
    }
    measurement_.start_us = params_.clock_start_us + static_cast<std::uint32_t>((began - power_on_).ns / 1000);
    measurement_.transmit_us = params_.clock_start_us + static_cast<std::uint32_t>((now - power_on_).ns / 1000);
    ++measurement_.telegram_counter;
    ++measurement_.scan_counter;
    const std::size_t size = encode_lmd_scandata(measurement_, params_.dialect, payload_);
    const std::size_t framed =
        size == 0 ? 0
                  : encode_cola(params_.dialect, std::span(payload_).first(size), std::span(out_).subspan(out_size_));
    output_dropped_ += framed == 0 ? 1 : 0;
    out_size_ += framed;
}

}  // namespace crspf
