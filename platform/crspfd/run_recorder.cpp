#include "platform/crspfd/run_recorder.hpp"

#include <algorithm>
#include <ctime>
#include <system_error>
#include <vector>

#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"

namespace crspf {

namespace {

constexpr Duration kTurn{20'000'000};

RecorderParams params_of(const Config& config) {
    RecorderParams params;
    params.directory = config.service.record_directory;
    std::error_code error;
    std::filesystem::create_directories(params.directory, error);  // the recorder says why not
    params.utc_minus_stamp = clock_now(CLOCK_REALTIME) - monotonic_now();
    return params;
}

std::vector<CaptureSource> ports_of(const Config& config) {
    std::vector<CaptureSource> ports;
    for (const SourceConfig& source : config.sources) {
        ports.push_back({.name = source.name, .description = source.port_text, .link = link_of(source.driver)});
    }
    ports.push_back({.name = "crspfd", .description = "what the service decided", .link = LinkKind::kJournal});
    return ports;
}

}  // namespace

RunRecorder::RunRecorder(const Config& config, std::deque<SourceThread>& sources, Exchange& exchange)
    : sources_(sources), exchange_(exchange), recorder_(params_of(config), ports_of(config), print_config(config)) {}

RunRecorder::~RunRecorder() {
    if (thread_.joinable()) {
        thread_.request_stop();
        thread_.join();
    }
    drain();
}

void RunRecorder::start() {
    latest_ = monotonic_now();
    exchange_.recording.store(true, std::memory_order_release);
    thread_ = std::jthread([this](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            drain();
            publish();
            sleep_until(monotonic_now() + kTurn);
        }
    });
}

/// The entries of the journal that are there now go after all that is in the other rings: what an entry speaks of was
/// in its ring before.
void RunRecorder::drain() {
    const std::size_t entries = exchange_.journal.size();
    for (std::uint32_t i = 0; i < sources_.size(); ++i) {
        SpscRing<TrafficRecord, 256>& traffic = sources_[i].traffic;
        while (const TrafficRecord* const record = traffic.front()) {
            latest_ = std::max(latest_, record->stamp);
            static_cast<void>(recorder_.append(i, record->direction, record->stamp,
                                               std::span(record->bytes).first(record->size)));  // it counts
            traffic.pop();
        }
    }
    JournalEntry entry;
    for (std::size_t i = 0; i < entries && exchange_.journal.pop(entry); ++i) {
        const auto bytes = encode(entry);
        static_cast<void>(
            recorder_.append(static_cast<std::uint32_t>(sources_.size()), Direction::kUnknown, latest_, bytes));
    }
}

void RunRecorder::publish() {
    RunRecorderState state{.counters = recorder_.counters(),
                           .unrecorded = exchange_.journal.rejected(),
                           .file = recorder_.file(),
                           .problem = recorder_.problem()};
    for (const SourceThread& source : sources_) {
        state.unrecorded += source.traffic.rejected();
    }
    const std::lock_guard lock(mutex_);
    state_ = std::move(state);
}

RunRecorderState RunRecorder::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

}  // namespace crspf
