# Third-party libraries, all from Debian 12 (packages.txt has the reason for each). Found here, once, so that their
# targets are visible everywhere; which folder may use which is decided by its own CMakeLists.txt.
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED)
find_package(octomap 1.9 REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(urdfdom REQUIRED)
find_package(console_bridge REQUIRED)
find_package(orocos_kdl REQUIRED)
pkg_check_modules(TINYXML2 REQUIRED IMPORTED_TARGET tinyxml2)
if(OCTOSKIN_LAB)
    find_package(sdformat12 REQUIRED)
    find_package(embree 3 REQUIRED)
    find_package(assimp REQUIRED)
endif()
pkg_check_modules(HIGHWAY REQUIRED IMPORTED_TARGET libhwy)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
    # Vectors of a length that is known at run time cannot be members; NEON is used.
    target_compile_definitions(PkgConfig::HIGHWAY INTERFACE
        "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
endif()
if(OCTOSKIN_EMULATED_BOARD)
    pkg_check_modules(UNICORN REQUIRED IMPORTED_TARGET unicorn)
endif()
pkg_check_modules(FUSE3 QUIET IMPORTED_TARGET fuse3)      # optional: only I2C devices for tests are made of it
pkg_check_modules(GPIOD QUIET IMPORTED_TARGET libgpiod)   # optional: only a Linux board's node is made of it
find_package(fcl QUIET)                                   # optional: only an oracle of a test is made of it
find_package(Threads REQUIRED)
pkg_check_modules(OPENNI2 REQUIRED IMPORTED_TARGET libopenni2)
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd)

# OctoMap, KDL and urdfdom name directories and files rather than targets: give them one each. SYSTEM keeps our
# warnings out of their headers.
add_library(octoskin_external_octomap INTERFACE)
target_include_directories(octoskin_external_octomap SYSTEM INTERFACE ${OCTOMAP_INCLUDE_DIRS})
target_link_libraries(octoskin_external_octomap INTERFACE ${OCTOMAP_LIBRARIES})
add_library(external::octomap ALIAS octoskin_external_octomap)
add_library(octoskin_external_kdl INTERFACE)
target_include_directories(octoskin_external_kdl SYSTEM INTERFACE ${orocos_kdl_INCLUDE_DIRS})
target_link_libraries(octoskin_external_kdl INTERFACE ${orocos_kdl_LIBRARIES})
add_library(external::kdl ALIAS octoskin_external_kdl)
add_library(octoskin_external_urdfdom INTERFACE)
target_include_directories(octoskin_external_urdfdom SYSTEM INTERFACE ${urdfdom_INCLUDE_DIRS})
target_link_libraries(octoskin_external_urdfdom INTERFACE ${urdfdom_LIBRARIES})
add_library(external::urdfdom ALIAS octoskin_external_urdfdom)
