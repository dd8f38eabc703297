include(CMakePackageConfigHelpers)
install(TARGETS ripplenotch_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS ripplenotch EXPORT ripplenotch_targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILE_SET lists DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT ripplenotch_targets NAMESPACE ripplenotch:: FILE ripplenotch-targets.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ripplenotch)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/ripplenotch-config.cmake.in
        ${PROJECT_BINARY_DIR}/ripplenotch-config.cmake
        INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ripplenotch)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/ripplenotch-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/ripplenotch-config.cmake ${PROJECT_BINARY_DIR}/ripplenotch-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/ripplenotch)
# What src/cli found of plotly.js.
if(EXISTS ${PROJECT_BINARY_DIR}/share/ripplenotch/plotly-cartesian.min.js)
    install(FILES ${PROJECT_BINARY_DIR}/share/ripplenotch/plotly-cartesian.min.js DESTINATION ${CMAKE_INSTALL_DATADIR}/ripplenotch)
    install(FILES ${PROJECT_BINARY_DIR}/share/ripplenotch/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/ripplenotch RENAME plotly-LICENSE)
endif()
