// The newest value of something, from one thread to another: older ones are overwritten unseen. The other way in which
// threads exchange anything: spsc_ring.hpp.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace crspf {

/// Single writer, single reader, three slots: one each has, and one lies between. Values live in place. Every method:
/// wait-free, no heap, no throw.
template <class T>
class LatestValue {
 public:
    // Writer's.

    /// The slot to fill, then publish(). It holds some older value.
    [[nodiscard]] T& slot() { return slots_[writing_].value; }
    void publish() {
        slots_[writing_].number = ++published_;
        // Release, with the reader's acquire: it sees what was filled in. Acquire, with the reader's release: it has
        // done with the slot that comes back.
        writing_ = between_.exchange(writing_ | kFresh, std::memory_order_acq_rel) & kSlot;
    }
    void publish(const T& value) {
        slot() = value;
        publish();
    }

    // Reader's.

    /// Takes the newest value where there is one since the last call.
    bool update() {
        if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) {
            return false;
        }
        reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & kSlot;  // see publish()
        skipped_ += slots_[reading_].number - number_ - 1;
        number_ = slots_[reading_].number;
        return true;
    }
    /// As of the last update(); before the first: a default one.
    [[nodiscard]] const T& value() const { return slots_[reading_].value; }
    /// How many values had been published when this one was, it included; 0: none yet.
    [[nodiscard]] std::uint64_t number() const { return number_; }
    /// Values that were overwritten before they were read. Never reset.
    [[nodiscard]] std::uint64_t skipped() const { return skipped_; }

 private:
    static constexpr std::uint32_t kSlot = 3;   ///< which slot
    static constexpr std::uint32_t kFresh = 4;  ///< the slot between holds what the reader has not seen

    struct Slot {
        T value{};
        std::uint64_t number = 0;
    };

    std::array<Slot, 3> slots_{};
    alignas(64) std::atomic<std::uint32_t> between_{1};
    alignas(64) std::uint32_t writing_ = 0;
    std::uint64_t published_ = 0;
    alignas(64) std::uint32_t reading_ = 2;
    std::uint64_t number_ = 0;
    std::uint64_t skipped_ = 0;
};

}  // namespace crspf
