#include "tools/crspf/eval_output.hpp"

#include <cstdio>

#include "platform/files/input_error.hpp"

namespace crspf::cli {

Json to_json(const eval::Summary& s) {
    return {{"mean", s.mean}, {"std", s.std}, {"rms", s.rms}, {"median", s.median}, {"p95", s.p95}, {"max", s.max}};
}

Json to_json(const Pose2& pose) {
    return {{"x_m", pose.x_m}, {"y_m", pose.y_m}, {"theta_deg", degrees(pose.theta_rad)}};
}

void print_json(const Json& json) {
    std::printf("%s\n", json.dump(2).c_str());
}

void check_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        throw InputError("standard output: cannot be written; free some space or send it elsewhere");
    }
}

void print_heading() {
    std::printf("%-28s %10s %10s %10s %10s %10s %10s\n", "", "mean", "std", "rms", "median", "95%", "max");
}

void print_summary(const char* name, const eval::Summary& s) {
    std::printf("%-28s %10.4f %10.4f %10.4f %10.4f %10.4f %10.4f\n", name, s.mean, s.std, s.rms, s.median, s.p95,
                s.max);
}

void print_alignment(const Pose2& pose) {
    std::printf("alignment: x %.4f m, y %.4f m, turn %.4f deg\n", pose.x_m, pose.y_m, degrees(pose.theta_rad));
}

}  // namespace crspf::cli
