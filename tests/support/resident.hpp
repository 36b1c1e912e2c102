// How much memory this process holds.
#pragma once

#include <unistd.h>

#include <fstream>

namespace crspf::test {

/// [MiB] in memory now, shared pages included; 0 where /proc does not say.
inline double resident_mib() {
    std::ifstream statm("/proc/self/statm");
    double pages = 0.0;
    statm >> pages >> pages;
    return pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

}  // namespace crspf::test
