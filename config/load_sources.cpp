#include "config/load_sources.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/bus.hpp"
#include "config/join.hpp"
#include "config/parameters.hpp"
#include "config/port.hpp"
#include "config/suggest.hpp"
#include "config/toml_value.hpp"
#include "core/base/trig.hpp"
#include "drivers/sick/lms2xx_codec.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {

namespace {

constexpr std::size_t kLargestDbc = std::size_t{1} << 25U;

/// One [source.NAME].
class SourceLoader {
 public:
    SourceLoader(std::string_view name, const toml::table& table, const toml::source_position& at, Problems& problems)
        : table_(table), at_(at), problems_(problems), title_(join({"[source.", printable(name), "]"})) {
        source_.name = name;
    }

    /// Nothing where the driver is not known.
    std::optional<SourceConfig> load() {
        read_driver();
        const std::string driver_name = table_["driver"].value_or(std::string());
        for (const auto& [key, node] : table_) {
            if (key.str() != "driver") {
                read_key(driver_name, key, node);
            }
        }
        if (!driver_known_) {
            return std::nullopt;
        }
        check_name();
        resolve_port();
        resolve_driver();
        return source_;
    }

 private:
    void problem(const toml::source_position& at, std::initializer_list<std::string_view> text) {
        problems_.add(at, {title_, " ", join(text)});
    }

    /// Of the configuration.
    [[nodiscard]] std::filesystem::path folder() const { return std::filesystem::path(problems_.file()).parent_path(); }

    [[nodiscard]] toml::source_position place_of(std::string_view key) const {
        const toml::node* const node = table_.get(key);
        return node == nullptr ? at_ : node->source().begin;
    }

    void check_name() {
        constexpr std::size_t kLongest = 32;
        const std::string& name = source_.name;
        const bool good = !name.empty() && name.size() <= kLongest && std::all_of(name.begin(), name.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
        });
        if (!good) {
            problem(at_, {"a name has 1 to 32 letters, digits, _ and -; give another"});
        }
    }

    void read_driver() {
        const SourceParameter& driver = *find("", "driver");
        const toml::node* const node = table_.get("driver");
        if (node == nullptr) {
            problem(at_, {"has no driver; add driver = ", expectation(driver)});
            return;
        }
        const std::string flaw = flaw_of(driver, *node);
        if (!flaw.empty()) {
            problem(node->source().begin, {"driver: ", flaw, "; expected ", expectation(driver)});
            return;
        }
        assign(driver, source_, *node);
        driver_known_ = true;
    }

    [[nodiscard]] static const SourceParameter* find(std::string_view driver, std::string_view key) {
        const auto rows = source_parameters();
        const auto found = std::find_if(rows.begin(), rows.end(), [&](const SourceParameter& p) {
            return p.key == key && (p.table.empty() || p.table == driver);
        });
        return found == rows.end() ? nullptr : &*found;
    }

    void read_key(std::string_view driver, const toml::key& key, const toml::node& node) {
        const auto roles = signal_roles();
        if (node.is_table() && std::find(roles.begin(), roles.end(), key.str()) != roles.end()) {
            if (source_.driver == SourceDriver::kCan && driver_known_) {
                read_signal(key.str(), *node.as_table(), key.source().begin);
            } else if (driver_known_) {
                problem(key.source().begin, {key.str(), ": only a CAN bus has signals; remove it"});
            }
            return;
        }
        const SourceParameter* const parameter = find(driver, key.str());
        if (parameter == nullptr) {
            if (driver_known_) {
                std::vector<std::string_view> names;
                for (const SourceParameter& p : source_parameters()) {
                    if (p.table.empty() || p.table == driver) {
                        names.push_back(p.key);
                    }
                }
                if (source_.driver == SourceDriver::kCan) {
                    names.insert(names.end(), roles.begin(), roles.end());
                }
                problem(key.source().begin, {printable(key.str()), ": unknown key of a ", driver, " source; ",
                                             remedy_for_name(key.str(), names)});
            }
            return;
        }
        const std::string flaw = flaw_of(*parameter, node);
        if (flaw.empty()) {
            assign(*parameter, source_, node);
        } else {
            problem(node.source().begin, {parameter->key, ": ", flaw, "; expected ", expectation(*parameter)});
        }
    }

