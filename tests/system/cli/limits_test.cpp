// Commands that the system gives too little: each says what there is too little of, or is done.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

class Limits : public ProgramTest {
  protected:
    /// With `ulimit` so set, in a shell of its own. `run` is told to end after 3 s.
    [[nodiscard]] static Said limited(const std::string& limit, const std::string& arguments) {
        return run("( ulimit " + limit + " && exec timeout -s TERM 3 " + typed(arguments) + " ) < /dev/null");
    }
    [[nodiscard]] std::string daemon() const {
        return "run --no-camera --can nocan0 --rig " + source("hw/rigs/experiment.yaml") + " --maps " +
               path("maps") + " --socket " + path("socket");
    }
    [[nodiscard]] std::string simulate() const {
        return "simulate " + path("rec") + " --rig " + source("tests/data/short/rig.yaml") + " --scenario " +
               source("tests/data/short/scenario.yaml");
    }
};

// 124: it ran until it was told to end.
TEST_F(Limits, of_descriptors_are_named) {
#ifdef OCTOSKIN_SANITIZED  // whose checks open files of their own
    constexpr int kFewest = 12;
#else
    constexpr int kFewest = 5;
#endif
    std::set<int> codes;
    for (const int most : {kFewest, kFewest + 3, 15, 16, 47, 48, 64}) {
        const Said said = limited("-n " + std::to_string(most), daemon());
        codes.insert(said.exit_code);
        EXPECT_EQ(said.exit_code, most < 48 ? 71 : 124) << most << ": " << said.output;
        if (said.exit_code == 71) {
            EXPECT_NE(said.output.find("ulimit -n"), std::string::npos) << said.output;
            EXPECT_NE(said.output.find("may have " + std::to_string(most)), std::string::npos) << said.output;
        }
    }
    EXPECT_EQ(codes, (std::set<int>{71, 124})) << "few are too few, and 64 are enough";
}

#ifndef OCTOSKIN_SANITIZED  // its own memory comes first
TEST_F(Limits, of_memory_are_named) {
    std::set<int> codes;
    for (const int mib : {160, 190, 220}) {
        const Said said = limited("-v " + std::to_string(mib * 1024), simulate());
        codes.insert(said.exit_code);
        EXPECT_TRUE(said.exit_code == 0 || said.exit_code == 71) << mib << ": " << said.output;
        if (said.exit_code == 71) {
            EXPECT_NE(said.output.find(std::to_string(mib) + " MiB"), std::string::npos) << said.output;
        }
        std::filesystem::remove_all(path("rec"));
    }
    EXPECT_TRUE(codes.contains(71));
}
#endif

TEST_F(Limits, of_the_stack_are_named) {
    const Said said = limited("-s 64", simulate());
    EXPECT_EQ(said.exit_code, 71) << said.output;
    EXPECT_NE(said.output.find("ulimit -s"), std::string::npos) << said.output;
}

TEST_F(Limits, of_a_files_size_are_an_error_of_the_write) {
    const Said said = limited("-f 0", simulate());
    EXPECT_EQ(said.exit_code, 73) << said.output;
    EXPECT_NE(said.output.find("File too large"), std::string::npos) << said.output;
}

TEST_F(Limits, a_film_of_holes_is_refused_before_all_of_it_is_read) {
    write(path("film.oni"), "NI10");
    std::filesystem::resize_file(path("film.oni"), std::uintmax_t{1} << 40U);
    const Said said =
        run("timeout 20 " OCTOSKIN_PROGRAM " replay " + path("film.oni") + " --pose 0,0,1,0,0,0");
    EXPECT_EQ(said.exit_code, 65) << said.output;
    EXPECT_NE(said.output.find("holes"), std::string::npos) << said.output;
}

#ifndef OCTOSKIN_SANITIZED  // which needs /proc itself
TEST_F(Limits, without_proc_that_is_said_and_no_helper_out_of_the_working_directory_runs) {
    if (run("unshare -rm mount -t tmpfs none /proc").exit_code != 0) GTEST_SKIP() << "no namespaces here";
    write(path("octoskin-camera"), "#!/bin/sh\ntouch was_run\n");
    std::filesystem::permissions(path("octoskin-camera"), std::filesystem::perms::owner_all);
    const Said said =
        run("cd " + path("") +
            " && unshare -rm sh -c 'mount -t tmpfs none /proc && exec " OCTOSKIN_PROGRAM " cameras'");
    EXPECT_EQ(said.exit_code, 69) << said.output;
    EXPECT_NE(said.output.find("/proc is not mounted"), std::string::npos) << said.output;
    EXPECT_FALSE(std::filesystem::exists(path("was_run")));
}
#endif

}  // namespace
}  // namespace octoskin
