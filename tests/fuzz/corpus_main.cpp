// Runs a fuzz target over files and directories of inputs, without a fuzzer: each file whole, and cut off at
// up to 64 places. No input at all is a failure, so that a moved corpus cannot pass.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/fuzz_target.hpp"

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCutsMax = 64;

std::vector<fs::path> inputs_in(const fs::path& place) {
    if (!fs::is_directory(place)) return {place};
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(place)) {
        if (entry.is_regular_file()) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// Each input in memory of exactly its size, so that the address sanitizer sees one byte too far.
void run(std::span<const char> content) {
    const std::vector<std::uint8_t> bytes(content.begin(), content.end());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

std::size_t run_with_cuts(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<char> content{std::istreambuf_iterator<char>(stream), {}};
    // Told before it runs: a crash leaves the last line as its address.
    std::printf("%s\n", file.c_str());
    std::fflush(stdout);
    run(content);
    const std::size_t cuts = std::min(content.size(), kCutsMax);
    for (std::size_t i = 0; i < cuts; ++i) run(std::span(content).first(i * content.size() / cuts));
    return 1 + cuts;
}

}  // namespace

int main(int argc, char** argv) {
    std::size_t inputs = 0;
    for (int i = 1; i < argc; ++i) {
        const std::vector<fs::path> files = inputs_in(argv[i]);
        if (files.empty()) {
            std::fprintf(stderr, "%s: no input here\n", argv[i]);
            return 1;
        }
        for (const fs::path& file : files) inputs += run_with_cuts(file);
    }
    std::printf("%zu inputs\n", inputs);
    return inputs == 0 ? 1 : 0;
}
