#include "platform/service/lidar_scans.hpp"

#include "drivers/common/mounted_scan.hpp"
#include "drivers/sick/lms2xx_scan.hpp"

namespace crspf {

void MountedScans::deliver(const Scan& scan, SampleSink& sink) {
    scan_ = scan;
    mount(scan_, lidar_);
    sink.on_scan(scan_);
}

void SickScans::deliver(const LmdScandata& data, const SickTiming& timing, SampleSink& sink) {
    if (fill_scan(data, lidar_, clock_.beam0(timing), scan_) == SickScanResult::kFilled) {
        sink.on_scan(scan_);
    } else {
        ++unusable_;
    }
}

void Lms2xxScans::deliver(const Lms2xxScan& raw, Stamp beam0, SampleSink& sink) {
    if (fill_lms2xx_scan(raw, params_.value_mask, lidar_, beam0, scan_)) {
        sink.on_scan(scan_);
    }
}

SourceCounts counts_of(const ScipListener& listener) {
    const ScipListenerCounters& c = listener.counters();
    const ScipParserCounters& p = listener.parser_counters();
    return {{"scans", c.scans},
            {"lost_scans", c.lost_scans},
            {"bad_scans", c.bad_scans},
            {"bad_stamps", c.bad_stamps},
            {"clock_jumps", c.clock_jumps},
            {"stuck_stamps", c.stuck_stamps},
            {"unknown_sensor", c.unknown_sensor},
            {"bad_sum", p.bad_sum},
            {"bad_shape", p.bad_shape},
            {"overflow", p.overflow},
            {"bytes_dropped", p.bytes_dropped}};
}

SourceCounts counts_of(const SickListener& listener) {
    const SickSequenceCounters& s = listener.sequence_counters();
    const ColaCounters& p = listener.parser_counters();
    return {{"scans", s.delivered},   {"lost_scans", s.lost},
            {"withheld", s.withheld}, {"undecodable", listener.undecodable()},
            {"bad_sum", p.bad_sums},  {"bytes_dropped", p.bytes_skipped}};
}

SourceCounts counts_of(const Lms2xxListener& listener) {
    const Lms2xxCounters& p = listener.parser_counters();
    return {{"telegrams", p.telegrams},
            {"undecodable", listener.undecodable()},
            {"bad_sum", p.bad_sums},
            {"broken_off", p.broken_off},
            {"bytes_dropped", p.bytes_skipped}};
}

SourceCounts counts_of(const Ld06Listener& listener) {
    const Ld06Counters& c = listener.counters();
    const Ld06ParserCounters& p = listener.parser_counters();
    return {{"scans", c.scans},
            {"bad_scans", c.bad_scans},
            {"lost_readings", c.lost_readings},
            {"ran_back", c.ran_back},
            {"bad_sum", p.bad_sum},
            {"implausible", p.implausible},
            {"bytes_dropped", p.bytes_dropped}};
}

}  // namespace crspf
