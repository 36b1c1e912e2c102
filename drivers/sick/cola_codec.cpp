#include "drivers/sick/cola_codec.hpp"

namespace crspf {
namespace {

constexpr std::size_t kKindLength = 3;
constexpr std::uint8_t kLevelAuthorizedClient = 3;
constexpr std::uint32_t kPasswordOfLevel = 0xF4724744;  // hash of the factory's password

std::size_t name_end(std::span<const std::uint8_t> payload) {
    std::size_t end = kKindLength + 1;
    while (end < payload.size() && payload[end] != ' ') {
        ++end;
    }
    return end;
}

struct ReplyForm {
    SickCommand command;
    bool has_verdict;
    std::uint8_t good;
};

ReplyForm form_of(SickCommand command) {
    switch (command) {
        case SickCommand::kLogin:
        case SickCommand::kRun: return {command, true, 1};
        case SickCommand::kConfigureScan:
        case SickCommand::kStartMeasuring: return {command, true, 0};
        default: return {command, false, 0};
    }
}

bool is_method_reply(const ColaTelegram& reply) {
    return spells(reply.kind(), "sAN") || spells(reply.kind(), "sMA");
}

}  // namespace

std::span<const std::uint8_t> ColaTelegram::kind() const {
    return payload.first(payload.size() < kKindLength ? payload.size() : kKindLength);
}

std::span<const std::uint8_t> ColaTelegram::name() const {
    if (payload.size() <= kKindLength + 1 || spells(kind(), "sFA")) {
        return {};
    }
    return payload.subspan(kKindLength + 1, name_end(payload) - kKindLength - 1);
}

ColaFieldReader ColaTelegram::fields() const {
    std::size_t at = spells(kind(), "sFA") || payload.size() < kKindLength ? kind().size() : name_end(payload);
    // CoLa-A reads a space before each field, CoLa-B has one in all.
    if (dialect == ColaDialect::kBinary) {
        ++at;
    }
    return {payload.subspan(at < payload.size() ? at : payload.size()), dialect};
}

bool is_cola_kind(std::span<const std::uint8_t> three) {
    return spells(three, "sSN") || spells(three, "sRA") || spells(three, "sAN") || spells(three, "sWA") ||
           spells(three, "sEA") || spells(three, "sFA") || spells(three, "sMA") || spells(three, "sRN") ||
           spells(three, "sWN") || spells(three, "sMN") || spells(three, "sEN");
}

std::uint8_t cola_sum(std::span<const std::uint8_t> payload) {
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : payload) {
        sum = static_cast<std::uint8_t>(sum ^ byte);
    }
    return sum;
}

std::size_t encode_cola(ColaDialect dialect, std::span<const std::uint8_t> payload, std::span<std::uint8_t> out) {
    ByteWriter writer(out);
    if (dialect == ColaDialect::kBinary) {
        writer.big(std::uint32_t{0x02020202});
        writer.big(static_cast<std::uint32_t>(payload.size()));
        writer.bytes(payload);
        writer.byte(cola_sum(payload));
    } else {
        writer.byte(kColaStart);
        writer.bytes(payload);
        writer.byte(kColaEnd);
    }
    return writer.ok() ? writer.position() : 0;
}

