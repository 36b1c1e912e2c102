#include "tools/crspf/bench_stereo.hpp"

namespace crspf::cli {

void register_stereo_cases() {}

}  // namespace crspf::cli
