#include "platform/service/capture_run.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "platform/capture/capture_reader.hpp"
#include "platform/capture/frames.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/can_input.hpp"
#include "platform/service/motion_input.hpp"
#include "platform/service/sample_sink.hpp"
#include "platform/service/stereo_input.hpp"
#include "platform/service/stream_input.hpp"
#include "platform/service/velodyne_input.hpp"

namespace crspf {

namespace {

/// A configured source and the driver that listens for it.
struct Listening {
    Listening(const SourceConfig& source, const LidarParams& lidar) : config(&source) {
        switch (source.driver) {
            case SourceDriver::kScip:
            case SourceDriver::kSick:
            case SourceDriver::kLms2xx:
            case SourceDriver::kLd06: stream = listen_to(source, lidar); break;
            case SourceDriver::kVelodyne: velodyne = std::make_unique<VelodyneInput>(source, lidar); break;
            case SourceDriver::kCan: can = std::make_unique<CanInput>(source.can); break;
            case SourceDriver::kMotion: motion = std::make_unique<MotionInput>(); break;
        }
    }

    [[nodiscard]] SourceCounts counts() const {
        return stream != nullptr     ? stream->counts()
               : velodyne != nullptr ? velodyne->counts()
               : motion != nullptr   ? motion->counts()
                                     : can->counts();
    }

    const SourceConfig* config;
    std::uint64_t records = 0;
    // One of these.
    std::unique_ptr<StreamInput> stream;
    std::unique_ptr<VelodyneInput> velodyne;
    std::unique_ptr<CanInput> can;
    std::unique_ptr<MotionInput> motion;
};

/// One file, one record ahead.
class Part {
 public:
    static constexpr Duration kBackMax{1'000'000'000};

    explicit Part(const std::filesystem::path& file) : name_(file.string()), reader_(open_capture(file)) { advance(); }

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] bool at_end() const { return at_end_; }
    [[nodiscard]] const CaptureRecord& record() const { return record_; }
    /// Where the record stands among those of other files.
    [[nodiscard]] Stamp order() const { return newest_; }
    [[nodiscard]] const CaptureReader& reader() const { return *reader_; }
    [[nodiscard]] std::uint64_t jumps() const { return jumps_; }

    void advance() {
        if (!reader_->next(record_)) {
            at_end_ = true;
            return;
        }
        Stamp stamp = record_.stamp + repair_;
        if (started_ && newest_ - stamp > kBackMax) {
            ++jumps_;
            repair_.ns += (newest_ - stamp).ns;
            stamp = newest_;
        }
        record_.stamp = stamp;
        newest_ = started_ ? std::max(newest_, stamp) : stamp;
        started_ = true;
    }

 private:
    std::string name_;
    std::unique_ptr<CaptureReader> reader_;
    CaptureRecord record_;
    Stamp newest_;
    Duration repair_;
    bool started_ = false;
    bool at_end_ = false;
    std::uint64_t jumps_ = 0;
};

class CaptureRun final : public LogReader, private SampleSink {
 public:
    CaptureRun(const std::vector<std::filesystem::path>& files, Config config) : config_(std::move(config)) {
        for (const std::filesystem::path& file : files) {
            parts_.push_back(std::make_unique<Part>(file));
            names_ += (names_.empty() ? "" : ", ") + file.string();
        }
        for (const SourceConfig& source : config_.sources) {
            if (!source.record_only) {
                listening_.emplace_back(source, config_.slam.lidar);
            }
        }
        routes_.resize(parts_.size());
        for (const auto& part : parts_) {
            for (const CaptureSource& source : part->reader().sources()) {
                journaled_ = journaled_ || source.link == LinkKind::kJournal;
                pictured_ = pictured_ || source.link == LinkKind::kStereo;
            }
        }
        if (listening_.empty() && !pictured_) {
            throw InputError(names_ +
                             ": a recording of sensors, but no source is configured; give --config with [source.NAME] "
                             "tables, as in config/examples");
        }
        pictured_ = pictured_ && !journaled_;  // then it counts what the service was told
    }

