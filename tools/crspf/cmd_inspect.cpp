// crspf inspect: what a recording of sensors holds.
#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/config.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/capture/frames.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/eval_output.hpp"
#include "tools/crspf/inspect_samples.hpp"

namespace crspf::cli {
namespace {

/// Records of one kind: a source's, or those of one flow of datagrams or one CAN identifier within it.
struct Flow {
    std::uint64_t records = 0;
    std::uint64_t bytes = 0;
    std::uint64_t ran_back = 0;  ///< stamps before the one before
    Stamp first;
    Stamp last;
    Duration longest_gap;
    Stamp gap_at;

    void add(Stamp stamp, std::size_t size) {
        if (records == 0) {
            first = last = stamp;
        }
        if (stamp < last) {
            ++ran_back;
        } else {
            if (stamp - last > longest_gap) {
                longest_gap = stamp - last;
                gap_at = last;
            }
            last = stamp;
        }
        ++records;
        bytes += size;
    }
    /// [1/s] 0 where there is no time between them.
    [[nodiscard]] double rate() const {
        const double span_s = (last - first).seconds();
        return records > 1 && span_s > 0.0 ? static_cast<double>(records - 1) / span_s : 0.0;
    }
};

struct PortReport {
    Flow all;
    std::uint64_t sent = 0;
    std::uint64_t cut = 0;
    std::uint64_t damaged = 0;  ///< frames whose headers contradict themselves
    std::map<std::string, Flow> flows;
};

struct FileReport {
    std::vector<CaptureSource> sources;
    std::vector<PortReport> reports;
    CaptureCounts counts;
    std::string format;
    std::string comment;
};

const char* name_of(LinkKind link) {
    switch (link) {
        case LinkKind::kEthernet: return "Ethernet";
        case LinkKind::kRawIp: return "IP";
        case LinkKind::kLinuxCooked:
        case LinkKind::kLinuxCooked2: return "Linux cooked";
        case LinkKind::kCan: return "CAN";
        case LinkKind::kStream: return "bytes";
        case LinkKind::kJournal: return "journal";
        case LinkKind::kStereo: return "pairs of pictures";
        case LinkKind::kOther: break;
    }
    return "other";
}

std::string address_text(std::uint32_t address, std::uint16_t port) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%u.%u.%u.%u:%u", address >> 24U, (address >> 16U) & 0xFFU,
                  (address >> 8U) & 0xFFU, address & 0xFFU, static_cast<unsigned>(port));
    return text.data();
}

/// Which flow of its source a record belongs to; empty where sources are not divided.
std::string flow_of(const CaptureRecord& record, PortReport& source, std::size_t& payload) {
    payload = record.bytes.size();
    if (record.link == LinkKind::kStream || record.link == LinkKind::kJournal || record.link == LinkKind::kOther) {
        return {};
    }
    CanFrame frame;
    const FrameContent can = record.link == LinkKind::kEthernet || record.link == LinkKind::kRawIp
                                 ? FrameContent::kOther
                                 : can_of(record.link, record.bytes, frame);
    if (can == FrameContent::kFound) {
        payload = frame.length;
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), frame.extended ? "%08" PRIX32 "%s" : "%03" PRIX32 "%s", frame.id,
                      frame.error ? " error" : (frame.remote ? " remote" : ""));
        return text.data();
    }
    UdpDatagram datagram;
    const FrameContent udp =
        record.link == LinkKind::kCan ? FrameContent::kOther : udp_of(record.link, record.bytes, datagram);
    if (udp == FrameContent::kFound) {
        payload = datagram.payload.size();
        return address_text(datagram.source_address, datagram.source_port) + " -> " +
               address_text(datagram.destination_address, datagram.destination_port) + ", " + std::to_string(payload) +
               " bytes";
    }
    source.damaged += can == FrameContent::kDamaged || udp == FrameContent::kDamaged ? 1 : 0;
    return udp == FrameContent::kFragment ? "fragments of datagrams" : "neither UDP nor CAN";
}

FileReport inspect(const std::filesystem::path& file) {
    FileReport out;
    const std::unique_ptr<CaptureReader> capture = open_capture(file);
    CaptureRecord record;
    while (capture->next(record)) {
        out.reports.resize(capture->sources().size());
        PortReport& source = out.reports.at(record.source);
        source.all.add(record.stamp, record.bytes.size());
        source.sent += record.direction == Direction::kSent ? 1 : 0;
        source.cut += record.cut ? 1 : 0;
        std::size_t payload = 0;
        const std::string flow = flow_of(record, source, payload);
        if (!flow.empty()) {
            source.flows[flow].add(record.stamp, payload);
        }
    }
    out.sources = capture->sources();
    out.reports.resize(out.sources.size());
    out.counts = capture->counts();
    out.format = capture->format();
    out.comment = capture->comment();
    return out;
}

Json as_json(const Flow& flow) {
    return {{"records", flow.records},
            {"bytes", flow.bytes},
            {"first_s", static_cast<double>(flow.first.ns) * 1e-9},
            {"last_s", static_cast<double>(flow.last.ns) * 1e-9},
            {"rate_hz", flow.rate()},
            {"longest_gap_s", flow.longest_gap.seconds()},
            {"stamps_ran_back", flow.ran_back}};
}