std::size_t encode_command(SickCommand command, ColaDialect dialect, const SickScanConfig& config,
                           std::span<std::uint8_t> out) {
    std::array<std::uint8_t, kLargestColaCommand> payload{};
    const auto framed = [&](const ColaFieldWriter& fields) {
        return fields.ok() ? encode_cola(dialect, std::span(payload).first(fields.position()), out) : 0;
    };
    switch (command) {
        case SickCommand::kLogin: {
            ColaFieldWriter fields(payload, dialect, "sMN SetAccessMode");
            fields.number(kLevelAuthorizedClient);
            fields.number(kPasswordOfLevel);
            return framed(fields);
        }
        case SickCommand::kUseBinary:
        case SickCommand::kUseAscii: {
            ColaFieldWriter fields(payload, dialect, "sWN EIHstCola");
            fields.number(static_cast<std::uint8_t>(command == SickCommand::kUseBinary ? ColaDialect::kBinary
                                                                                       : ColaDialect::kAscii));
            return framed(fields);
        }
        case SickCommand::kConfigureScan: {
            ColaFieldWriter fields(payload, dialect, "sMN mLMPsetscancfg");
            fields.number(config.frequency_centihertz);
            fields.number(std::int16_t{1});  // sectors
            fields.number(config.resolution_1e4deg);
            fields.number(config.start_1e4deg);
            fields.number(config.stop_1e4deg);
            return framed(fields);
        }
        case SickCommand::kConfigureOutput: {
            ColaFieldWriter fields(payload, dialect, "sWN LMDscandatacfg");
            // First echo, a zero, intensities, 16 bit, unit, two bytes of encoders, position, name, comment, time.
            for (const std::uint8_t value : std::array<std::uint8_t, 11>{1, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0}) {
                fields.number(value);
            }
            fields.number(std::uint16_t{1});  // every scan
            return framed(fields);
        }
        case SickCommand::kStartMeasuring: return framed(ColaFieldWriter(payload, dialect, "sMN LMCstartmeas"));
        case SickCommand::kReadStatus: return framed(ColaFieldWriter(payload, dialect, "sRN STlms"));
        case SickCommand::kRun: return framed(ColaFieldWriter(payload, dialect, "sMN Run"));
        case SickCommand::kSubscribe:
        case SickCommand::kUnsubscribe: {
            ColaFieldWriter fields(payload, dialect, "sEN LMDscandata");
            fields.number(static_cast<std::uint8_t>(command == SickCommand::kSubscribe ? 1 : 0));
            return framed(fields);
        }
        case SickCommand::kReadScanConfig: return framed(ColaFieldWriter(payload, dialect, "sRN LMPscancfg"));
    }
    return 0;
}

bool answers(const ColaTelegram& reply, SickCommand command) {
    const std::span<const std::uint8_t> name = reply.name();
    switch (command) {
        case SickCommand::kLogin: return is_method_reply(reply) && spells(name, "SetAccessMode");
        case SickCommand::kUseBinary:
        case SickCommand::kUseAscii: return reply.is("sWA", "EIHstCola");
        case SickCommand::kConfigureScan: return is_method_reply(reply) && spells(name, "mLMPsetscancfg");
        case SickCommand::kConfigureOutput: return reply.is("sWA", "LMDscandatacfg");
        case SickCommand::kStartMeasuring: return is_method_reply(reply) && spells(name, "LMCstartmeas");
        case SickCommand::kReadStatus: return reply.is("sRA", "STlms");
        case SickCommand::kRun: return is_method_reply(reply) && spells(name, "Run");
        case SickCommand::kSubscribe:
        case SickCommand::kUnsubscribe: return reply.is("sEA", "LMDscandata");
        case SickCommand::kReadScanConfig: return reply.is("sRA", "LMPscancfg");
    }
    return false;
}

bool accepted(const ColaTelegram& reply, SickCommand command) {
    const ReplyForm form = form_of(command);
    if (!form.has_verdict) {
        return true;
    }
    ColaFieldReader fields = reply.fields();
    const auto verdict = fields.number<std::uint8_t>();
    return fields.ok() && verdict == form.good;
}

std::uint16_t refusal(const ColaTelegram& reply) {
    if (!spells(reply.kind(), "sFA")) {
        return 0;
    }
    ColaFieldReader wide = reply.fields();
    const auto number = wide.number<std::uint16_t>();
    if (wide.ok()) {
        return number;
    }
    ColaFieldReader narrow = reply.fields();  // some firmware sends one byte
    return narrow.number<std::uint8_t>();
}

const char* refusal_text(std::uint16_t number) {
    static constexpr std::array<const char*, 27> kTexts = {"no reason given",
                                                           "method: access denied at this user level",
                                                           "method: not known to this sensor",
                                                           "variable: not known to this sensor",
                                                           "conditions for the command are not met",
                                                           "invalid data in the command",
                                                           "unknown error",
                                                           "too much data in the command",
                                                           "too little data in the command",
                                                           "unknown type",
                                                           "variable: write access denied at this user level",
                                                           "command not known to the name server",
                                                           "command not known to CoLa",
                                                           "method: server busy",
                                                           "array out of bounds",
                                                           "event: not known to this sensor",
                                                           "value too large for its field (CoLa-A)",
                                                           "invalid character (CoLa-A)",
                                                           "no message",
                                                           "no answer",
                                                           "internal error of the sensor",
                                                           "hub address: corrupted",
                                                           "hub address: decoding",
                                                           "hub address: too many addresses",
                                                           "hub address: blank expected",
                                                           "asynchronous methods are suppressed",
                                                           "complex arrays are not supported"};
    return number < kTexts.size() ? kTexts[number] : "number not listed";
}

}  // namespace crspf
