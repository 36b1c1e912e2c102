#include "tools/crspf/bench_velodyne.hpp"

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/velodyne/velodyne_assembler.hpp"

namespace crspf::cli {
namespace {

/// A sensor whose packets are those of one turn, again and again, with stamps that go on.
class VelodyneBench {
 public:
    explicit VelodyneBench(VelodyneModel model)
        : packet_us_(traits_of(model).packet_us), assembler_(VelodyneParams{.model = model}, bench_calibration(model)) {
        std::uint32_t column = 0;
        std::uint32_t azimuth_cdeg = 0;
        do {
            VelodynePacket packet;
            for (std::uint32_t b = 0; b < kVelodyneBlocks; ++b) {
                VelodyneBlock& block = packet.blocks[b];
                block.azimuth_cdeg = static_cast<std::uint16_t>(azimuth_cdeg);
                for (std::uint32_t j = 0; j < kVelodyneReturns; ++j) {
                    block.distance[j] = static_cast<std::uint16_t>(500 + 37 * (column + j) % 20000);
                    block.reflectivity[j] = static_cast<std::uint8_t>(j);
                }
                if (!is_hdl64e(model) || b % 2 == 1) {
                    // The speed as encoders tell it: it trembles.
                    azimuth_cdeg = (azimuth_cdeg + 19 + column % 3) % kVelodyneTurn_cdeg;
                    ++column;
                }
            }
            packet.mode = is_hdl64e(model) ? std::uint8_t{'H'} : kVelodyneStrongest;
            packet.product = product_of_model(model);
            encode(packet, model, packets_.emplace_back());
        } while (azimuth_cdeg != 0);
    }

    void next() {
        auto& packet = packets_[sent_ % packets_.size()];
        const auto stamp_us =
            static_cast<std::uint64_t>(std::llround(packet_us_ * static_cast<double>(sent_))) % kVelodyneHour_us;
        for (std::size_t i = 0; i < 4; ++i) {
            packet[kVelodyneDataBytes - 6 + i] = static_cast<std::uint8_t>(stamp_us >> (8 * i));
        }
        ++sent_;
        const Stamp received{static_cast<std::int64_t>(1e3 * packet_us_ * static_cast<double>(sent_))};
        assembler_.on_data(packet, VelodyneParams{}.source_address, received,
                           [&](const VelodyneCloud& cloud) { columns_ += cloud.columns; });
    }

    /// Every packet was taken, and none was missed.
    [[nodiscard]] bool sound() const {
        const VelodyneCounters& n = assembler_.counters();
        return n.packets == sent_ && n.lost == 0 && n.breaks == 0 && n.full == 0 &&
               (columns_ > 0 || sent_ < 2 * packets_.size());
    }

 private:
    double packet_us_;
    VelodyneAssembler assembler_;
    std::vector<std::array<std::uint8_t, kVelodyneDataBytes>> packets_;
    std::size_t sent_ = 0;
    std::uint64_t columns_ = 0;
};

void register_decoding(const char* name, VelodyneModel model) {
    // Goes on where it stopped, as a sensor does.
    const auto bench = std::make_shared<std::unique_ptr<VelodyneBench>>();
    benchmark::RegisterBenchmark(name, [model, bench](benchmark::State& state) {
        if (*bench == nullptr) {
            *bench = std::make_unique<VelodyneBench>(model);
        }
        for ([[maybe_unused]] auto _ : state) {
            (*bench)->next();
        }
        if (!(*bench)->sound()) {
            state.SkipWithError("packets were left out: this is not the cost of decoding");
        }
        state.SetItemsProcessed(state.iterations());
    });
}

}  // namespace

VelodyneCalibration bench_calibration(VelodyneModel model) {
    VelodyneCalibration calibration = nominal_calibration(model).value_or(VelodyneCalibration{});
    for (std::uint32_t i = 0; is_hdl64e(model) && i < kVelodyneLasers; ++i) {
        calibration[i] = {.vertical_rad = -0.4 + 0.007 * i,
                          .rotation_rad = 0.15 - 0.005 * i,
                          .distance_m = 1.4,
                          .distance_x_m = 1.41,
                          .distance_y_m = 1.42,
                          .vertical_offset_m = 0.2,
                          .horizontal_offset_m = 0.026,
                          .focal_distance_m = 12.0,
                          .focal_slope = 1.4};
    }
    return calibration;
}

void register_velodyne_cases() {
    // NOLINTBEGIN(clang-analyzer-cplusplus.NewDeleteLeaks): the library keeps and frees what is registered
    register_decoding(kVelodyneVlp16, VelodyneModel::kVlp16);
    register_decoding(kVelodyneVlp32c, VelodyneModel::kVlp32c);
    register_decoding(kVelodyneHdl32e, VelodyneModel::kHdl32e);
    register_decoding(kVelodyneHdl64e, VelodyneModel::kHdl64eS2);
    // NOLINTEND(clang-analyzer-cplusplus.NewDeleteLeaks)
}

}  // namespace crspf::cli