    bool next(LogEvent& event) override {
        while (events_.empty()) {
            const std::optional<std::size_t> part = earliest();
            if (!part) {
                check_end();
                return false;
            }
            play(*part);
            parts_[*part]->advance();
        }
        take(event);
        return true;
    }

    [[nodiscard]] const LogCounts& counts() const override {
        counts_.lines = 0;
        counts_.ignored_lines = ignored_;
        counts_.damaged_lines = damaged_;
        counts_.stamp_jumps = 0;
        for (const auto& part : parts_) {
            const CaptureCounts& c = part->reader().counts();
            counts_.lines += c.records;
            counts_.damaged_lines += c.unusable;
            counts_.stamp_jumps += part->jumps();
            if (counts_.first_damage.empty()) {
                counts_.first_damage = c.first_unusable;
            }
        }
        if (counts_.first_damage.empty()) {
            counts_.first_damage = first_damaged_;
        }
        return counts_;
    }

    [[nodiscard]] double progress() const override {
        double sum = 0.0;
        for (const auto& part : parts_) {
            sum += part->reader().progress();
        }
        return sum / static_cast<double>(parts_.size());
    }

    [[nodiscard]] const char* format() const override { return "capture"; }

    [[nodiscard]] std::vector<SourceReport> sources() const override {
        std::vector<SourceReport> out;
        for (const Listening& l : listening_) {
            out.push_back({.name = l.config->name, .records = l.records, .counts = l.counts()});
        }
        if (stereo_ != nullptr) {
            out.push_back({.name = "stereo", .records = pairs_, .counts = stereo_->counts()});
        }
        return out;
    }

    [[nodiscard]] std::vector<KittiPose> take_camera_path() override {
        return stereo_ == nullptr ? std::vector<KittiPose>{} : stereo_->take_path();
    }

 private:
    /// One of the two.
    struct ScanSample {
        std::unique_ptr<Scan> scan;
        std::unique_ptr<Cloud> cloud;
        std::optional<JournalEntry> live;
    };
    using Motion = std::variant<DifferentialSample, AckermannSample, ImuSample, MotionSample>;
    using Sample =
        std::variant<DifferentialSample, AckermannSample, ImuSample, MotionSample, ScanSample, LogEvent::Place>;

    [[nodiscard]] std::optional<std::size_t> earliest() const {
        std::optional<std::size_t> best;
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            if (!parts_[i]->at_end() && (!best || parts_[i]->order() < parts_[*best]->order())) {
                best = i;
            }
        }
        return best;
    }

    void play(std::size_t part) {
        const CaptureRecord& record = parts_[part]->record();
        if (!origin_) {
            origin_ = record.stamp;
        }
        // The pipeline's line begins at 0 with the first record.
        const Stamp received = Stamp{} + (record.stamp - *origin_);
        if (record.link == LinkKind::kJournal) {
            play_journal(part, record);
            return;
        }
        if (record.link == LinkKind::kStereo) {
            play_pair(record, received);
            return;
        }
        Listening* const stream = record.link == LinkKind::kStream ? route(part, record) : nullptr;
        if (stream != nullptr) {
            ++stream->records;
            play_stream(*stream, record, received);
        } else if (!play_frame(part, record, received)) {
            play_datagram(part, record, received);
        }
    }

    void play_pair(const CaptureRecord& record, Stamp received) {
        if (!pictured_) {
            ++ignored_;
            return;
        }
        if (stereo_ == nullptr) {
            stereo_ = make_stereo_input(config_.stereo);
        }
        ++pairs_;
        stereo_->on_record(record.bytes, received, *this);
    }

    void play_stream(Listening& to, const CaptureRecord& record, Stamp received) {
        if (record.direction == Direction::kSent) {
            to.stream->on_sent(received);
        } else if (record.bytes.empty()) {
            to.stream->on_open(received);  // as the recorder marks it
        } else {
            to.stream->on_received(record.bytes, received, *this);
        }
    }

    /// False where the record is no CAN frame.
    bool play_frame(std::size_t part, const CaptureRecord& record, Stamp received) {
        CanFrame frame;
        const FrameContent content = can_of(record.link, record.bytes, frame);
        if (content == FrameContent::kDamaged) {
            count_damage(part);
            return true;
        }
        if (content != FrameContent::kFound) {
            return false;
        }
        Listening* const to = route(part, record);
        if (to == nullptr) {
            ++ignored_;
        } else if (record.direction != Direction::kSent) {
            ++to->records;
            static_cast<void>(to->can->on_frame(frame, received, *this));  // what it wants sent was sent then
        }
        return true;
    }

