// Seeds that are studied at once do not disturb each other.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "host/lab/study/study.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;
namespace fs = std::filesystem;

const fs::path kSources = OCTOSKIN_SOURCE_DIR;

void study(const std::vector<std::uint64_t>& seeds, unsigned jobs, const fs::path& out) {
    StudyRequest request{.inputs = {},
                         .seeds = seeds,
                         .configurations = {"robust"},
                         .jobs = jobs,
                         .papers_scenario = kSources / "hw/worlds/experiment.scenario.yaml",
                         .out = out};
    request.inputs.rig = kSources / "tests/data/short/rig.yaml";
    request.inputs.scenario = kSources / "tests/data/short/scenario.yaml";
    std::vector<std::string> said;
    const auto results = run_study(request, [&](const std::string& line) { said.push_back(line); });
    ASSERT_TRUE(results) << results.error().message();
    EXPECT_GE(said.size(), 2 * seeds.size());
}

TEST(StudyJobs, leave_of_the_first_seed_what_it_leaves_alone) {
    const ScratchFolder folder;
    study({0, 1}, 2, folder / "both");
    study({0}, 1, folder / "alone");
    for (const char* file : {"depth.ot", "proximity.ot", "fused.ot", "recording/can.log"}) {
        const std::string of_both = ScratchFolder::read(folder / "both" / file);
        EXPECT_GT(of_both.size(), 1'000U) << file;
        EXPECT_TRUE(of_both == ScratchFolder::read(folder / "alone" / file)) << file;
    }
}

}  // namespace
}  // namespace octoskin
