// Plays a recording as `crspf replay` does and prints the digest of its poses: for tests/digests.sh, which compares
// builds. With nothing but what computes the poses it is built for another processor in a fraction of the time that
// crspf takes. usage: replay_digest portable|fastest CONFIG RECORDING
#include <cstdio>
#include <exception>
#include <string_view>

#include "tools/crspf/replay.hpp"

namespace {

void print_digest(std::string_view kernel, const char* config, const char* recording) {
    crspf::ReplayJob job;
    job.kernel = kernel == "portable" ? crspf::Kernel::kPortable : crspf::Kernel::kFastest;
    job.config = crspf::load_config(config);
    job.logs = {recording};
    std::puts(crspf::run_replay(job).digest.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fputs("usage: replay_digest portable|fastest CONFIG RECORDING\n", stderr);
        return 2;
    }
    try {
        print_digest(argv[1], argv[2], argv[3]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "replay_digest: %s\n", error.what());
        return 1;
    }
    return 0;
}
