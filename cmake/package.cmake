# `cpack` in the build folder writes Debian packages: librio0 (the shared library), librio-dev, rio (the programs),
# python3-rio and rio-ros2. Configure with -DCMAKE_INSTALL_PREFIX=/usr -DBUILD_SHARED_LIBS=ON -DRIO_BUILD_PYTHON=ON
# -DRIO_BUILD_ROS2=ON.
find_program(RIO_GZIP gzip)
mark_as_advanced(RIO_GZIP)
if(NOT RIO_GZIP)
  return()
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rio)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "rio <rio@localhost>")  # or, as for all Debian tools, who builds it
if(DEFINED ENV{DEBEMAIL})
  set(CPACK_PACKAGE_CONTACT "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "radar-inertial odometry")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_CURRENT_BINARY_DIR}/src)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_SOURCE_DIR}/cmake/compress_manuals.cmake)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()

# rio_package(COMPONENT NAME SECTION DEPENDS SUMMARY TEXT): one package, with the licence and the changes
set(CPACK_COMPONENTS_ALL "")
function(rio_package component name section depends summary text)
  string(TOUPPER ${component} upper)
  set(docs ${CMAKE_CURRENT_BINARY_DIR}/package/${name})
  file(MAKE_DIRECTORY ${docs})
  file(READ LICENSE licence)
  file(WRITE ${docs}/copyright "${licence}")
  file(WRITE ${docs}/changelog "rio (${PROJECT_VERSION}) unstable; urgency=medium\n\n"
    "  * See CHANGELOG.md.\n\n -- ${CPACK_PACKAGE_CONTACT}  Thu, 26 Nov 2026 12:00:00 +0000\n")
  execute_process(COMMAND ${RIO_GZIP} -9nf ${docs}/changelog)
  install(FILES ${docs}/copyright ${docs}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
endfunction()

set(library "")
set(needs_library "")
if(BUILD_SHARED_LIBS)
  set(library librio${PROJECT_VERSION_MAJOR})
  set(needs_library ", ${library} (= ${PROJECT_VERSION})")
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/package/triggers "activate-noawait ldconfig\n")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_BINARY_DIR}/package/triggers)
  rio_package(library ${library} libs "" "radar-inertial odometry, shared library"
    "Estimates pose and velocity of a small robot from an IMU and an FMCW radar.")
endif()
rio_package(dev librio-dev libdevel "libeigen3-dev${needs_library}" "radar-inertial odometry, headers and static libraries"
  "For find_package(rio) and pkg-config: the estimator, its stages, the drivers of\nTI radars, the link to autopilots and the simulator.")
if(TARGET rio_tool)
  rio_package(tools rio science "libc6${needs_library}" "radar-inertial odometry, programs"
    "Replays and checks recordings, runs live, calibrates, simulates and evaluates:\nrio and rio-lab, with their manual page.")
endif()
if(TARGET rio_python)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)  # the module is for this one alone
  math(EXPR next "${Python3_VERSION_MINOR} + 1")
  set(needs_python "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
  rio_package(python python3-rio python "${needs_python}${needs_library}" "radar-inertial odometry, Python package"
    "Replays recordings and feeds the estimator from Python, with numpy arrays.")
endif()
if(TARGET rio_ros2)
  rio_package(ros2 rio-ros2 science "libc6${needs_library}" "radar-inertial odometry, node of ROS 2"
    "IMU and radar topics in, odometry out, without a ROS installation: it speaks DDS.")
endif()
include(CPack)
