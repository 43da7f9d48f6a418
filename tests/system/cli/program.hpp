// The real `octoskin` as a user runs it, in a directory of its own.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/system/said.hpp"

namespace octoskin {

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
