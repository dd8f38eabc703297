# A program without shared libraries: `ripplenotch --version` took 2.9 ms and takes 0.8 ms, since finding, mapping and
# relocating nine libraries took two, a sixth of the whole run over a log of 100,000 rows.
# Where an archive is missing (another distribution, a sanitizer's runtime) all stays shared, and the configuration says so.
# What Debian packages are made of has `changing`: shared libraries, but for fmt and HDF5, whose names change with each Debian.
set(RIPPLENOTCH_STATIC ON CACHE STRING "Libraries linked as archives: ON, all where all are there; changing, fmt and HDF5; OFF, none")

# fmt: Debian has it shared or as headers; the definitions in its headers, compiled once, are the archive. Where a version
# of fmt does not link that way, its headers are compiled into every file, which takes longer to build.
add_library(ripplenotch_fmt INTERFACE)
target_link_libraries(ripplenotch_fmt INTERFACE fmt::fmt)
set(RIPPLENOTCH_PROGRAM_LINK_OPTIONS)
if(NOT RIPPLENOTCH_STATIC OR RIPPLENOTCH_SANITIZE)
    return()
endif()

include(CheckCXXSourceCompiles)
include(CheckLinkerFlag)
# -static-pie, not -static: the latter sorts the unwinding tables of the whole program at the first exception, which
# takes 2 ms. Before 2.34 threads were a library of their own in glibc, of which a static program got only parts.
if(NOT RIPPLENOTCH_STATIC STREQUAL changing)
    set(CMAKE_REQUIRED_LINK_OPTIONS -static-pie)
    check_cxx_source_compiles("
        #include <thread>
        #if defined(__GLIBC__) && !__GLIBC_PREREQ(2, 34)
        #error threads outside libc
        #endif
        int main() { std::thread([] {}).join(); }" RIPPLENOTCH_HAS_STATIC_RUNTIME)
    unset(CMAKE_REQUIRED_LINK_OPTIONS)
    find_library(RIPPLENOTCH_FFTW_ARCHIVE NAMES libfftw3.a HINTS ${FFTW_LIBRARY_DIRS})
    find_library(RIPPLENOTCH_NETTLE_ARCHIVE NAMES libnettle.a HINTS ${NETTLE_LIBRARY_DIRS})
    find_library(RIPPLENOTCH_PUGIXML_ARCHIVE NAMES libpugixml.a HINTS ${PUGIXML_LIBRARY_DIRS})
    mark_as_advanced(RIPPLENOTCH_FFTW_ARCHIVE RIPPLENOTCH_NETTLE_ARCHIVE RIPPLENOTCH_PUGIXML_ARCHIVE)
    if(NOT RIPPLENOTCH_HAS_STATIC_RUNTIME OR NOT RIPPLENOTCH_FFTW_ARCHIVE OR NOT RIPPLENOTCH_NETTLE_ARCHIVE
       OR NOT RIPPLENOTCH_PUGIXML_ARCHIVE)
        message(STATUS "ripplenotch is linked with shared libraries: an archive of libc, FFTW, nettle or pugixml is missing")
        return()
    endif()
endif()

ripplenotch_static_containers(RIPPLENOTCH_CONTAINERS_ARE_STATIC)
if(NOT RIPPLENOTCH_CONTAINERS_ARE_STATIC)
    return()
endif()

if(NOT RIPPLENOTCH_STATIC STREQUAL changing)
    set(RIPPLENOTCH_PROGRAM_LINK_OPTIONS -static-pie)
    # 10,000 relocations in 2.6 kB instead of 250 kB, all of which is read at every start: 0.1 ms.
    check_linker_flag(CXX -Wl,-z,pack-relative-relocs RIPPLENOTCH_LINKER_PACKS_RELOCATIONS)
    if(RIPPLENOTCH_LINKER_PACKS_RELOCATIONS)
        list(APPEND RIPPLENOTCH_PROGRAM_LINK_OPTIONS -Wl,-z,pack-relative-relocs)
    endif()
    set_target_properties(PkgConfig::FFTW PROPERTIES INTERFACE_LINK_LIBRARIES "${RIPPLENOTCH_FFTW_ARCHIVE};m")
    set_target_properties(PkgConfig::NETTLE PROPERTIES INTERFACE_LINK_LIBRARIES ${RIPPLENOTCH_NETTLE_ARCHIVE})
    set_target_properties(PkgConfig::PUGIXML PROPERTIES INTERFACE_LINK_LIBRARIES ${RIPPLENOTCH_PUGIXML_ARCHIVE})
endif()
get_target_property(fmt_type fmt::fmt TYPE)
if(NOT fmt_type STREQUAL SHARED_LIBRARY)
    return()
endif()
get_target_property(fmt_include_dirs fmt::fmt INTERFACE_INCLUDE_DIRECTORIES)
if(NOT DEFINED RIPPLENOTCH_FMT_LINKS)  # once a build folder: it takes four seconds
    try_compile(RIPPLENOTCH_FMT_LINKS
        SOURCES ${CMAKE_CURRENT_LIST_DIR}/fmt_check.cpp ${CMAKE_CURRENT_LIST_DIR}/fmt_definitions.cpp
        CMAKE_FLAGS "-DINCLUDE_DIRECTORIES=${fmt_include_dirs}" LINK_OPTIONS ${RIPPLENOTCH_PROGRAM_LINK_OPTIONS}
        CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON)
endif()
if(NOT RIPPLENOTCH_FMT_LINKS)
    message(STATUS "fmt ${fmt_VERSION} is compiled into every file: cmake/fmt_definitions.cpp does not hold all of it")
    set_target_properties(ripplenotch_fmt PROPERTIES INTERFACE_LINK_LIBRARIES fmt::fmt-header-only)
    return()
endif()
add_library(ripplenotch_fmt_archive STATIC ${CMAKE_CURRENT_LIST_DIR}/fmt_definitions.cpp)
ripplenotch_part_of_module(ripplenotch_fmt_archive)
target_include_directories(ripplenotch_fmt_archive SYSTEM
    PUBLIC $<TARGET_PROPERTY:fmt::fmt,INTERFACE_INCLUDE_DIRECTORIES>)
target_compile_definitions(ripplenotch_fmt_archive
    PUBLIC $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
set_target_properties(ripplenotch_fmt PROPERTIES INTERFACE_LINK_LIBRARIES ripplenotch_fmt_archive)
