// Runs a fuzz target over files and directories of inputs, without a fuzzer: each file whole, and cut off at
// up to 64 places, or as many as `--cuts=N` says. No input at all is a failure, so that a moved corpus cannot
// pass; so is one that takes over a second of processor time, or two where a sanitizer takes more than twice
// the time.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.hpp"

namespace {

namespace fs = std::filesystem;

#ifdef OCTOSKIN_SANITIZED
constexpr double kLongest_s = 2.0;
#else
constexpr double kLongest_s = 1.0;
#endif

std::size_t cuts_max = 64;
double slowest_s = 0.0;

/// Of this process and of those that it started and that have ended.
double processor_seconds() {
    double sum = 0.0;
    for (const int of_whom : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage used{};
        ::getrusage(of_whom, &used);
        for (const timeval& time : {used.ru_utime, used.ru_stime})
            sum += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
    return sum;
}

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
    const double begun = processor_seconds();
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    slowest_s = std::max(slowest_s, processor_seconds() - begun);
}

std::size_t run_with_cuts(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<char> content{std::istreambuf_iterator<char>(stream), {}};
    // Told before it runs: a crash leaves the last line as its address.
    std::printf("%s\n", file.c_str());
    std::fflush(stdout);
    run(content);
    const std::size_t cuts = std::min(content.size(), cuts_max);
    for (std::size_t i = 0; i < cuts; ++i) run(std::span(content).first(i * content.size() / cuts));
    return 1 + cuts;
}

}  // namespace

int main(int argc, char** argv) {
    std::size_t inputs = 0;
    for (int i = 1; i < argc; ++i) {
        constexpr std::string_view kCuts = "--cuts=";
        if (std::string_view(argv[i]).starts_with(kCuts)) {
            cuts_max = std::strtoul(argv[i] + kCuts.size(), nullptr, 10);
            continue;
        }
        const std::vector<fs::path> files = inputs_in(argv[i]);
        if (files.empty()) {
            std::fprintf(stderr, "%s: no input here\n", argv[i]);
            return 1;
        }
        for (const fs::path& file : files) inputs += run_with_cuts(file);
    }
    std::printf("%zu inputs, the slowest %.3f s\n", inputs, slowest_s);
    return inputs == 0 || slowest_s > kLongest_s ? 1 : 0;
}
