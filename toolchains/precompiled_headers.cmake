# Precompiled once for all libraries of the host and the simulation: in most sources these headers take a third of the
# compile time. Other builds do not use them, such as the thread sanitizer's in every check: there a missing include of
# them is an error.
set(OCTOSKIN_HOST_HEADERS <Eigen/Geometry> <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory>
    <optional> <span> <string> <vector>)
if(CMAKE_BUILD_TYPE STREQUAL "Release" OR OCTOSKIN_SANITIZE MATCHES "address")
    add_library(octoskin_host_headers OBJECT ${PROJECT_SOURCE_DIR}/toolchains/precompiled_headers.cpp)
    target_compile_features(octoskin_host_headers PRIVATE cxx_std_20)
    target_link_libraries(octoskin_host_headers PRIVATE octoskin_compile_options Eigen3::Eigen)
    target_precompile_headers(octoskin_host_headers PRIVATE
        ${OCTOSKIN_HOST_HEADERS})
    # The rooms of the product's and the laboratory's applications also have JSON and messages.
    add_library(octoskin_app_headers OBJECT ${PROJECT_SOURCE_DIR}/toolchains/precompiled_headers.cpp)
    target_compile_features(octoskin_app_headers PRIVATE cxx_std_20)
    target_link_libraries(octoskin_app_headers PRIVATE octoskin_compile_options octoskin_app_options
        Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json spdlog::spdlog)
    target_precompile_headers(octoskin_app_headers PRIVATE
        ${OCTOSKIN_HOST_HEADERS} <fmt/format.h> <nlohmann/json.hpp> <spdlog/spdlog.h>)
endif()
