// Commands that the system gives too little: each says what there is too little of, or is done.
#include <gmock/gmock.h>

#include <array>
#include <set>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::code_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class Limits : public ProgramTest {
  protected:
    /// With `ulimit` so set, in a shell of its own. `run` is told to end after 3 s.
    [[nodiscard]] static Failure limited(const std::string& limit, const std::string& arguments) {
        return failure_in(run("( ulimit " + limit + " && exec timeout -s TERM 3 " +
                              typed_for_error(arguments) + " ) < /dev/null"));
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
        const Failure said = limited("-n " + std::to_string(most), daemon());
        codes.insert(said.exit_code);
        EXPECT_EQ(said.exit_code, most < 48 ? 71 : 124) << most << ": " << said.output;
        if (said.exit_code == 71) {
            EXPECT_THAT(said, fails_with(71, code_is(ErrorCode::no_resources),
                                         value_is("a limit of " + std::to_string(most)),
                                         remedy_is(HasSubstr("ulimit -n"))));
        }
    }
    EXPECT_EQ(codes, (std::set<int>{71, 124})) << "few are too few, and 64 are enough";
}

#ifndef OCTOSKIN_SANITIZED  // its own memory comes first
TEST_F(Limits, of_memory_are_named) {
    std::set<int> codes;
    for (const int mib : {160, 190, 220}) {
        const Failure said = limited("-v " + std::to_string(mib * 1024), simulate());
        codes.insert(said.exit_code);
        EXPECT_TRUE(said.exit_code == 0 || said.exit_code == 71) << mib << ": " << said.output;
        if (said.exit_code == 71) {
            EXPECT_THAT(said, fails_with(71, code_is(ErrorCode::no_resources),
                                         what_is(HasSubstr(std::to_string(mib) + " MiB")),
                                         remedy_is(HasSubstr("ulimit -v"))));
        }
        std::filesystem::remove_all(path("rec"));
    }
    EXPECT_TRUE(codes.contains(71));
}
#endif

TEST_F(Limits, of_the_stack_are_named) {
    EXPECT_THAT(limited("-s 64", simulate()),
                fails_with(71, code_is(ErrorCode::no_resources), value_is("a limit of 64 KiB"),
                           remedy_is(HasSubstr("ulimit -s"))));
}

TEST_F(Limits, of_a_files_size_are_an_error_of_the_write) {
    EXPECT_THAT(limited("-f 0", simulate()), fails_with(73, what_is(HasSubstr("File too large"))));
}

TEST_F(Limits, a_film_of_holes_is_refused_before_all_of_it_is_read) {
    write(path("film.oni"), "NI10");
    std::filesystem::resize_file(path("film.oni"), std::uintmax_t{1} << 40U);
    EXPECT_THAT(failure_in(run("timeout 20 " +
                               typed_for_error("replay " + path("film.oni") + " --pose 0,0,1,0,0,0"))),
                fails_with(65, code_is(ErrorCode::wrong_kind_of_file), path_is(path("film.oni")),
                           what_is(HasSubstr("holes"))));
}

#ifndef OCTOSKIN_SANITIZED  // which needs /proc itself
TEST_F(Limits, without_proc_that_is_said_and_no_helper_out_of_the_working_directory_runs) {
    if (run("unshare -rm mount -t tmpfs none /proc").exit_code != 0) GTEST_SKIP() << "no namespaces here";
    write(path("octoskin-camera"), "#!/bin/sh\ntouch was_run\n");
    std::filesystem::permissions(path("octoskin-camera"), std::filesystem::perms::owner_all);
    EXPECT_THAT(
        failure_in(run("cd " + path("") + " && unshare -rm sh -c 'mount -t tmpfs none /proc && exec " +
                       typed_for_error("cameras") + "'")),
        fails_with(69, code_is(ErrorCode::unsupported), path_is("/proc"), remedy_is(HasSubstr("mount"))));
    EXPECT_FALSE(std::filesystem::exists(path("was_run")));
}
#endif

}  // namespace
}  // namespace octoskin
