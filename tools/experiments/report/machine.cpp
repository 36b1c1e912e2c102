#include "tools/experiments/report/machine.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

namespace crspf::experiments {

std::string processor_in(std::string_view cpuinfo) {
    for (const std::string_view key : {"model name", "Model"}) {  // x86; a small ARM computer names its board
        for (std::size_t begin = 0; begin < cpuinfo.size();) {
            const std::size_t end = std::min(cpuinfo.find('\n', begin), cpuinfo.size());
            const std::string_view line = cpuinfo.substr(begin, end - begin);
            const std::size_t value = line.find(": ");
            if (line.substr(0, key.size()) == key && value != std::string_view::npos) {
                return std::string(line.substr(value + 2));
            }
            begin = end + 1;
        }
    }
    return {};
}

std::string this_machine() {
    utsname system{};
    ::uname(&system);
    std::ifstream file("/proc/cpuinfo");
    const std::string cpuinfo{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    const std::string processor = processor_in(cpuinfo);
    const unsigned cores = std::thread::hardware_concurrency();
    return fmt::format("{}, {} {}, {} {}", processor.empty() ? system.machine : processor, cores,
                       cores == 1 ? "core" : "cores", system.sysname, system.release);
}

std::string this_date() {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", now);
}

}  // namespace crspf::experiments
