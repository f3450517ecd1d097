# `cmake --install`: library, headers, and the files for find_package(iqfoc CONFIG) and pkg-config. The installed folder may be moved as a
# whole. Included by src/CMakeLists.txt.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(iqfoc_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/iqfoc)
install(TARGETS iqfoc EXPORT iqfoc-targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/iqfoc DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
    FILES_MATCHING PATTERN "*.h")
# For a port, as source: the checklist, which runs on the host whatever the library was built for, and the start-up of a Cortex-M.
install(FILES ${PROJECT_SOURCE_DIR}/port/check/port_check.c ${PROJECT_SOURCE_DIR}/port/check/port_check.h
              ${PROJECT_SOURCE_DIR}/port/check/port_check_edges.c
              ${PROJECT_SOURCE_DIR}/port/cortex-m4/cortex_m_start.h
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/iqfoc/port_check)
install(EXPORT iqfoc-targets NAMESPACE iqfoc:: FILE iqfoc-targets.cmake DESTINATION ${iqfoc_package_dir})

# Before 1.0 a new minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/iqfoc-config-version.cmake COMPATIBILITY SameMinorVersion)
set(iqfoc_check_dir ${CMAKE_INSTALL_DATAROOTDIR}/iqfoc/port_check)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/iqfoc-config.cmake.in ${PROJECT_BINARY_DIR}/iqfoc-config.cmake
    INSTALL_DESTINATION ${iqfoc_package_dir} PATH_VARS iqfoc_check_dir NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
install(FILES ${PROJECT_BINARY_DIR}/iqfoc-config.cmake ${PROJECT_BINARY_DIR}/iqfoc-config-version.cmake
    DESTINATION ${iqfoc_package_dir})

# pkg-config knows the folder of its file; from there it is so far up to the prefix.
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" OR IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
    set(iqfoc_pc_prefix ${CMAKE_INSTALL_PREFIX})
    set(iqfoc_pc_libdir ${CMAKE_INSTALL_FULL_LIBDIR})
    set(iqfoc_pc_includedir ${CMAKE_INSTALL_FULL_INCLUDEDIR})
else()
    file(RELATIVE_PATH iqfoc_pc_up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
    string(REGEX REPLACE "/$" "" iqfoc_pc_up "${iqfoc_pc_up}")
    set(iqfoc_pc_prefix "\${pcfiledir}/${iqfoc_pc_up}")
    set(iqfoc_pc_libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
    set(iqfoc_pc_includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
endif()
configure_file(${PROJECT_SOURCE_DIR}/cmake/iqfoc.pc.in ${PROJECT_BINARY_DIR}/iqfoc.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/iqfoc.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
