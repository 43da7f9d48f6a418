// A target needs a source; CMake lists the precompiled headers.
