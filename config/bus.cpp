#include "config/bus.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "config/dbc_excerpt.hpp"
#include "config/join.hpp"
#include "drivers/can/dbc_lookup.hpp"

namespace crspf {

namespace {

constexpr auto kAxes =
    std::to_array<std::string_view>({"roll_rate", "pitch_rate", "acceleration_x", "acceleration_y", "acceleration_z"});

using Problem = std::function<void(std::string_view, std::string_view, const std::string&)>;

std::string why_not(DbcLookup::Status status, std::string_view message, std::string_view signal) {
    switch (status) {
        case DbcLookup::Status::kNoMessage: return join({"has no message ", message});
        case DbcLookup::Status::kNoSignal: return join({"has no signal ", signal, " in message ", message});
        case DbcLookup::Status::kMultiplex:
            return join(
                {"selects ", signal, " in a way that is not followed: nested selectors, none, or more than 8 ranges"});
        case DbcLookup::Status::kFloat: return join({"says that ", signal, " is a float of neither 32 nor 64 bits"});
        case DbcLookup::Status::kFound:
        case DbcLookup::Status::kBadText: break;
    }
    return {};
}

class BusResolver {
 public:
    BusResolver(CanSourceConfig& can, const std::vector<DbcText>& texts, const Problem& problem)
        : can_(can), texts_(texts), problem_(problem), used_(texts.size()) {}

    void resolve() {
        const bool steered = has("steering");
        const bool turned = has("yaw_rate");
        const bool wheels = has("left") || has("right");
        const int odometers = (steered ? 1 : 0) + (turned ? 1 : 0) + (wheels ? 1 : 0);
        if (odometers != 1) {
            problem_("", "",
                     odometers == 0 ? "its signals are no odometer; give left and right, or speed and steering, or "
                                      "speed and yaw_rate, or yaw_rate alone"
                                    : "its signals are more than one odometer; keep left and right, or speed and "
                                      "steering, or speed and yaw_rate, or yaw_rate alone");
            return;
        }
        if (wheels) {
            resolve_wheels();
        } else if (steered) {
            can_.odometer = AckermannParams{
                .speed = speed(), .steering = binding("steering"), .steering_zero_rad = zero("steering")};
        } else {
            can_.odometer = ImuParams{.speed = speed_or_none(),
                                      .yaw_rate = binding("yaw_rate"),
                                      .yaw_rate_bias_radps = zero("yaw_rate"),
                                      .inertial = inertial()};
        }
        if (!turned) {
            for (const std::string_view axis : kAxes) {
                if (has(axis)) {
                    problem_(axis, "", "is used beside yaw_rate only; remove it");
                }
            }
        }
        can_.dbc_text.clear();
        for (std::size_t i = 0; i < texts_.size(); ++i) {
            can_.dbc_text += dbc_excerpt(texts_[i].text, used_[i]);
        }
    }

 private:
    void resolve_wheels() {
        for (const std::string_view other : {"speed", "second_speed"}) {
            if (has(other)) {
                problem_(other, "", "is not used beside left and right; remove it");
            }
        }
        WheelParams params;
        params.left = wheel("left");
        params.right = wheel("right");
        params.speed_max_mps = can_.speed_max_mps;
        params.pair_within = Duration::from_seconds(can_.pair_within_s);
        for (const auto& [role, w] : {std::pair{"left", &params.left}, std::pair{"right", &params.right}}) {
            if (found_ && !unambiguous(*w, params.speed_max_mps)) {
                problem_(role, "timeout_s",
                         "at speed_max_mps the counter may go half round within twice this time; make it shorter");
            }
        }
        can_.odometer = params;
    }

    [[nodiscard]] const SignalConfig* find(std::string_view role) const {
        const auto found =
            std::find_if(can_.signals.begin(), can_.signals.end(), [&](const auto& s) { return s.role == role; });
        return found == can_.signals.end() ? nullptr : &*found;
    }
    [[nodiscard]] bool has(std::string_view role) const { return find(role) != nullptr; }
    [[nodiscard]] double zero(std::string_view role) const { return has(role) ? find(role)->zero : 0.0; }

    SpeedBinding speed() {
        SpeedBinding out{.signal = binding("speed"), .second = std::nullopt};
        if (has("second_speed")) {
            out.second = binding("second_speed");
        }
        return out;
    }