    void read_signal(std::string_view role, const toml::table& table, const toml::source_position& at) {
        SignalConfig signal;
        signal.role = role;
        bool good = true;
        for (const auto& [key, node] : table) {
            const auto rows = signal_parameters();
            const std::string_view wanted = key.str();
            const auto found =
                std::find_if(rows.begin(), rows.end(), [&](const SignalParameter& p) { return p.key == wanted; });
            if (found == rows.end()) {
                std::vector<std::string_view> names;
                for (const SignalParameter& p : rows) {
                    names.push_back(p.key);
                }
                problem(key.source().begin, {role, ".", printable(key.str()), ": unknown key of a signal; ",
                                             remedy_for_name(key.str(), names)});
                continue;
            }
            const std::string flaw = flaw_of(*found, node);
            if (flaw.empty()) {
                assign(*found, signal, node);
            } else {
                problem(node.source().begin, {role, ".", found->key, ": ", flaw, "; expected ", expectation(*found)});
                good = false;
            }
        }
        if (good && signal.signal.empty()) {
            problem(at, {role, ": has no signal; add signal = \"MESSAGE.SIGNAL\""});
            good = false;
        }
        signals_good_ = signals_good_ && good;
        source_.can.signals.push_back(signal);
    }

    void resolve_port() {
        if (source_.port_text.empty()) {
            problem(place_of("port"), {"has no port; add port = \"/dev/...\", \"tcp://ADDRESS:PORT\", "
                                       "\"udp://:PORT\" or a CAN interface"});
            return;
        }
        const std::optional<PortConfig> port = parse_port(source_.port_text);
        if (!port) {
            problem(place_of("port"), {"port: \"", printable(source_.port_text),
                                       "\" is no address; write /dev/..., tcp://ADDRESS:PORT, udp://:PORT or a CAN "
                                       "interface, addresses as 192.168.0.10"});
            return;
        }
        source_.port = *port;
        using Kind = PortConfig::Kind;
        const auto takes = [&](SourceDriver driver, std::initializer_list<Kind> kinds, std::string_view what) {
            if (source_.driver == driver && std::find(kinds.begin(), kinds.end(), port->kind) == kinds.end()) {
                problem(place_of("port"), {"port: \"", printable(source_.port_text), "\": this driver takes ", what});
            }
        };
        takes(SourceDriver::kScip, {Kind::kSerial, Kind::kTcp}, "a serial device or tcp://ADDRESS:PORT (10940)");
        takes(SourceDriver::kSick, {Kind::kTcp}, "tcp://ADDRESS:PORT (2112)");
        takes(SourceDriver::kLms2xx, {Kind::kSerial}, "a serial device");
        takes(SourceDriver::kLd06, {Kind::kSerial}, "a serial device");
        takes(SourceDriver::kVelodyne, {Kind::kUdp}, "udp://:PORT (2368)");
        takes(SourceDriver::kCan, {Kind::kCan}, "a CAN interface");
        takes(SourceDriver::kMotion, {Kind::kUdp}, "udp://ADDRESS:PORT (127.0.0.1:7750)");
    }

    void resolve_driver() {
        switch (source_.driver) {
            case SourceDriver::kScip: break;
            case SourceDriver::kSick: resolve_sick(); break;
            case SourceDriver::kLms2xx: resolve_lms2xx(); break;
            case SourceDriver::kLd06: break;
            case SourceDriver::kVelodyne: resolve_velodyne(); break;
            case SourceDriver::kCan: resolve_can(); break;
            case SourceDriver::kMotion: break;
        }
    }

    void resolve_sick() {
        if (source_.sick_frequency_hz > 0.0 && source_.sick_resolution_rad > 0.0) {
            SickScanConfig scan;
            scan.frequency_centihertz = static_cast<std::uint32_t>(std::lround(source_.sick_frequency_hz * 100.0));
            scan.resolution_1e4deg =
                static_cast<std::uint32_t>(std::lround(degrees(source_.sick_resolution_rad) * 1e4));
            source_.sick.scan = scan;
        } else if (source_.sick_frequency_hz > 0.0 || source_.sick_resolution_rad > 0.0) {
            problem(at_, {"frequency_hz and resolution_deg are set together or not at all; give both or none"});
        }
    }

    void resolve_lms2xx() {
        Lms2xxMode mode{};
        if (!mode_of_baud(source_.lms2xx.baud, mode)) {
            problem(place_of("baud"), {"baud: the sensor knows 9600, 19200, 38400 and 500000; give one of these"});
        }
        const double resolution_deg = source_.lms2xx_resolution_deg;
        const std::uint32_t angle_deg = source_.lms2xx_angle_deg;
        const bool known = (resolution_deg == 1.0 || resolution_deg == 0.5 || resolution_deg == 0.25) &&
                           (angle_deg == 100 || (angle_deg == 180 && resolution_deg != 0.25));
        if (!known) {
            problem(at_, {"angle, resolution: the sensor knows 180 degrees by 1 or 0.5, and 100 by 1, 0.5 or 0.25; "
                          "give one of these"});
        }
        source_.lms2xx.variant = {.angle_deg = static_cast<std::uint16_t>(angle_deg),
                                  .resolution_cdeg = static_cast<std::uint16_t>(resolution_deg * 100.0)};
        source_.lms2xx.value_mask = static_cast<std::uint16_t>(source_.lms2xx_value_mask);
    }

