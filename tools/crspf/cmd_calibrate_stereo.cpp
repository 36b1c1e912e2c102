// crspf calibrate stereo: how a pair of cameras sees, from pictures of a chessboard.
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/atomic_file.hpp"
#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/stereo_calibration.hpp"
#include "tools/crspf/calibrate_commands.hpp"
#include "tools/crspf/calibrate_stereo.hpp"

namespace crspf::cli {
namespace {

struct Options {
    std::vector<std::string> inputs;
    std::string board = "9x6";
    double square_m = 0.0;
    std::string out;
};

constexpr int kCornersMin = 3;
constexpr int kCornersMax = 50;

Board board_of(const Options& options) {
    std::string text = options.board;
    if (const std::size_t by = text.find('x'); by != std::string::npos) {
        text[by] = ' ';
    }
    Board board{.columns = 0, .rows = 0, .square_m = options.square_m};
    Fields fields(text);
    const auto possible = [](int corners) { return corners >= kCornersMin && corners <= kCornersMax; };
    if (!fields.numbers(board.columns, board.rows) || !fields.at_end() || !possible(board.columns) ||
        !possible(board.rows) || board.columns == board.rows) {
        throw InputError(
            "--board " + options.board +
            ": not two different numbers of inner corners from 3 to 50; a board of 10 by 7 squares is 9x6");
    }
    return board;
}

void print_row(const char* name, double left, double left_stddev, double right, double right_stddev, const char* unit) {
    std::printf("%-14s %10.4f +- %-8.4f %10.4f +- %-8.4f  %s\n", name, left, left_stddev, right, right_stddev, unit);
}

void print_camera(const StereoEstimate& e) {
    std::printf("%-14s %10s %11s %10s\n", "", "left", "", "right");
    const CameraIntrinsics& l = e.left.value;
    const CameraIntrinsics& r = e.right.value;
    const CameraIntrinsics& dl = e.left.stddev;
    const CameraIntrinsics& dr = e.right.stddev;
    print_row("focal length x", l.fx_px, dl.fx_px, r.fx_px, dr.fx_px, "px");
    print_row("focal length y", l.fy_px, dl.fy_px, r.fy_px, dr.fy_px, "px");
    print_row("centre x", l.cx_px, dl.cx_px, r.cx_px, dr.cx_px, "px");
    print_row("centre y", l.cy_px, dl.cy_px, r.cy_px, dr.cy_px, "px");
    constexpr const char* kNames[] = {"k1", "k2", "p1", "p2", "k3"};
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
        if (dl.distortion[i] > 0.0 || dr.distortion[i] > 0.0) {  // else the pictures do not tell it
            print_row(kNames[i], l.distortion[i], dl.distortion[i], r.distortion[i], dr.distortion[i], "");
        }
    }
}

void print_names(const char* what, const std::vector<std::string>& names) {
    if (names.empty()) {
        return;
    }
    std::printf("%s:\n", what);
    for (const std::string& name : names) {
        std::printf("    %s\n", name.c_str());
    }
}

void print(const StereoCalibrateOutcome& outcome) {
    const StereoEstimate& e = outcome.estimate;
    std::printf("%-40s %8s %8s %8s    [px]\n", "pair", "left", "right", "rows");
    for (const PairError& pair : e.pairs) {
        std::printf("%-40s %8.3f %8.3f %8.3f\n", pair.name.c_str(), pair.left_px, pair.right_px, pair.rows_px);
    }
    std::printf("\n");
    print_camera(e);
    std::printf("\nbaseline       %.5f +- %.5f m; the right camera is turned by %.3f deg\n", e.baseline_m,
                e.baseline_stddev_m, degrees(e.turned_rad));
    std::printf("left over      %.3f px left, %.3f px right, %.3f px both together; rows differ by %.3f px\n",
                e.left.rms_px, e.right.rms_px, e.rms_px, e.rows_px);
    std::printf("used           %zu of %zu pairs, without the board %zu", e.pairs.size(), outcome.looked_at,
                outcome.without_board.size());
    if (outcome.not_moved + outcome.left_out > 0) {
        std::printf(", board not moved %zu, more than needed %zu", outcome.not_moved, outcome.left_out);
    }
    std::printf("\n");
    print_names("the board is not seen whole by both cameras", outcome.without_board);
    print_names("far worse than the others; look at them, take them out and try again", outcome.worst);
    for (const std::string& doubt : outcome.doubts) {
        std::printf("warning: %s\n", doubt.c_str());
    }
}

void run(const Options& options) {
    StereoCalibrateJob job;
    job.inputs.assign(options.inputs.begin(), options.inputs.end());
    job.board = board_of(options);
    const bool terminal = isatty(STDERR_FILENO) != 0;
    if (terminal) {
        job.progress = [](std::size_t looked_at, std::size_t used) {
            std::fprintf(stderr, "\r%zu pairs, board in %zu", looked_at, used);
        };
    }
    const StereoCalibrateOutcome outcome = run_stereo_calibration(job);
    if (terminal) {
        std::fprintf(stderr, "\r\033[K");
    }
    print(outcome);
    const std::string text = write_stereo_calibration(outcome.estimate.calibration);
    if (options.out.empty()) {
        std::printf("\n%s", text.c_str());
        return;
    }
    AtomicFile file(options.out);
    file.write(text);
    file.commit();
    std::printf("written to %s\n", options.out.c_str());
}

}  // namespace

void add_calibrate_stereo(CLI::App& calibrate) {
    CLI::App* const command =
        calibrate.add_subcommand("stereo", "How a pair of cameras sees, from pictures of a chessboard");
    const auto options = std::make_shared<Options>();
    command
        ->add_option("INPUT", options->inputs,
                     "Folders with left*.png and right*.png, or with image_0 and image_1; recordings of the camera")
        ->required();
    command->add_option("--board", options->board, "Inner corners of the board, where four squares meet")
        ->capture_default_str();
    command->add_option("--square", options->square_m, "Side of a square [m]; measure it on the print")
        ->required()
        ->check(CLI::Range(0.001, 1.0));
    command->add_option("--out", options->out, "File for [stereo] calibration; default: it is shown");
    command->footer(
        "Finds focal lengths, centres and distortions of both cameras, how far apart they are and how they are "
        "turned,\n"
        "each with its standard deviation, and how well each pair of pictures fits. docs/stereo.md says how to take\n"
        "them: 30 pairs, the board flat and still, tilted to each side, and in every corner of the picture.\n"
        "\n"
        "Examples:\n"
        "  crspf calibrate stereo pictures --board 9x6 --square 0.025 --out stereo.yaml\n"
        "  crspf calibrate stereo runs/crspf-*.pcapng --board 8x5 --square 0.030 --out stereo.yaml");
    command->callback([options] { run(*options); });
}

}  // namespace crspf::cli
