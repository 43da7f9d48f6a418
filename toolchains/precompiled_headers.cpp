// A target needs a source; what it precompiles is told in CMake.
