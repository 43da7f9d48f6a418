# Read once for all libraries of the host and of simulation: of most sources they are a third of the compiler's time. Not in other
# builds, of which the thread sanitizer's is one that every check makes: there a forgotten include of them is an error.
if(CMAKE_BUILD_TYPE STREQUAL "Release" OR OCTOSKIN_SANITIZE MATCHES "address")
    add_library(octoskin_host_headers OBJECT ${PROJECT_SOURCE_DIR}/toolchains/precompiled_headers.cpp)
    target_compile_features(octoskin_host_headers PRIVATE cxx_std_20)
    target_link_libraries(octoskin_host_headers PRIVATE octoskin_compile_options Eigen3::Eigen)
    target_precompile_headers(octoskin_host_headers PRIVATE
        <Eigen/Geometry> <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <span> <string> <vector>)
endif()
