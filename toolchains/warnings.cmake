# Warnings are errors everywhere.
# A cast from 32 bits to std::size_t or from a 64-bit stamp to time_t is needed on one machine and useless on another.
add_compile_options(
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast
    $<$<EQUAL:${CMAKE_SIZEOF_VOID_P},8>:-Wuseless-cast> -Wcast-align
    -Wcast-qual -Wdouble-promotion -Wfloat-conversion -Wformat=2 -Wnon-virtual-dtor -Woverloaded-virtual
    -Wimplicit-fallthrough -Wextra-semi -Wundef -Werror)
if(CMAKE_SIZEOF_VOID_P EQUAL 4)
    add_compile_options(-Wno-psabi)  # g++ 12 tells ARM's users of g++ 6 that std::vector arguments have moved; no fault
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    add_compile_options(-Wnull-dereference -Wno-unknown-warning-option)
else()
    add_compile_options(-Wduplicated-cond -Wduplicated-branches -Wlogical-op)
endif()
