// The files of the operator's page, which are part of the program (tools/view/page, embed_page.cmake).
#pragma once

#include <span>
#include <string_view>

namespace crspf::view {

struct PageFile {
    std::string_view path;  ///< of the URL: "/view.js"
    std::string_view content_type;
    std::string_view content;
};

[[nodiscard]] std::span<const PageFile> page_files();

}  // namespace crspf::view
