// What the service crspfd needs beyond the SLAM and its sources.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/trig.hpp"

namespace crspf {

/// One kind of real-time thread.
struct ThreadConfig {
    int priority = 0;                 ///< of SCHED_FIFO, 1 to 99
    std::vector<std::uint32_t> cpus;  ///< empty: any
    double deadline_ms = 0.0;         ///< [ms] longer is counted as a miss
};

struct ThreadsConfig {
    ThreadConfig receive{.priority = 70, .cpus = {}, .deadline_ms = 5.0};   ///< a source's turn, waiting apart
    ThreadConfig odometry{.priority = 65, .cpus = {}, .deadline_ms = 5.0};  ///< from reception to P~
    ThreadConfig filter{.priority = 60, .cpus = {}, .deadline_ms = 20.0};   ///< from reception to P
    ThreadConfig map{.priority = 50, .cpus = {}, .deadline_ms = 50.0};      ///< a scan drawn
    ThreadConfig output{.priority = 75, .cpus = {}, .deadline_ms = 1.0};    ///< sent after the planned instant
};

struct PoseOutputConfig {
    std::string can;                          ///< interface; empty: no output
    double rate_hz = 50.0;                    ///< [Hz]
    std::uint32_t base_id = 0x780;            ///< of the five frames
    double correction_mps = 0.5;              ///< [m/s] at which a correction is let in
    double correction_radps = radians(30.0);  ///< [rad/s]
    double jump_m = 0.5;                      ///< [m] a larger correction is a jump and announced as one
    double jump_rad = radians(15.0);          ///< [rad]
    double odometry_stale_s = 0.25;           ///< [s] without a sample of the odometer: lost
    double match_stale_s = 2.0;               ///< [s] without a match: lost
};

struct ServiceConfig {
    std::string control_socket = "/run/crspf/control";
    std::string state_directory = "/var/lib/crspf";
    double save_every_s = 300.0;    ///< [s] the map; 0: only at the end and on command
    double planning_every_s = 0.0;  ///< [s] the map to plan paths on; 0: not at all
    bool localize_only = false;     ///< on the saved map, which stays as it is
    bool relocalize = true;         ///< look for a lost robot in the whole map
    std::string record_directory;   ///< the whole run is recorded there; empty: not at all
};

}  // namespace crspf
