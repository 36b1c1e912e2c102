# One library target per row of the layer table in CONTRIBUTING.md. The include root is the repository root, so that an
# include line names its layer; tools/checks/layers.py holds the include lines against the table.

# crspf_library(name SOURCES... ): a layer that may use exceptions and the operating system.
function(crspf_library name)
    add_library(${name} STATIC ${ARGN})
    target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
endfunction()

# crspf_core_library(name SOURCES...): a layer that runs in real-time threads. No exceptions, no RTTI; no FMA
# contraction, so that the same bits come out of every compiler, level and processor.
function(crspf_core_library name)
    crspf_library(${name} ${ARGN})
    # g++ 12 sees null dereferences inside the standard's strings and vectors at -O2; the core has neither.
    target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti -Wnull-dereference)
    target_compile_options(${name} PUBLIC -ffp-contract=off)
endfunction()

# crspf_driver_library(name SOURCES...): bytes to samples and back; runs in real-time threads as the core does.
function(crspf_driver_library name)
    crspf_core_library(${name} ${ARGN})
    target_link_libraries(${name} PUBLIC crspf_base)
endfunction()
