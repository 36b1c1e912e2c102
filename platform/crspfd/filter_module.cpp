#include "platform/crspfd/filter_module.hpp"

#include <algorithm>
#include <variant>

namespace crspf {

void FilterModule::set_pose(const Pose2& P_map_base) {
    localizer_.set_pose(P_map_base);
    // The odometry's thread may be some samples ahead: it is told of an instant that both have.
    static_cast<void>(exchange_.corrections.push(
        {.stamp = newest_, .P_map_base = localizer_.odometry().pose_at(newest_), .jump = true}));
}

void FilterModule::take_commands() {
    FilterCommand command;
    while (exchange_.commands.pop(command)) {
        Pose2 P_map_base = command.P_map_base;
        if (command.P_odom_base) {
            P_map_base = P_map_base * (inverse(*command.P_odom_base) * P_odom_base(localizer_.odometry().pose()));
        }
        set_pose(P_map_base);
        note({.kind = JournalEntry::Kind::kPlace, .motions = motions_, .P_map_base = P_map_base});
    }
}

Pose2 FilterModule::P_odom_base(const Pose2& P_map_base) const {
    return inverse(localizer_.odometry().P_map_odom()) * P_map_base;
}

void FilterModule::take_motions() {
    while (const Motion* const motion = exchange_.motions_to_filter.front()) {
        newest_ = std::max(newest_, std::visit([](const auto& sample) { return sample.stamp; }, motion->sample));
        if (const auto* differential = std::get_if<DifferentialSample>(&motion->sample)) {
            localizer_.on_wheel(*differential);
        } else if (const auto* ackermann = std::get_if<AckermannSample>(&motion->sample)) {
            localizer_.on_wheel(*ackermann);
        } else if (const auto* imu = std::get_if<ImuSample>(&motion->sample)) {
            localizer_.on_imu(*imu);
        } else {
            localizer_.on_motion(*std::get_if<MotionSample>(&motion->sample));
        }
        exchange_.motions_to_filter.pop();
        ++motions_;
    }
}

void FilterModule::follow_map() {
    while (const ChangeList* const changes = exchange_.changes.front()) {
        localizer_.follow(*changes);
        exchange_.changes.pop();
        ++changes_;
    }
}

void FilterModule::finish(const ScanResult& result, std::uint64_t scan, std::uint64_t skipped) {
    if (result.matched) {
        static_cast<void>(
            exchange_.corrections.push({.stamp = result.stamp, .P_map_base = result.P_map_base, .jump = false}));
    }
    const bool updated = result.matched && order_update(result);
    show(result);
    note({.kind = JournalEntry::Kind::kScan,
          .updated = updated,
          .tidy = task_.tidy,
          .motions = motions_,
          .scan = scan,
          .changes = changes_,
          .tiles = task_.tiles,
          .P_map_base = result.P_map_base});
    state_.result = result;
    state_.skipped_scans = skipped;
    state_.counters = localizer_.counters();
}

bool FilterModule::order_update(const ScanResult& result) {
    MapOrder* const order = exchange_.orders.claim();
    if (order == nullptr) {
        state_.undrawn += result.to_draw ? 1 : 0;
        return false;
    }
    task_ = {.P_map_base = result.P_map_base,
             .draw = result.to_draw,
             .key_frame = result.result,
             .tidy = room_to_tidy(exchange_.far_tiles, exchange_.orders.size()),
             .sight_m = sight_of(localizer_.points()),
             .tiles = next_tiles(exchange_.far_tiles, task_.tiles)};
    order->task = task_;
    if (result.to_draw) {
        order->points = localizer_.points();
    }
    exchange_.orders.commit();
    return true;
}

void FilterModule::show(const ScanResult& result) {
    if (exchange_.scans_wanted.load(std::memory_order_relaxed)) {
        SeenScan& seen = exchange_.seen.slot();
        seen.points = localizer_.points();
        seen.P_odom_base = P_odom_base(localizer_.odometry().pose_at(result.stamp));
        exchange_.seen.publish();
    }
    if (exchange_.scans_watched.load(std::memory_order_relaxed)) {
        const ScanPoints& points = localizer_.points();
        WatchedScan& watched = exchange_.watched.slot();
        watched.result = result;
        watched.P_map_odom = localizer_.odometry().P_map_odom();
        watched.count = points.count;
        std::copy_n(points.x_m.begin(), points.count, watched.x_m.begin());
        std::copy_n(points.y_m.begin(), points.count, watched.y_m.begin());
        std::ranges::copy(localizer_.critical(), watched.critical.begin());
        exchange_.watched.publish();
    }
}

void FilterModule::note(const JournalEntry& entry) {
    // Acquire, with the release of Service::start(): the ring is drained from now on.
    if (exchange_.recording.load(std::memory_order_acquire)) {
        static_cast<void>(exchange_.journal.push(entry));  // the ring counts what does not fit
    }
}

}  // namespace crspf
