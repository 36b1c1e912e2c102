// A descriptor that is lost and opened again, without end and without haste.
#pragma once

#include <algorithm>
#include <utility>

#include "platform/files/unique_fd.hpp"
#include "platform/linux/monotonic_clock.hpp"

namespace crspf {

class ReopeningFd {
 public:
    /// Between attempts to open: the first pause, doubled with each failure up to the last, which leaves a sensor that
    /// is plugged in again the time to be back within two seconds.
    static constexpr Duration kPauseMin{100'000'000};
    static constexpr Duration kPauseMax{500'000'000};

    [[nodiscard]] bool is_open() const { return fd_.valid(); }
    [[nodiscard]] int get() const { return fd_.get(); }
    /// errno of the last loss or failure; 0: none yet.
    [[nodiscard]] int error() const { return error_; }

    /// Of a closed one: whether it is time to try. If not, waits for it, but not longer than `wait`.
    [[nodiscard]] bool may_open(Duration wait) {
        const Stamp now = monotonic_now();
        if (now < next_attempt_) {
            sleep_until(std::min(next_attempt_, now + std::max(wait, Duration{})));
        }
        return monotonic_now() >= next_attempt_;
    }

    void opened(UniqueFd fd) {
        fd_ = std::move(fd);
        pause_ = kPauseMin;
    }

    void failed(int error) {
        close(error);
        pause_ = std::min(Duration{2 * pause_.ns}, kPauseMax);
    }

    void lost(int error) {
        pause_ = kPauseMin;
        close(error);
    }

 private:
    void close(int error) {
        error_ = error;
        fd_ = UniqueFd();
        next_attempt_ = monotonic_now() + pause_;
    }

    UniqueFd fd_;
    int error_ = 0;
    Duration pause_ = kPauseMin;
    Stamp next_attempt_;
};

}  // namespace crspf
