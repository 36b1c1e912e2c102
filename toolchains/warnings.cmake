# Warnings are errors everywhere.
add_compile_options(
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast -Wuseless-cast -Wcast-align
    -Wcast-qual -Wdouble-promotion -Wfloat-conversion -Wformat=2 -Wnon-virtual-dtor -Woverloaded-virtual
    -Wimplicit-fallthrough -Wextra-semi -Wundef -Werror)
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    add_compile_options(-Wnull-dereference -Wno-unknown-warning-option)
else()
    add_compile_options(-Wduplicated-cond -Wduplicated-branches -Wlogical-op)
endif()
