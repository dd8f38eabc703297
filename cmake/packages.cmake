# `cpack` in a build folder: a tarball of the program, or Debian packages, the program's and the library's
# (docs/packages.md). scripts/package makes all of them with their sums.
set(CPACK_PACKAGE_NAME ripplenotch)
set(CPACK_PACKAGE_VENDOR "the ripplenotch developers")
set(RIPPLENOTCH_MAINTAINER "the ripplenotch developers <ripplenotch@example.org>" CACHE STRING
    "Who is written to about the packages: Name <address>")
set(CPACK_PACKAGE_CONTACT "${RIPPLENOTCH_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "torque ripple of harmonic drives: find, filter, explain")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "Reads logs of joint torque and joint velocity, finds the ripple that a harmonic
drive puts into the torque sensor, designs and applies the filters that take it
out, and names the effect in which a simulation of the joint and the measured
log disagree.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "The library of the command ripplenotch: headers, a static archive, and the
files by which CMake and pkg-config find them.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_ARCHIVE_RUNTIME_FILE_NAME ripplenotch-${PROJECT_VERSION}-${CMAKE_SYSTEM_PROCESSOR}-linux)
set(CPACK_ARCHIVE_DEVELOPMENT_FILE_NAME ripplenotch-dev-${PROJECT_VERSION}-${CMAKE_SYSTEM_PROCESSOR}-linux)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME ripplenotch)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS gnuplot-nox)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME ripplenotch-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libfmt-dev, libeigen3-dev, libfftw3-dev, libfast-float-dev, nlohmann-json3-dev, nettle-dev, libpugixml-dev")
set(package_of_ZLIB zlib1g-dev)
set(package_of_ZSTD libzstd-dev)
set(package_of_LZ4 liblz4-dev)
set(package_of_LZMA liblzma-dev)
set(package_of_HDF5 libhdf5-dev)
set(package_of_SQLITE libsqlite3-dev)
foreach(name IN LISTS RIPPLENOTCH_CONTAINERS_FOUND)
    string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", ${package_of_${name}}")
endforeach()

# Debian's own files, where a Debian package looks for them; not part of a plain installation.
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
    find_program(RIPPLENOTCH_GZIP gzip REQUIRED)
    set(debian ${PROJECT_BINARY_DIR}/debian)
    configure_file(${CMAKE_CURRENT_LIST_DIR}/package/changelog.in ${debian}/changelog.Debian @ONLY)
    set(packed ${debian}/changelog.Debian.gz)
    add_custom_command(OUTPUT ${packed} DEPENDS ${debian}/changelog.Debian VERBATIM
        COMMAND ${RIPPLENOTCH_GZIP} -9nk -f ${debian}/changelog.Debian)
    add_custom_command(OUTPUT ${debian}/changelog.gz DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md VERBATIM
        COMMAND ${CMAKE_COMMAND} -E copy ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${debian}/changelog
        COMMAND ${RIPPLENOTCH_GZIP} -9n -f ${debian}/changelog)
    list(APPEND packed ${debian}/changelog.gz)
    foreach(page IN LISTS RIPPLENOTCH_MAN_PAGES)
        add_custom_command(OUTPUT ${RIPPLENOTCH_REFERENCE}/${page}.gz DEPENDS ${RIPPLENOTCH_REFERENCE}/${page} VERBATIM
            COMMAND ${RIPPLENOTCH_GZIP} -9nk -f ${RIPPLENOTCH_REFERENCE}/${page})
        list(APPEND packed ${RIPPLENOTCH_REFERENCE}/${page}.gz)
    endforeach()
    add_custom_target(ripplenotch_debian_files ALL DEPENDS ${packed})
    foreach(package IN ITEMS runtime development)
        string(TOUPPER ${package} PACKAGE)
        set(folder ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${PACKAGE}_PACKAGE_NAME})
        install(FILES ${CMAKE_CURRENT_LIST_DIR}/package/copyright ${debian}/changelog.Debian.gz ${debian}/changelog.gz
                DESTINATION ${folder} COMPONENT ${package})
    endforeach()
endif()
include(CPack)
