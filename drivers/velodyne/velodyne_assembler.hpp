// Datagrams of a Velodyne sensor -> revolutions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

#include "core/base/time.hpp"
#include "drivers/velodyne/velodyne_clock.hpp"
#include "drivers/velodyne/velodyne_cloud.hpp"
#include "drivers/velodyne/velodyne_codec.hpp"
#include "drivers/velodyne/velodyne_geometry.hpp"
#include "drivers/velodyne/velodyne_params.hpp"
#include "drivers/velodyne/velodyne_status.hpp"

namespace crspf {

struct VelodyneCounters {
    std::uint64_t packets = 0;    ///< data packets taken into a revolution
    std::uint64_t positions = 0;  ///< position packets decoded
    std::uint64_t foreign = 0;    ///< datagrams from another address
    std::uint64_t bad_length = 0;
    std::uint64_t bad_flag = 0;
    std::uint64_t bad_azimuth = 0;
    std::uint64_t bad_stamp = 0;
    std::uint64_t bad_mode = 0;
    std::uint64_t bad_model = 0;     ///< the sensor is another than the configured one
    std::uint64_t bad_position = 0;  ///< position packets without a known PPS state or a whole sentence
    std::uint64_t late = 0;          ///< twice, or overtaken by a later packet; left out
    std::uint64_t lost = 0;          ///< packets missing between two others, in gaps of up to half an hour
    std::uint64_t breaks = 0;  ///< revolutions given up: a gap of half a turn or more, or a step of clock or angle
    std::uint64_t full = 0;    ///< revolutions given up for capacity::kCloudColumns or kCloudPoints
    std::uint64_t without_calibration = 0;  ///< packets of an HDL-64E that has not yet told its calibration
};

/// Recognises lost packets by the sensor's stamps, and believes in a gap only if the head has turned on by as much as
/// it should have meanwhile. What is missing stands in the cloud as columns not measured, in its place and time.
/// An HDL-64E's calibration is learnt from its packets unless it is given.
/// No heap, no throw; each datagram takes constant time, but for gaps, which are bounded by half a turn. 4 MiB. One
/// owner.
class VelodyneAssembler {
 public:
    explicit VelodyneAssembler(const VelodyneParams& params,
                               const std::optional<VelodyneCalibration>& calibration = std::nullopt);

    /// A datagram of the data port. Calls visit(const VelodyneCloud&) for each revolution that it ends; the cloud is
    /// valid during the call only.
    /// @param source IPv4 address of the sender, as a number
    template <typename Visit>
    void on_data(std::span<const std::uint8_t> payload, std::uint32_t source, Stamp received, Visit&& visit) {
        handle(payload, source, received,
               {[](void* v, const VelodyneCloud& cloud) { (*static_cast<std::remove_reference_t<Visit>*>(v))(cloud); },
                &visit});
    }

    /// A datagram of the position port; what it says, if it can be believed.
    std::optional<VelodynePosition> on_position(std::span<const std::uint8_t> payload, std::uint32_t source);

    [[nodiscard]] const VelodyneCounters& counters() const { return counters_; }
    [[nodiscard]] const VelodyneClock& clock() const { return clock_; }
    /// Known from the start but for an HDL-64E.
    [[nodiscard]] const std::optional<VelodyneCalibration>& calibration() const { return calibration_; }

 private:
    struct Visitor {
        void (*call)(void*, const VelodyneCloud&);
        void* object;
    };
    /// What is known of the packet before.
    struct Before {
        std::uint32_t stamp_us = 0;
        double azimuth_cdeg = 0.0;       ///< of its first column
        double turn_cdeg = 0.0;          ///< from one packet's first column to the next one's; 0: not yet known
        double last_azimuth_cdeg = 0.0;  ///< of its last column
        std::uint32_t returns = 1;
    };

    struct SensorTime {
        std::uint32_t stamp_us;  ///< of a packet
        double after_us;
    };

    void handle(std::span<const std::uint8_t> payload, std::uint32_t source, Stamp received, Visitor visitor);
    void count(VelodyneFault fault);
    void know(const VelodyneCalibration& calibration);
    [[nodiscard]] bool learn(const VelodynePacket& packet);
    [[nodiscard]] bool bridge(const VelodynePacket& packet, const VelodyneColumns& columns, Visitor visitor);
    void fill_gap(std::uint32_t lost, const VelodyneColumns& columns, Visitor visitor);
    void add_packet(const VelodynePacket& packet, const VelodyneColumns& columns, Visitor visitor);
    std::optional<std::uint32_t> add_column(double azimuth_cdeg, SensorTime time, bool measured, Visitor visitor);
    void fill_column(std::uint32_t at, const VelodynePacket& packet, const VelodyneColumns& columns, std::uint32_t c);
    void end_revolution(bool complete, Visitor visitor);

    VelodyneParams params_;
    double cut_cdeg_;
    std::optional<VelodyneCalibration> calibration_;
    std::optional<VelodyneGeometry> geometry_;
    VelodyneStatusListener status_;
    VelodyneClock clock_;
    VelodyneCounters counters_;
    std::optional<Before> before_;
    VelodynePacket packet_;

    bool began_at_cut_ = false;
    bool skipping_ = false;       ///< the revolution did not fit; its rest is left out
    double turned_cdeg_ = 0.0;    ///< since the cut
    double previous_cdeg_ = 0.0;  ///< azimuth of the column before
    VelodyneCloud cloud_;
};

}  // namespace crspf