    void play_datagram(std::size_t part, const CaptureRecord& record, Stamp received) {
        UdpDatagram datagram;
        const FrameContent content = udp_of(record.link, record.bytes, datagram);
        if (content == FrameContent::kDamaged) {
            count_damage(part);
            return;
        }
        const auto to = std::find_if(listening_.begin(), listening_.end(), [&](const Listening& l) {
            return content == FrameContent::kFound && (l.velodyne != nullptr || l.motion != nullptr) &&
                   l.config->port.port == datagram.destination_port;
        });
        if (to == listening_.end()) {
            ++ignored_;
            return;
        }
        ++to->records;
        if (to->motion != nullptr && pictured_) {
            return;  // what it was told of these pictures
        }
        if (to->velodyne != nullptr) {
            to->velodyne->on_data(datagram.payload, datagram.source_address, received, *this);
        } else {
            to->motion->on_data(datagram.payload, received, *this);
        }
    }

    void count_damage(std::size_t part) {
        if (damaged_++ == 0) {
            first_damaged_ = parts_[part]->name() + ": record " +
                             std::to_string(parts_[part]->reader().counts().records) +
                             ": a frame whose headers contradict themselves";
        }
    }

    /// Which of our sources a recorded one is; nullptr: none.
    Listening* route(std::size_t part, const CaptureRecord& record) {
        std::vector<std::optional<Listening*>>& routes = routes_[part];
        routes.resize(std::max<std::size_t>(routes.size(), record.source + 1));
        if (!routes[record.source]) {
            routes[record.source] = find_route(parts_[part]->reader().sources()[record.source], record.link);
        }
        return *routes[record.source];
    }

    Listening* find_route(const CaptureSource& recorded, LinkKind link) {
        const bool is_stream = link == LinkKind::kStream;
        Listening* only = nullptr;
        int candidates = 0;
        for (Listening& l : listening_) {
            if (is_stream ? l.stream == nullptr : l.can == nullptr) {
                continue;
            }
            const std::string& interface = l.config->port.device;
            if (l.config->name == recorded.name ||
                (!is_stream && !recorded.name.empty() && interface == recorded.name)) {
                return &l;
            }
            only = &l;
            ++candidates;
        }
        return candidates == 1 ? only : nullptr;
    }

    void check_end() const {
        if (pairs_ > 0 ||
            std::any_of(listening_.begin(), listening_.end(), [](const Listening& l) { return l.records > 0; })) {
            return;
        }
        throw InputError(names_ +
                         ": none of the configured sources speaks in it; `crspf inspect` lists what does, and names "
                         "and ports of [source.NAME] must fit");
    }

    void on_scan(const Scan& scan) override {
        const std::span beams = std::span(scan.beam).first(scan.count);
        counts_.invalid_beams += static_cast<std::uint64_t>(std::count(beams.begin(), beams.end(), Beam::kInvalid));
        counts_.no_return_beams += static_cast<std::uint64_t>(std::count(beams.begin(), beams.end(), Beam::kNoReturn));
        ScanSample sample;
        sample.scan = std::make_unique<Scan>(scan);
        on_sample(std::move(sample));
    }
    void on_cloud(const Cloud& cloud) override {
        ScanSample sample;
        sample.cloud = std::make_unique<Cloud>();
        sample.cloud->take(cloud);
        on_sample(std::move(sample));
    }
    void on_sample(ScanSample&& sample) {
        ++counts_.scans;
        ++scans_heard_;
        if (journaled_) {
            waiting_scans_.emplace_back(scans_heard_, std::move(sample));
        } else {
            events_.emplace_back(std::move(sample));
        }
    }
    void on_wheel(const DifferentialSample& sample) override { on_odometry(sample); }
    void on_wheel(const AckermannSample& sample) override { on_odometry(sample); }
    void on_imu(const ImuSample& sample) override { on_odometry(sample); }
    void on_motion(const MotionSample& sample) override { on_odometry(sample); }
    template <class T>
    void on_odometry(const T& sample) {
        ++counts_.odometry;
        if (journaled_) {
            waiting_motions_.emplace_back(sample);
        } else {
            events_.emplace_back(sample);
        }
    }

