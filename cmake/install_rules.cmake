# What `cmake --install` brings, and scripts/package packs: the program with its pages (component runtime), and the library with what
# other projects find it by (component development).
include(CMakePackageConfigHelpers)
include(reference_files)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/ripplenotch)

install(TARGETS ripplenotch_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(FILES README.md LICENSE CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
if(RIPPLENOTCH_MAN_PAGES)
    install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" --build \"${PROJECT_BINARY_DIR}\" --target ripplenotch_reference
                                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)" COMPONENT runtime)
    list(TRANSFORM RIPPLENOTCH_MAN_PAGES PREPEND ${RIPPLENOTCH_REFERENCE}/ OUTPUT_VARIABLE man_pages)
    install(FILES ${man_pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
    install(FILES ${RIPPLENOTCH_REFERENCE}/ripplenotch.bash COMPONENT runtime
            DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME ripplenotch)
endif()
# What src/cli found of plotly.js.
if(EXISTS ${PROJECT_BINARY_DIR}/share/ripplenotch/plotly-cartesian.min.js)
    install(FILES ${PROJECT_BINARY_DIR}/share/ripplenotch/plotly-cartesian.min.js
            DESTINATION ${CMAKE_INSTALL_DATADIR}/ripplenotch COMPONENT runtime)
    install(FILES ${PROJECT_BINARY_DIR}/share/ripplenotch/LICENSE
            DESTINATION ${CMAKE_INSTALL_DATADIR}/ripplenotch RENAME plotly-LICENSE COMPONENT runtime)
endif()

install(TARGETS ripplenotch EXPORT ripplenotch_targets COMPONENT development
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
        FILE_SET lists DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT ripplenotch_targets NAMESPACE ripplenotch:: FILE ripplenotch-targets.cmake
        DESTINATION ${config_dir} COMPONENT development)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/ripplenotch-config.cmake.in
        ${PROJECT_BINARY_DIR}/ripplenotch-config.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/ripplenotch-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/ripplenotch-config.cmake ${PROJECT_BINARY_DIR}/ripplenotch-config-version.cmake
        DESTINATION ${config_dir} COMPONENT development)
string(REPLACE ";" " " pc_containers "${RIPPLENOTCH_CONTAINER_MODULES}")
configure_file(${CMAKE_CURRENT_LIST_DIR}/ripplenotch.pc.in ${PROJECT_BINARY_DIR}/ripplenotch.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/ripplenotch.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
