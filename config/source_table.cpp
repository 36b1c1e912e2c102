// The keys of [source.NAME] and of the signals within: the one place to add one.
#include <array>

#include "config/capacities.hpp"
#include "config/parameters.hpp"
#include "config/sources.hpp"

namespace crspf {

namespace {

template <class Enum>
Choice choice(Enum& value, std::span<const std::string_view> names) {
    static_assert(sizeof(Enum) == 1);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the bytes of an object may be reached so
    return {reinterpret_cast<std::uint8_t*>(&value), names};
}

constexpr double kBaudMax = 4e6;

constexpr auto kDrivers =
    std::to_array<std::string_view>({"scip", "sick", "lms2xx", "ld06", "velodyne", "can", "motion"});
constexpr auto kEncodings = std::to_array<std::string_view>({"three_characters", "two_characters", "with_intensity"});
constexpr auto kDialects = std::to_array<std::string_view>({"as_found", "binary", "ascii"});
constexpr auto kModels =
    std::to_array<std::string_view>({"VLP-16", "Puck Hi-Res", "HDL-32E", "HDL-64E S2", "HDL-64E S3", "VLP-32C"});
constexpr auto kPlanar = std::to_array<std::string_view>({"ring", "obstacles"});
constexpr auto kRoles =
    std::to_array<std::string_view>({"left", "right", "speed", "second_speed", "steering", "yaw_rate", "roll_rate",
                                     "pitch_rate", "acceleration_x", "acceleration_y", "acceleration_z"});

constexpr auto kSource = std::to_array<SourceParameter>({
    {"", "driver", [](SourceConfig& c) -> Field { return choice(c.driver, kDrivers); },
     "What the sensor speaks: Hokuyo's SCIP, SICK's CoLa (LMS1xx, LMS5xx, TiM) or serial telegrams (LMS2xx), "
     "LDROBOT's packets (LD06, LD19), Velodyne's datagrams, signals of a CAN bus, or the motion that another process's "
     "odometry measures "
     "(docs/motion-protocol.md). Must be given."},
    {"", "port", [](SourceConfig& c) -> Field { return &c.port_text; },
     "Where it is: a serial device (/dev/...), tcp://ADDRESS:PORT, udp://[OWN ADDRESS]:PORT, or a CAN interface. "
     "Must be given."},
    {"", "record_only", [](SourceConfig& c) -> Field { return &c.record_only; },
     "It is recorded, but what it says is not used."},

    {"scip", "baud", [](SourceConfig& c) -> Field { return &c.scip.baud; },
     "Bit rate to stream with over RS-232; 0 for USB and Ethernet.", "bit/s", 0.0, kBaudMax},
    {"scip", "encoding", [](SourceConfig& c) -> Field { return choice(c.scip.encoding, kEncodings); },
     "Of the ranges; two characters hold up to 4.095 m."},
    {"scip", "cluster", [](SourceConfig& c) -> Field { return &c.scip.cluster; }, "Steps to a beam.", "", 1.0, 99.0},
    {"scip", "skip", [](SourceConfig& c) -> Field { return &c.scip.skip; }, "Revolutions left out between scans.", "",
     0.0, 9.0},
    {"scip", "synchronise", [](SourceConfig& c) -> Field { return &c.scip.synchronise; },
     "The sensor's clock is read at the start; without it stamps are late by what lies between measurement and "
     "reception."},

    {"sick", "dialect", [](SourceConfig& c) -> Field { return choice(c.sick.dialect, kDialects); },
     "The dialect of CoLa that the sensor is switched to."},
    {"sick", "frequency_hz", [](SourceConfig& c) -> Field { return &c.sick_frequency_hz; },
     "Scans per second to set, together with resolution_deg; 0: as the sensor is.", "Hz", 0.0, 100.0},
    {"sick", "resolution_deg", [](SourceConfig& c) -> Field { return &c.sick_resolution_rad; },
     "Angle between beams to set, together with frequency_hz; 0: as the sensor is.", "deg", 0.0, 1.0},

    {"lms2xx", "baud", [](SourceConfig& c) -> Field { return &c.lms2xx.baud; },
     "9600, 19200, 38400, or 500000 (RS-422), which alone carries every scan.", "bit/s", 9600.0, 500000.0},
    {"lms2xx", "angle", [](SourceConfig& c) -> Field { return &c.lms2xx_angle_deg; }, "Field of view: 100 or 180.",
     "degree", 100.0, 180.0},
    {"lms2xx", "resolution", [](SourceConfig& c) -> Field { return &c.lms2xx_resolution_deg; },
     "Angle between beams: 1, 0.5, or 0.25 with 100 degrees.", "degree", 0.25, 1.0},
    {"lms2xx", "value_mask", [](SourceConfig& c) -> Field { return &c.lms2xx_value_mask; },
     "Bits of a value that are its range, by the measuring mode the sensor was left in: 8191 for 8 m and 80 m, 16383 "
     "for 16 m, 32767 for 32 m.",
     "", 4095.0, 32767.0},

    {"velodyne", "model", [](SourceConfig& c) -> Field { return choice(c.velodyne.model, kModels); },
     "The sensor's model."},
    {"velodyne", "address", [](SourceConfig& c) -> Field { return &c.velodyne_address; },
     "Address of the sensor; datagrams from others are not believed."},
    {"velodyne", "calibration", [](SourceConfig& c) -> Field { return &c.velodyne_calibration; },
     "The unit's db.xml, seen from this configuration's folder; without it an HDL-64E tells its own corrections within "
     "seconds, and the other models have those of the data sheet."},
    {"velodyne", "cut_deg", [](SourceConfig& c) -> Field { return &c.velodyne.cut_rad; },
     "Azimuth, clockwise from the sensor's front, at which a revolution begins.", "deg", 0.0, 360.0},
    {"velodyne", "planar", [](SourceConfig& c) -> Field { return choice(c.velodyne_planar, kPlanar); },
     "What becomes the planar scan: one ring, for level floors and walls; or the obstacles that all lasers see on the "
     "ground round the vehicle (paper 4.1), as [obstacles] tells."},
    {"velodyne", "beams", [](SourceConfig& c) -> Field { return &c.velodyne_scan.beams; },
     "Beams of the planar scan that is made of a ring.", "", 16.0, static_cast<double>(capacity::kBeams)},
    {"velodyne", "laser", [](SourceConfig& c) -> Field { return &c.velodyne_laser; },
     "The ring that becomes the planar scan; -1: the one nearest to the horizon.", "", -1.0, 63.0},

    {"can", "dbc", [](SourceConfig& c) -> Field { return &c.can.dbc; },
     "File or files that describe the bus, seen from this configuration's folder."},
    {"can", "dbc_text", [](SourceConfig& c) -> Field { return &c.can.dbc_text; },
     "The description itself, in place of a file; recordings hold it so."},
    {"can", "speed_max_mps", [](SourceConfig& c) -> Field { return &c.can.speed_max_mps; },
     "A wheel does not turn faster; a counter that says so has jumped.", "m/s", 0.01, 100.0},
    {"can", "pair_within_s", [](SourceConfig& c) -> Field { return &c.can.pair_within_s; },
     "Values of the two wheels that came within this belong together.", "s", 0.0, 1.0},
    {"can", "canopen_nodes", [](SourceConfig& c) -> Field { return &c.can.canopen_nodes; },
     "CANopen nodes to start (NMT) whenever they wait for it, and to watch by their heartbeats.", "", 1.0, 127.0},
    {"can", "heartbeat_timeout_s", [](SourceConfig& c) -> Field { return &c.can.heartbeat_timeout_s; },
     "A node that was silent for so long is lost: two or three periods of its heartbeat.", "s", 0.01, 60.0},
});

constexpr auto kSignal = std::to_array<SignalParameter>({
    {"", "signal", [](SignalConfig& c) -> Field { return &c.signal; },
     "MESSAGE.SIGNAL as the DBC names them. Must be given."},
    {"", "scale", [](SignalConfig& c) -> Field { return &c.scale; },
     "From the DBC's unit to ours: metres of a counter, m/s of a speed, rad of a steering angle (of the wheels, left "
     "positive), rad/s of a rate (yaw counter-clockwise, roll to the right, pitch down positive), m/s^2 of an "
     "acceleration (x ahead, y to the left, z up; 9.81 standing). Negative turns it round.",
     "", -1e9, 1e9},
    {"", "is_speed", [](SignalConfig& c) -> Field { return &c.is_speed; },
     "Of left and right: the signal is the wheel's speed, not its counter."},
    {"", "zero", [](SignalConfig& c) -> Field { return &c.zero; },
     "Of steering and yaw_rate: what it says, in our unit, straight ahead or standing still; taken off.", "", -10.0,
     10.0},
    {"", "timeout_s", [](SignalConfig& c) -> Field { return &c.timeout_s; },
     "Without a good frame for so long the signal is silent.", "s", 0.001, 60.0},
    {"", "valid", [](SignalConfig& c) -> Field { return &c.valid; },
     "Signal of the same message; usable only while its bits are valid_bits."},
    {"", "valid_bits", [](SignalConfig& c) -> Field { return &c.valid_bits; }, "Of `valid` while it is usable.", "",
     0.0, kWholeMax},
    {"", "alive", [](SignalConfig& c) -> Field { return &c.alive; },
     "Signal of the same message that counts up by one each time."},
    {"", "direction", [](SignalConfig& c) -> Field { return &c.direction; },
     "Of left and right, whose counter only counts up: signal of the same message that tells the direction."},
    {"", "backward_bits", [](SignalConfig& c) -> Field { return &c.backward_bits; },
     "Of `direction` while rolling backward.", "", 0.0, kWholeMax},
    {"", "modulus", [](SignalConfig& c) -> Field { return &c.modulus; },
     "Values of a counter that wraps before its width does; 0: it wraps at its width.", "", 0.0, kWholeMax},
    {"", "any_source_address", [](SignalConfig& c) -> Field { return &c.any_source_address; },
     "J1939: the message is known by its parameter group, whoever sends it."},
});

}  // namespace

std::span<const SourceParameter> source_parameters() {
    return kSource;
}

std::span<const SignalParameter> signal_parameters() {
    return kSignal;
}

std::span<const std::string_view> signal_roles() {
    return kRoles;
}

}  // namespace crspf