    void resolve_velodyne() {
        const std::optional<std::uint32_t> address = parse_ipv4(source_.velodyne_address);
        if (!address) {
            problem(place_of("address"), {"address: \"", printable(source_.velodyne_address),
                                          "\" is no IPv4 address; write it as 192.168.1.201"});
        }
        source_.velodyne.source_address = address.value_or(0);
        if (!source_.velodyne_calibration.empty()) {
            source_.velodyne_calibration = (folder() / source_.velodyne_calibration).string();
        }
        if (source_.velodyne_laser >= 0) {
            source_.velodyne_scan.laser = static_cast<std::uint32_t>(source_.velodyne_laser);
        }
    }

    void resolve_can() {
        CanSourceConfig& can = source_.can;
        if (source_.record_only && can.dbc.empty() && can.dbc_text.empty() && can.signals.empty()) {
            return;
        }
        if (can.dbc.empty() == can.dbc_text.empty()) {
            problem(at_, {can.dbc.empty() ? "has neither dbc nor dbc_text; name the file that describes the bus"
                                          : "has both dbc and dbc_text; keep one"});
            return;
        }
        std::vector<DbcText> texts;
        for (const std::string& dbc : can.dbc) {
            const std::string file = (folder() / dbc).string();
            try {
                texts.push_back({file, read_file(file, kLargestDbc)});
            } catch (const InputError& e) {
                problem(place_of("dbc"), {"dbc: ", e.what()});
                return;
            }
        }
        if (texts.empty()) {
            texts.push_back({"dbc_text", can.dbc_text});
        }
        if (!signals_good_) {
            return;
        }
        resolve_bus(can, texts, [&](std::string_view role, std::string_view key, const std::string& text) {
            const toml::node* const table = table_.get(role);
            const toml::node* const node = role.empty() ? table_.get(key)
                                           : table != nullptr && table->is_table() && !key.empty()
                                               ? table->as_table()->get(key)
                                               : table;
            const char* const dot = role.empty() || key.empty() ? "" : ".";
            const char* const colon = role.empty() && key.empty() ? "" : ": ";
            const toml::node* const place = node != nullptr ? node : table;
            problem(place == nullptr ? at_ : place->source().begin, {role, dot, key, colon, text});
        });
    }

    const toml::table& table_;
    toml::source_position at_;
    Problems& problems_;
    std::string title_;
    SourceConfig source_;
    bool driver_known_ = false;
    bool signals_good_ = true;
};

/// What two sources must not share, and what there can be only one of.
void check_together(const std::vector<SourceConfig>& sources, const toml::table& all, Problems& problems) {
    const SourceConfig* lidar = nullptr;
    const SourceConfig* odometer = nullptr;
    for (const SourceConfig& source : sources) {
        const auto problem = [&](std::initializer_list<std::string_view> text) {
            const toml::node* const node = all.get(source.name);
            problems.add(node == nullptr ? toml::source_position{} : node->source().begin,
                         {"[source.", source.name, "] ", join(text)});
        };
        for (const SourceConfig& other : sources) {
            if (&other == &source) {
                break;
            }
            if (other.port_text == source.port_text && !source.port_text.empty()) {
                problem({"port: [source.", other.name, "] has the same; give each source its own"});
            }
        }
        if (source.record_only) {
            continue;
        }
        const SourceConfig*& first = is_lidar(source.driver) ? lidar : odometer;
        if (first != nullptr) {
            problem(
                {is_lidar(source.driver) ? "is a second lidar beside [source." : "is a second odometer beside [source.",
                 first->name, "]; one is used: set record_only = true for the other"});
        } else {
            first = &source;
        }
    }
}

}  // namespace

std::vector<SourceConfig> load_sources(const toml::node& node, Problems& problems) {
    std::vector<SourceConfig> sources;
    if (!node.is_table()) {
        problems.add(node.source().begin, {"source: is ", kind_of(node), "; write [source.NAME] for each sensor"});
        return sources;
    }
    for (const auto& [name, table] : *node.as_table()) {
        if (!table.is_table()) {
            problems.add(name.source().begin, {"[source] ", printable(name.str()), ": is ", kind_of(table),
                                               "; write [source.NAME] for each sensor"});
            continue;
        }
        SourceLoader loader(name.str(), *table.as_table(), name.source().begin, problems);
        if (std::optional<SourceConfig> source = loader.load()) {
            sources.push_back(*std::move(source));
        }
    }
    check_together(sources, *node.as_table(), problems);
    return sources;
}

}  // namespace crspf
