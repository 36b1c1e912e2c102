#include "tools/experiments/report/report_files.hpp"

#include <string>
#include <string_view>
#include <system_error>

#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"
#include "tools/experiments/report/chart.hpp"
#include "tools/experiments/report/html.hpp"
#include "tools/experiments/report/json.hpp"
#include "tools/experiments/report/markdown.hpp"

namespace crspf::experiments {

namespace {

constexpr const char* kHtml = "report.html";

void write_text(const std::filesystem::path& file, std::string_view text) {
    AtomicFile out(file);
    out.write(text);
    out.commit();
}

void write_figures(const Section& section, const std::filesystem::path& directory) {
    for (const Block& block : section.findings.blocks) {
        if (const auto* chart = std::get_if<Chart>(&block); chart != nullptr && !chart->file.empty()) {
            write_text(directory / (chart->file + ".svg"), svg_of(*chart));
        }
        if (const auto* picture = std::get_if<Picture>(&block); picture != nullptr && !picture->file.empty()) {
            write_png(picture->image, directory / (picture->file + ".png"));
        }
    }
}

}  // namespace

void prepare_directory(const std::filesystem::path& directory) {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) {
        throw InputError(directory.string() + ": cannot be created: " + error.message() + "; give another --out");
    }
    const AtomicFile tried(directory / kHtml);
}

void write_report(const Report& report, const std::filesystem::path& directory) {
    constexpr int kIndent = 2;
    for (const Section& section : report.sections) {
        write_figures(section, directory);
    }
    // A character that is not UTF-8, from a path, is not worth the report.
    const std::string json =
        json_of(report).dump(kIndent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    write_text(directory / "report.json", json + "\n");
    write_text(directory / "headlines.md", headlines_of(report));
    write_text(directory / "claims.md", claims_of(report));
    write_text(directory / kHtml, html_of(report));
}

}  // namespace crspf::experiments
