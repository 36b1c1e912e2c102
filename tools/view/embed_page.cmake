# Writes the page's files into a C++ file: cmake -DOUT=FILE -DFILES=a,b -P embed_page.cmake. Runs on the machine that builds, so
# that it does not matter for which one is built.
string(REPLACE "," ";" FILES "${FILES}")
set(type_html "text/html; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_svg "image/svg+xml")
set(end "CRSPF_END")
set(entries "")
foreach(file IN LISTS FILES)
    cmake_path(GET file FILENAME name)
    cmake_path(GET file EXTENSION LAST_ONLY extension)
    string(SUBSTRING "${extension}" 1 -1 extension)
    if(NOT DEFINED type_${extension})
        message(FATAL_ERROR "${file}: embed_page.cmake knows no content type for it")
    endif()
    if(name STREQUAL "index.html")
        set(name "")
    endif()
    file(READ "${file}" content)
    string(FIND "${content}" ")${end}\"" found)
    if(NOT found EQUAL -1)
        message(FATAL_ERROR "${file} holds )${end}\", which ends a literal")
    endif()
    string(APPEND entries "    {\"/${name}\", \"${type_${extension}}\", R\"${end}(${content})${end}\"},\n")
endforeach()
file(WRITE "${OUT}" "// Made by embed_page.cmake.
#include \"tools/view/page_files.hpp\"

namespace crspf::view {
namespace {
constexpr PageFile kPageFiles[] = {
${entries}};
}

std::span<const PageFile> page_files() {
    return kPageFiles;
}

}  // namespace crspf::view
")
