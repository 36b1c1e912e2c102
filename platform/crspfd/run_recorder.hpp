// Records a running service: what its sensors said, and what its journal says of how it was timed, so that a replay
// finds the same poses.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "config/config.hpp"
#include "platform/capture/recorder.hpp"
#include "platform/crspfd/exchange.hpp"
#include "platform/crspfd/source_thread.hpp"

namespace crspf {

struct RunRecorderState {
    RecorderCounters counters;
    std::uint64_t unrecorded = 0;  ///< what found its ring full: the disk was too slow
    std::filesystem::path file;    ///< empty: none is being written
    std::string problem;           ///< why recording pauses; empty: it does not
};

/// Has an ordinary thread of its own, which waits for the disk.
class RunRecorder {
 public:
    /// Throws InputError where recording is not possible.
    RunRecorder(const Config& config, std::deque<SourceThread>& sources, Exchange& exchange);
    RunRecorder(const RunRecorder&) = delete;
    RunRecorder& operator=(const RunRecorder&) = delete;
    /// Writes what is in the rings still.
    ~RunRecorder();

    void start();
    [[nodiscard]] RunRecorderState state() const;

 private:
    void drain();
    void publish();

    std::deque<SourceThread>& sources_;
    Exchange& exchange_;
    Recorder recorder_;
    Stamp latest_;
    mutable std::mutex mutex_;  ///< of state_
    RunRecorderState state_;
    std::jthread thread_;  ///< last: it uses all of the others
};

}  // namespace crspf
