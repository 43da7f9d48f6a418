# Read once for all libraries of the host and of simulation: of most sources they are a third of the compiler's time. Not in other
# builds, of which the thread sanitizer's is one that every check makes: there a forgotten include of them is an error.
set(OCTOSKIN_HOST_HEADERS <Eigen/Geometry> <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory>
    <optional> <span> <string> <vector>)
if(CMAKE_BUILD_TYPE STREQUAL "Release" OR OCTOSKIN_SANITIZE MATCHES "address")
    add_library(octoskin_host_headers OBJECT ${PROJECT_SOURCE_DIR}/toolchains/precompiled_headers.cpp)
    target_compile_features(octoskin_host_headers PRIVATE cxx_std_20)
    target_link_libraries(octoskin_host_headers PRIVATE octoskin_compile_options Eigen3::Eigen)
    target_precompile_headers(octoskin_host_headers PRIVATE
        ${OCTOSKIN_HOST_HEADERS})
    # Those of the product's and the laboratory's own rooms have JSON and messages, too.
    add_library(octoskin_app_headers OBJECT ${PROJECT_SOURCE_DIR}/toolchains/precompiled_headers.cpp)
    target_compile_features(octoskin_app_headers PRIVATE cxx_std_20)
    target_link_libraries(octoskin_app_headers PRIVATE octoskin_compile_options octoskin_app_options
        Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json spdlog::spdlog)
    target_precompile_headers(octoskin_app_headers PRIVATE
        ${OCTOSKIN_HOST_HEADERS} <fmt/format.h> <nlohmann/json.hpp> <spdlog/spdlog.h>)
endif()
