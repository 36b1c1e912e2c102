#include "tools/sim/stereo_rig.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace crspf::sim {
namespace {

std::optional<Blindness> blindness_at(const std::vector<BlindSpell>& spells, double now_s) {
    const auto spell = std::find_if(spells.begin(), spells.end(),
                                    [now_s](const BlindSpell& s) { return now_s >= s.from_s && now_s < s.to_s; });
    return spell == spells.end() ? std::nullopt : std::optional(spell->kind);
}

}  // namespace

StereoRig::StereoRig(const Scene& scene, const StereoRigParams& params, std::uint64_t seed, std::int64_t start_us)
    : camera_(scene, params.camera, seed), params_(params), start_us_(start_us) {}

void StereoRig::advance(const Motion& motion, double start_s, double length_s, const Movers& movers) {
    for (;;) {
        const double now_s = static_cast<double>(next_us_) * 1e-6;
        if (now_s - start_s >= length_s) {
            return;
        }
        const Pose2 P_world_base = motion.pose_at(now_s - start_s);
        finished_.push_back({.stamp_us = start_us_ + next_us_,
                             .P_world_left = P_world_base * camera_.P_base_camera(),
                             .pictures = camera_.shoot(P_world_base, movers, blindness_at(params_.blind, now_s))});
        next_us_ = to_us(static_cast<double>(++pairs_) / params_.rate_hz);
    }
}

void StereoRig::deliver(LogWriter& writer, std::string& out) {
    for (const PictureRecord& record : finished_) {
        writer.pictures(record, out);
    }
    finished_.clear();
}

}  // namespace crspf::sim