Json as_json(const std::filesystem::path& file, const FileReport& report) {
    Json sources = Json::array();
    for (std::size_t i = 0; i < report.sources.size(); ++i) {
        const PortReport& source = report.reports[i];
        Json one = {{"name", report.sources[i].name},
                    {"description", report.sources[i].description},
                    {"link", name_of(report.sources[i].link)}};
        one.update(as_json(source.all));
        one["sent"] = source.sent;
        one["cut"] = source.cut;
        one["damaged"] = source.damaged;
        for (const auto& [name, flow] : source.flows) {
            one["flows"][name] = as_json(flow);
        }
        sources.push_back(one);
    }
    return {{"file", file.string()},
            {"format", report.format},
            {"records", report.counts.records},
            {"ignored", report.counts.ignored},
            {"unusable", report.counts.unusable},
            {"first_unusable", report.counts.first_unusable},
            {"cut_short", report.counts.cut_short},
            {"comment", report.comment},
            {"sources", sources}};
}

void print_flow(const std::string& name, const Flow& flow) {
    std::printf("  %-52s %9" PRIu64 " %12" PRIu64 " %10.2f %12.6f", name.c_str(), flow.records, flow.bytes, flow.rate(),
                flow.longest_gap.seconds());
    if (flow.records > 1) {
        std::printf(" %9.3f", (flow.gap_at - flow.first).seconds());
    }
    std::puts("");
}

void print(const std::filesystem::path& file, const FileReport& report) {
    std::printf("%s: %s, %" PRIu64 " records, %zu sources\n", file.c_str(), report.format.c_str(),
                report.counts.records, report.sources.size());
    if (report.counts.cut_short) {
        std::puts("  the file ends within a record: its writer was stopped; all before that was read");
    }
    if (report.counts.unusable > 0) {
        std::printf("  %" PRIu64 " unusable, the first: %s\n", report.counts.unusable,
                    report.counts.first_unusable.c_str());
    }
    std::printf("  %-52s %9s %12s %10s %12s %9s\n", "source", "records", "bytes", "[1/s]", "gap [s]", "at [s]");
    for (std::size_t i = 0; i < report.sources.size(); ++i) {
        const PortReport& source = report.reports[i];
        const std::string name = report.sources[i].name.empty() ? std::to_string(i) : report.sources[i].name;
        print_flow(name + " (" + name_of(report.sources[i].link) + ")", source.all);
        for (const auto& [flow, counts] : source.flows) {
            print_flow("  " + flow, counts);
        }
        if (source.all.records > 0) {
            std::printf("    first stamp %.6f s, last %.6f s", static_cast<double>(source.all.first.ns) * 1e-9,
                        static_cast<double>(source.all.last.ns) * 1e-9);
        }
        for (const auto& [count, what] :
             {std::pair{source.sent, "sent"}, std::pair{source.cut, "cut"}, std::pair{source.damaged, "damaged"},
              std::pair{source.all.ran_back, "stamps run back"}}) {
            if (count > 0) {
                std::printf(", %" PRIu64 " %s", count, what);
            }
        }
        std::puts("");
    }
}

struct InspectOptions {
    std::vector<std::filesystem::path> files;
    bool json = false;
    bool decode = false;
    std::string config;
};

void run(const InspectOptions& options) {
    if (options.decode) {
        print_samples(options.files,
                      options.config.empty() ? std::nullopt : std::optional(load_config(options.config)));
        check_output();
        return;
    }
    Json all = Json::array();
    for (const std::filesystem::path& file : options.files) {
        const FileReport report = inspect(file);
        if (options.json) {
            all.push_back(as_json(file, report));
        } else {
            print(file, report);
        }
    }
    if (options.json) {
        print_json(all);
    }
    check_output();
}

}  // namespace

void add_inspect(CLI::App& app) {
    const auto options = std::make_shared<InspectOptions>();
    CLI::App* const sub = app.add_subcommand("inspect", "Say what a recording of sensors holds: sources, rates, gaps");
    sub->add_option("FILE", options->files, "pcapng, pcap or candump log; plain, .xz or .gz")->required();
    CLI::Option* const json = sub->add_flag("--json", options->json, "print JSON");
    sub->add_flag("--decode", options->decode, "print every sample that the configured drivers understand")
        ->excludes(json);
    sub->add_option("--config", options->config,
                    "with --decode: configuration (TOML) of the sources; default: the recording's own");
    sub->footer(
        "For each source, each flow of datagrams and each CAN identifier: records, bytes, rate, the longest gap and "
        "when\n"
        "it began, counted from the first record.\n"
        "\n"
        "Examples:\n"
        "  crspf inspect lidar.pcap\n"
        "  crspf inspect run.pcapng --decode | grep wheels\n"
        "  crspf inspect run.pcapng --json | jq '.[0].sources[].rate_hz'");
    sub->callback([options] { run(*options); });
}

}  // namespace crspf::cli
