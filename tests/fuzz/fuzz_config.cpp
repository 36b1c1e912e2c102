// Any text either loads, and then prints and loads back to the same, or is refused by an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "config/config.hpp"
#include "platform/files/input_error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(data, data + size);
    crspf::Config config;
    try {
        config = crspf::parse_config(text, "fuzz.toml");
    } catch (const crspf::InputError& e) {
        if (!std::string_view(e.what()).starts_with("fuzz.toml:")) {
            std::abort();
        }
        return 0;
    }
    const std::string printed = crspf::print_config(config);
    if (crspf::print_config(crspf::parse_config(printed, "printed.toml")) != printed) {
        std::abort();
    }
    return 0;
}
