// The particle filter's thread (paper Section 4): the newest scan, matched; older ones that waited are skipped.
#pragma once

#include <cstdint>
#include <optional>

#include "core/slam/localizer.hpp"
#include "platform/crspfd/exchange.hpp"

namespace crspf {

/// One thread's. turn(): no heap, no lock, no throw; bounded as Localizer::on_scan().
class FilterModule {
 public:
    FilterModule(const SlamParams& params, Exchange& exchange) : localizer_(params), exchange_(exchange) {}

    /// Before the threads run: part of a map that was loaded, and the robot's place in it.
    void follow(const ChangeList& changes) { localizer_.follow(changes); }
    void set_pose(const Pose2& P_map_base);
    /// Before the threads run: somewhere on the map that was loaded.
    void forget_pose() { localizer_.forget_pose(); }

    /// Takes what has come. True where a scan was among it. `now()` is asked when its pose is known.
    template <class Now>
    bool turn(Now&& now) {
        take_motions();
        take_commands();
        Stamp received;
        if (exchange_.scan.update()) {
            follow_map();
            const ReceivedScan& scan = exchange_.scan.value();
            finish(localizer_.on_scan(scan.scan), exchange_.scan.number(), exchange_.scan.skipped());
            received = scan.received;
        } else if (exchange_.cloud != nullptr && exchange_.cloud->update()) {
            follow_map();
            const ReceivedCloud& cloud = exchange_.cloud->value();
            const std::optional<ScanResult> result = localizer_.on_cloud(cloud.cloud);
            if (!result) {
                return false;
            }
            finish(*result, exchange_.cloud->number(), exchange_.cloud->skipped());
            received = cloud.received;
        } else {
            return false;
        }
        state_.latency = now() - received;
        exchange_.filter.publish(state_);
        return true;
    }
    /// From the newest scan's reception to its pose.
    [[nodiscard]] Duration latency() const { return state_.latency; }

 private:
    void take_commands();
    void take_motions();
    void follow_map();
    void finish(const ScanResult& result, std::uint64_t scan, std::uint64_t skipped);
    bool order_update(const ScanResult& result);
    [[nodiscard]] Pose2 P_odom_base(const Pose2& P_map_base) const;
    void show(const ScanResult& result);
    void note(const JournalEntry& entry);

    Localizer localizer_;
    Exchange& exchange_;
    FilterState state_;
    Stamp newest_;  ///< of the motions
    std::uint64_t motions_ = 0;
    std::uint64_t changes_ = 0;
    MapTask task_;  ///< the last one
};

}  // namespace crspf
