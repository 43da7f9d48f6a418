# Third-party libraries, all from Debian 12 (packages.txt has the reason for each). Found here once, so that their targets
# are visible everywhere. Each folder's CMakeLists.txt decides which of them it uses.
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED)
find_package(octomap 1.9 REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(urdfdom REQUIRED)
find_package(assimp REQUIRED)
find_package(console_bridge REQUIRED)
find_package(orocos_kdl REQUIRED)
pkg_check_modules(LIBMD REQUIRED IMPORTED_TARGET libmd)
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(TINYXML2 REQUIRED IMPORTED_TARGET tinyxml2)
if(OCTOSKIN_LAB STREQUAL "AUTO")
    find_package(sdformat12 QUIET)
    find_package(embree 3 QUIET)
    if(sdformat12_FOUND AND embree_FOUND)
        set(OCTOSKIN_LAB ON)
    else()
        set(OCTOSKIN_LAB OFF)
    endif()
elseif(OCTOSKIN_LAB)
    find_package(sdformat12 REQUIRED)
    find_package(embree 3 REQUIRED)
endif()
pkg_check_modules(HIGHWAY REQUIRED IMPORTED_TARGET libhwy)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
    # SVE vectors have a run-time length and cannot be members; NEON is used instead.
    target_compile_definitions(PkgConfig::HIGHWAY INTERFACE
        "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
endif()
if(OCTOSKIN_EMULATED_BOARD)
    pkg_check_modules(UNICORN REQUIRED IMPORTED_TARGET unicorn)
endif()
pkg_check_modules(FUSE3 QUIET IMPORTED_TARGET fuse3)      # optional: for the I2C devices of tests only
pkg_check_modules(GPIOD QUIET IMPORTED_TARGET libgpiod)   # optional: for the node of a Linux board only
find_package(fcl QUIET)                                   # optional: for the oracle of a test only
pkg_check_modules(CYCLONEDDS QUIET IMPORTED_TARGET CycloneDDS)  # optional: for octoskin-bridge only
find_package(Boost 1.74 QUIET)                            # optional: for octoskin-bridge only; headers alone
find_package(Threads REQUIRED)
pkg_check_modules(OPENNI2 REQUIRED IMPORTED_TARGET libopenni2)
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd)

# OctoMap, KDL and urdfdom export directories and files instead of targets: each gets a target here. SYSTEM suppresses the
# project's warnings in their headers.
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
