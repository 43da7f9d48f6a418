// A target needs a source; what it precompiles is in CMakeLists.txt.
