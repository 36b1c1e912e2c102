#include "platform/crspfd/map_store.hpp"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/map_server_format.hpp"
#include "platform/files/read_file.hpp"
#include "platform/files/sha256.hpp"

namespace crspf {

namespace {

constexpr std::size_t kKept = 2;
constexpr std::size_t kStateBytesMax = 65536;
constexpr std::size_t kMapBytesMax = kMapCellsMax + 4096;

std::string sha256_of(const std::filesystem::path& file) {
    Sha256 sha;
    const std::string bytes = read_file(file, kMapBytesMax);
    sha.update(std::as_bytes(std::span(bytes)));
    return sha.hex();
}

nlohmann::json json_of(const std::optional<Pose2>& pose) {
    return pose ? nlohmann::json{pose->x_m, pose->y_m, pose->theta_rad} : nlohmann::json();
}

std::optional<Pose2> pose_of(const nlohmann::json& json) {
    if (json.is_null()) {
        return std::nullopt;
    }
    return Pose2{
        .x_m = json.at(0).get<double>(), .y_m = json.at(1).get<double>(), .theta_rad = json.at(2).get<double>()};
}

}  // namespace

MapStore::MapStore(std::filesystem::path directory) : directory_(std::move(directory)) {
    std::error_code error;
    std::filesystem::create_directories(directory_, error);
    if (error) {
        throw InputError(directory_.string() + ": cannot be made: " + error.message() +
                         "; set [service] state_directory to one that the service may write to");
    }
    const std::filesystem::path file = directory_ / "state.json";
    if (!std::filesystem::exists(file, error)) {
        return;
    }
    const auto fail = [&file](const std::string& what) {
        throw InputError(file.string() + ": " + what + "; restore it from a backup, or remove it to begin a new map");
    };
    try {
        const nlohmann::json state = nlohmann::json::parse(read_file(file, kStateBytesMax));
        if (const int version = state.at("version").get<int>(); version != kVersion) {
            fail("is of version " + std::to_string(version) + ", not " + std::to_string(kVersion));
        }
        for (const nlohmann::json& entry : state.at("maps")) {
            entries_.push_back({.number = entry.at("number").get<std::uint64_t>(),
                                .pgm_sha256 = entry.at("pgm_sha256").get<std::string>(),
                                .yaml_sha256 = entry.at("yaml_sha256").get<std::string>(),
                                .P_map_base = pose_of(entry.at("pose"))});
        }
    } catch (const nlohmann::json::exception&) {
        fail("is damaged");
    }
}

std::optional<MapStore::Saved> MapStore::load() const {
    std::string damage;
    for (const Entry& entry : entries_) {
        const std::string wrong = damage_of(entry);
        if (wrong.empty()) {
            const std::filesystem::path yaml = stem(entry.number).concat(".yaml");
            return Saved{.map = read_grid_map(yaml), .P_map_base = entry.P_map_base, .yaml = yaml, .warning = damage};
        }
        damage += (damage.empty() ? "" : "; ") + wrong;
    }
    if (!entries_.empty()) {
        throw InputError(damage + "; restore the files from a backup, or remove " +
                         (directory_ / "state.json").string() + " to begin a new map");
    }
    return std::nullopt;
}

std::filesystem::path MapStore::save(const GridMap& map, const std::optional<Pose2>& P_map_base) {
    const std::uint64_t number = entries_.empty() ? 1 : entries_.front().number + 1;
    write_grid_map(map, stem(number));
    std::filesystem::path yaml = stem(number).concat(".yaml");
    entries_.insert(entries_.begin(), {.number = number,
                                       .pgm_sha256 = sha256_of(stem(number).concat(".pgm")),
                                       .yaml_sha256 = sha256_of(yaml),
                                       .P_map_base = P_map_base});
    const std::vector<Entry> old(entries_.begin() + static_cast<std::ptrdiff_t>(std::min(kKept, entries_.size())),
                                 entries_.end());
    entries_.resize(std::min(kKept, entries_.size()));
    write_state();
    for (const Entry& entry : old) {  // named by nobody any longer
        std::error_code ignored;
        std::filesystem::remove(stem(entry.number).concat(".pgm"), ignored);
        std::filesystem::remove(stem(entry.number).concat(".yaml"), ignored);
    }
    return yaml;
}

void MapStore::save_pose(const Pose2& P_map_base) {
    if (!entries_.empty()) {
        entries_.front().P_map_base = P_map_base;
        write_state();
    }
}

std::filesystem::path MapStore::stem(std::uint64_t number) const {
    return directory_ / ("map-" + std::to_string(number));
}

/// Empty: none.
std::string MapStore::damage_of(const Entry& entry) const {
    for (const auto& [extension, sum] :
         {std::pair{".pgm", &entry.pgm_sha256}, std::pair{".yaml", &entry.yaml_sha256}}) {
        const std::filesystem::path file = stem(entry.number).concat(extension);
        try {
            if (sha256_of(file) != *sum) {
                return file.string() + ": is not what was saved: its checksum differs";
            }
        } catch (const InputError& e) {
            return e.what();
        }
    }
    return {};
}

void MapStore::write_state() const {
    nlohmann::ordered_json state{{"version", kVersion}, {"maps", nlohmann::json::array()}};
    for (const Entry& entry : entries_) {
        state["maps"].push_back({{"number", entry.number},
                                 {"pgm_sha256", entry.pgm_sha256},
                                 {"yaml_sha256", entry.yaml_sha256},
                                 {"pose", json_of(entry.P_map_base)}});
    }
    AtomicFile file(directory_ / "state.json");
    file.write(state.dump(2) + "\n");
    file.commit();
}

}  // namespace crspf
