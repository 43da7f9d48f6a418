// A fuzz target: arbitrary bytes in, and an assert that fails if the code under test is wrong about them. The
// preset host-fuzz links each with clang's libFuzzer; every other build links it with corpus_main.cpp, so
// that the kept corpus is an ordinary test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

/// libFuzzer's name for the entry point. Returns 0; whatever the bytes, it must not crash, hang, leak or
/// assert.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace octoskin::fuzz {

[[nodiscard]] inline std::string_view text_of(std::span<const std::uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace octoskin::fuzz
