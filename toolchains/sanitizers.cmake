# -DCRSPF_SANITIZE=address,undefined or thread. The two do not mix. Their presets build with -O1 and line tables only:
# half the compile time of -O2 -g, and all that a report shows.
if(CRSPF_SANITIZE)
    if(CRSPF_SANITIZE MATCHES "thread" AND CRSPF_SANITIZE MATCHES "address")
        message(FATAL_ERROR "CRSPF_SANITIZE: thread and address cannot be combined; build twice")
    endif()
    add_compile_options(-fsanitize=${CRSPF_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    add_link_options(-fsanitize=${CRSPF_SANITIZE})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # g++ 12 takes its own instrumentation of std::regex and std::function for uninitialised reads (GCC bug 105616).
        # The release build keeps the warning.
        add_compile_options(-Wno-maybe-uninitialized)
    endif()
endif()

# libFuzzer steers by the coverage of everything that the targets call, so all of it is instrumented.
if(CRSPF_FUZZ)
    if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
        message(FATAL_ERROR "CRSPF_FUZZ needs clang: use the preset `fuzz`")
    endif()
    add_compile_options(-fsanitize=fuzzer-no-link)
endif()
