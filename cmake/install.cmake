# Installs rio::rio, rio::core, rio::ti, rio::mavlink, rio::static_memory and rio::sim so that find_package(rio) gives
# them; with the programs also rio::files, where GoogleTest is installed also rio::testing. Components: library, dev,
# tools, python (cmake/package.cmake).
include(CMakePackageConfigHelpers)

set(installed rio_core rio_sim rio_static_memory rio_ti rio_mavlink rio)
if(TARGET rio_files)
  list(APPEND installed rio_files)
endif()
if(TARGET rio_testing)
  list(APPEND installed rio_testing)
endif()
install(TARGETS ${installed} EXPORT rio-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT dev
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
# io/ and bag/ need more than Eigen and serve the tools only
install(DIRECTORY include/rio DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev
  FILES_MATCHING PATTERN "*.hpp" PATTERN "io" EXCLUDE PATTERN "bag" EXCLUDE)
install(EXPORT rio-targets NAMESPACE rio:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rio COMPONENT dev)
configure_package_config_file(cmake/rio-config.cmake.in rio-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rio)
write_basic_package_version_file(rio-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/rio-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/rio-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/rio COMPONENT dev)

# For those who build without CMake; the prefix is where the file lies
file(RELATIVE_PATH RIO_PC_TO_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" RIO_PC_TO_PREFIX "${RIO_PC_TO_PREFIX}")
configure_file(cmake/rio.pc.in rio.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/rio.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)

# The examples and the page of the integrators
install(DIRECTORY src/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/rio COMPONENT dev
  FILES_MATCHING PATTERN "*.cpp" PATTERN "*.hpp")
install(FILES data/INTEGRATION.md DESTINATION ${CMAKE_INSTALL_DATADIR}/rio COMPONENT dev)

# Files to start from: options, maps of recordings, a scenario, a radar's configuration
if(TARGET rio_tool)
  install(DIRECTORY data/config DESTINATION ${CMAKE_INSTALL_DATADIR}/rio COMPONENT tools)
  install(FILES data/awr1843boost_odometry.cfg DESTINATION ${CMAKE_INSTALL_DATADIR}/rio/config COMPONENT tools)
endif()
include(cmake/package.cmake)
