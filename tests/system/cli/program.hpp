// Runs the real `octoskin` as a user does, and keeps what it said.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace octoskin {

struct Said {
    int exit_code = -1;
    std::string output;  ///< standard output and standard error
};

/// Through the shell; `arguments` as typed.
inline Said run(const std::string& command) {
    Said said;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    if (pipe == nullptr) return said;
    std::array<char, 4096> buffer{};
    for (std::size_t read = 0; (read = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
        said.output.append(buffer.data(), read);
    }
    const int status = pclose(pipe);
    said.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return said;
}

inline Said octoskin(const std::string& arguments) {
    return run(OCTOSKIN_PROGRAM " " + arguments);
}

inline std::string source(const std::string& relative) {
    return OCTOSKIN_SOURCE_DIR "/" + relative;
}

inline std::string content(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

/// A directory of its own for each test, removed afterwards.
class ProgramTest : public testing::Test {
  protected:
    ProgramTest()
        : directory_(std::filesystem::path(testing::TempDir()) /
                     ("octoskin_cli_" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(directory_);
    }
    ~ProgramTest() override { std::filesystem::remove_all(directory_); }

    [[nodiscard]] std::string path(const std::string& name) const { return (directory_ / name).string(); }

    /// A recording of the experiment at a tenth of its length, with a small camera.
    void record_short(const std::string& name, const std::string& more = "") const {
        const Said said =
            octoskin("simulate " + path(name) + " --rig " + source("tests/data/short/rig.yaml") +
                     " --scenario " + source("tests/data/short/scenario.yaml") + " " + more);
        ASSERT_EQ(said.exit_code, 0) << said.output;
    }

    std::filesystem::path directory_;
};

}  // namespace octoskin