    /// What a service was given waits until it took it: the journal follows what it speaks of.
    void play_journal(std::size_t part, const CaptureRecord& record) {
        const std::optional<JournalEntry> entry = decode_journal(record.bytes);
        if (!entry) {
            count_damage(part);
            return;
        }
        for (; motions_taken_ < entry->motions && !waiting_motions_.empty(); ++motions_taken_) {
            std::visit(
                [this](const auto& sample) {
                    newest_ = std::max(newest_, sample.stamp);
                    events_.emplace_back(sample);
                },
                waiting_motions_.front());
            waiting_motions_.pop_front();
        }
        if (entry->kind == JournalEntry::Kind::kPlace) {
            events_.emplace_back(LogEvent::Place{.stamp = newest_, .P_map_base = entry->P_map_base});
            return;
        }
        while (!waiting_scans_.empty() && waiting_scans_.front().first <= entry->scan) {
            if (waiting_scans_.front().first == entry->scan) {  // those before it were skipped
                waiting_scans_.front().second.live = entry;
                events_.emplace_back(std::move(waiting_scans_.front().second));
            }
            waiting_scans_.pop_front();
        }
    }

    void take(LogEvent& event) {
        if (const auto* differential = std::get_if<DifferentialSample>(&events_.front())) {
            event.kind = LogEvent::Kind::kDifferential;
            event.differential = *differential;
        } else if (const auto* ackermann = std::get_if<AckermannSample>(&events_.front())) {
            event.kind = LogEvent::Kind::kAckermann;
            event.ackermann = *ackermann;
        } else if (const auto* imu = std::get_if<ImuSample>(&events_.front())) {
            event.kind = LogEvent::Kind::kImu;
            event.imu = *imu;
        } else if (const auto* motion = std::get_if<MotionSample>(&events_.front())) {
            event.kind = LogEvent::Kind::kMotion;
            event.motion = *motion;
        } else if (const auto* place = std::get_if<LogEvent::Place>(&events_.front())) {
            event.kind = LogEvent::Kind::kPlace;
            event.place = *place;
        } else {
            auto& sample = std::get<ScanSample>(events_.front());
            event.live = sample.live;
            if (sample.scan != nullptr) {
                event.kind = LogEvent::Kind::kScan;
                event.scan = *sample.scan;
            } else {
                event.kind = LogEvent::Kind::kCloud;
                event.cloud = std::move(sample.cloud);
            }
        }
        event.recorded_stamp_s = 1e-9 * static_cast<double>((*origin_ + (stamp_of(event) - Stamp{})).ns);
        events_.pop_front();
    }

    Config config_;
    std::string names_;
    std::vector<std::unique_ptr<Part>> parts_;
    std::deque<Listening> listening_;
    /// For each part, for each of its sources; empty: not yet sought.
    std::vector<std::vector<std::optional<Listening*>>> routes_;
    std::optional<Stamp> origin_;
    std::deque<Sample> events_;

    bool journaled_ = false;  ///< a running service's recording
    bool pictured_ = false;   ///< a stereo camera's: it is the odometer
    std::unique_ptr<StereoInput> stereo_;
    std::uint64_t pairs_ = 0;
    std::deque<Motion> waiting_motions_;
    std::deque<std::pair<std::uint64_t, ScanSample>> waiting_scans_;  ///< with their numbers
    std::uint64_t motions_taken_ = 0;
    std::uint64_t scans_heard_ = 0;
    Stamp newest_;  ///< of the motions taken
    mutable LogCounts counts_;
    std::uint64_t ignored_ = 0;
    std::uint64_t damaged_ = 0;  ///< frames
    std::string first_damaged_;
};

}  // namespace

std::unique_ptr<LogReader> open_capture_run(const std::vector<std::filesystem::path>& files, const Config& config) {
    return std::make_unique<CaptureRun>(files, config);
}

}  // namespace crspf
