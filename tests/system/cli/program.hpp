// The real `octoskin` as a user runs it, in a directory of its own.
#pragma once

#include <fmt/format.h>
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

/// Beside this program; called after the program and the files that it is made from and by.
inline std::filesystem::path short_recording() {
    std::string name = "short_recording";
    for (const std::string& origin : {std::string(OCTOSKIN_LAB_PROGRAM), source("tests/data/short/rig.yaml"),
                                      source("tests/data/short/scenario.yaml")})
        name += fmt::format("_{:x}", std::filesystem::last_write_time(origin).time_since_epoch().count());
    return std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
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
    void record_short(const std::string& name, const std::string& more) const {
        simulate_short(path(name), more);
    }
    /// Most tests need no other than this, so it is simulated once for each build, and copied.
    void record_short(const std::string& name) const {
        const std::filesystem::path kept = short_recording();
        if (!std::filesystem::exists(kept)) {
            const std::filesystem::path own = kept.string() + "." + std::to_string(::getpid());
            simulate_short(own, "");
            std::error_code is_there;  // another test was quicker
            std::filesystem::rename(own, kept, is_there);
            std::filesystem::remove_all(own);
        }
        std::filesystem::copy(kept, path(name), std::filesystem::copy_options::recursive);
    }

  private:
    static void simulate_short(const std::filesystem::path& out, const std::string& more) {
        const Said said =
            octoskin("simulate " + out.string() + " --rig " + source("tests/data/short/rig.yaml") +
                     " --scenario " + source("tests/data/short/scenario.yaml") + " " + more);
        ASSERT_EQ(said.exit_code, 0) << said.output;
    }

  protected:
    std::filesystem::path directory_;
};

}  // namespace octoskin
