// Text within HTML, SVG and Markdown.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace crspf::experiments {

/// For the text and the quoted attributes of HTML and XML. Control characters, which XML does not know, become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// For a cell of a Markdown table: on one line, and nothing in it is markup.
[[nodiscard]] std::string markdown_cell(std::string_view text);

/// Characters, not bytes, of UTF-8.
[[nodiscard]] std::size_t length_of(std::string_view text);

}  // namespace crspf::experiments