    /// None where the scans have to show it.
    std::optional<SpeedBinding> speed_or_none() {
        return has("speed") || has("second_speed") ? std::optional(speed()) : std::nullopt;
    }

    /// All of the other axes, or none.
    std::optional<InertialBinding> inertial() {
        if (std::none_of(kAxes.begin(), kAxes.end(), [this](std::string_view axis) { return has(axis); })) {
            return std::nullopt;
        }
        return InertialBinding{.roll_rate = binding("roll_rate"),
                               .pitch_rate = binding("pitch_rate"),
                               .acceleration_x = binding("acceleration_x"),
                               .acceleration_y = binding("acceleration_y"),
                               .acceleration_z = binding("acceleration_z")};
    }

    WheelBinding wheel(std::string_view role) {
        WheelBinding out{.signal = binding(role)};
        if (const SignalConfig* config = find(role)) {
            out.is_speed = config->is_speed;
            out.modulus = config->modulus;
            out.backward_bits = config->backward_bits;
            out.direction = beside(*config, "direction", config->direction);
        }
        return out;
    }

    SignalBinding binding(std::string_view role) {
        SignalBinding out;
        const SignalConfig* const config = find(role);
        if (config == nullptr) {
            problem_("", "", join({"has no signal `", role, "`; add a table of that name"}));
            return out;
        }
        const std::size_t dot = config->signal.find('.');
        if (dot == std::string::npos) {
            found_ = false;
            problem_(role, "signal", "is not of the form MESSAGE.SIGNAL; write the two names of the DBC so");
            return out;
        }
        const std::string_view whole = config->signal;
        out.signal = look_up(*config, "signal", whole.substr(0, dot), whole.substr(dot + 1)).value_or(FrameSignal{});
        out.scale = config->scale;
        out.timeout = Duration::from_seconds(config->timeout_s);
        out.valid_bits = config->valid_bits;
        out.validity = beside(*config, "valid", config->valid);
        out.alive = beside(*config, "alive", config->alive);
        if (config->scale == 0.0) {
            problem_(role, "scale",
                     "is 0: nothing would ever move; give the metres, m/s, rad, rad/s or m/s^2 of one unit");
        }
        return out;
    }

    /// Another signal of the same message, where one is named.
    std::optional<FrameSignal> beside(const SignalConfig& config, std::string_view key, std::string_view name) {
        const std::size_t dot = config.signal.find('.');
        if (name.empty() || dot == std::string::npos) {
            return std::nullopt;
        }
        return look_up(config, key, std::string_view(config.signal).substr(0, dot), name);
    }

    std::optional<FrameSignal> look_up(const SignalConfig& config, std::string_view key, std::string_view message,
                                       std::string_view signal) {
        std::string reason;
        for (std::size_t i = 0; i < texts_.size(); ++i) {
            const DbcLookup found = find_signal(texts_[i].text, message, signal);
            if (found.status == DbcLookup::Status::kFound) {
                used_[i].emplace_back(message, signal);
                FrameSignal out = found.signal;
                out.id_mask = config.any_source_address ? kJ1939PgnMask : out.id_mask;
                return out;
            }
            if (found.status == DbcLookup::Status::kBadText) {
                found_ = false;
                if (!std::exchange(bad_text_, true)) {
                    problem_("", "dbc",
                             join({texts_[i].name, ":", std::to_string(found.error.line), ":",
                                   std::to_string(found.error.column), ": ", found.error.reason}));
                }
                return std::nullopt;
            }
            if (reason.empty() || found.status != DbcLookup::Status::kNoMessage) {
                reason = join({texts_[i].name, " ", why_not(found.status, message, signal)});
            }
        }
        found_ = false;
        problem_(config.role, key, join({reason, "; correct the name or the file"}));
        return std::nullopt;
    }

    CanSourceConfig& can_;
    const std::vector<DbcText>& texts_;
    const Problem& problem_;
    /// Message and signal, for each text.
    std::vector<std::vector<std::pair<std::string_view, std::string_view>>> used_;
    bool bad_text_ = false;
    bool found_ = true;
};

}  // namespace

void resolve_bus(CanSourceConfig& can, const std::vector<DbcText>& texts, const Problem& problem) {
    BusResolver(can, texts, problem).resolve();
}

}  // namespace crspf
