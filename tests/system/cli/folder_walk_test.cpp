// Each command over a recording, a maps folder or an experiment of somebody else, with a trap in each place
// that it touches: nothing outside changes, nothing of it is shown, and no command waits.
#include <gmock/gmock.h>

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <regex>
#include <set>
#include <thread>
#include <vector>

#include "host/lab/study/results_folder.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/folder_states.hpp"
#include "tests/system/cli/folder_traps.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

/// Hard links have a walk of their own.
constexpr Trap kTraps[] = {Trap::link_to_file,    Trap::absolute_link, Trap::link_to_folder,
                           Trap::link_to_nothing, Trap::pipe,          Trap::device,
                           Trap::folder};

/// One command: `{}` is the folder with the trap, "{}.own" a path beside it that is the caller's.
struct Walk {
    const char* command;
    std::vector<std::string> refused;  ///< a trap there ends it, and is named
    std::vector<std::string> cleared;  ///< of octoskin's own: removed, or passed over
    const char* from = "rec";          ///< what the folder is made of
};

const std::vector<std::string> kRead{"can.log",          "depth.oni",
                                     "depth.epoch.yaml", "rig.yaml",
                                     "robot.urdf",       "meta.yaml",
                                     "order.log",        "mapping.yaml",
                                     "first.ot",         "first.snapshot",
                                     "last.ot",          "depth",
                                     "depth/left.oni",   "depth/left.epoch.yaml",
                                     ".octoskin-ready"};
const std::vector<std::string> kMaps{
    "maps",           "maps/depth.ot",  "maps/proximity.bt",   "maps/fused.ot",
    "maps/fused.ply", "maps/maps.yaml", "maps/.octoskin-ready"};
const std::vector<std::string> kWritten{"can.log",        "depth.oni",   "depth.epoch.yaml", "rig.yaml",
                                        "robot.urdf",     "meta.yaml",   "scenario.yaml",    "world.sdf",
                                        "motion.yaml",    "mesh_01.obj", "maps/depth.ot",    "maps/fused.bt",
                                        "maps/maps.yaml", "depth",       "depth/left.oni"};

std::vector<std::string> joined(std::vector<std::string> one, const std::vector<std::string>& other) {
    one.insert(one.end(), other.begin(), other.end());
    return one;
}
std::vector<std::string> below(const std::string& folder, std::vector<std::string> names) {
    for (std::string& name : names) name.insert(0, folder + "/");
    return names;
}

constexpr const char* kEvaluateMap = "evaluate {}/maps/fused.ot --rig {}/rig.yaml";

/// Not here: status, monitor, joints without a rig, cameras and record touch no folder but a daemon's socket
/// (the daemon that records: tests/unit/host/apps/daemon/recording_writer_test.cpp, its maps:
/// folder_test.cpp).
std::vector<Walk> all_walks() {
    const std::string short_run = " --rig " + source("tests/data/gantry/rig.yaml") + " --scenario " +
                                  source("tests/data/gantry/scenario.yaml");
    static const std::string simulate = "simulate {} --force" + short_run;
    static const std::string experiment = "experiment --out {}" + short_run;
    static const std::string block =
        "rig " + source("hw/rigs/bench_linux_board.yaml") + " --block {}/block.bin";
    static const std::string flash = "flash --dry-run --rig " + source("hw/rigs/bench_one_board.yaml") +
                                     " --node bench --elf " + source("README.md") + " --out {}";
    const std::vector<std::string> rig{"rig.yaml", "robot.urdf"};
    return {
        {"replay {}", joined(kRead, kMaps), {"maps/.octoskin-part", "maps/.fused.ot.octoskin-part"}},
        {"replay {} --out {}.own", kRead, {"maps"}},
        {"explain 0 0 1 --recording {}", kRead, {"maps", "scenario.yaml"}},
        // Of a recording that its own scene is asked of.
        {"evaluate {}",
         joined(kRead, {"scenario.yaml", "world.sdf", "mesh_01.obj"}),
         {"maps", "motion.yaml"}},
        {kEvaluateMap, joined(rig, {"maps/maps.yaml", "meta.yaml"}), {"maps/recording"}},
        {"query {}/maps/fused.ot --rig {}/rig.yaml --joints 0,0,0 --json", rig, {"maps/maps.yaml"}},
        {simulate.c_str(), kWritten, {".octoskin-part"}},
        {experiment.c_str(),
         joined({"metrics.json", "report.html", "maps.yaml", "fused.ot", "depth.ply", ".octoskin-experiment",
                 "recording"},
                below("recording", kWritten)),
         {},
         "out"},
        {"repair {}", {".octoskin-ready"}, {"maps", "recording", "can.log", ".octoskin-part"}},
        {"rig {}/rig.yaml", rig, {}},
        {"rig --canonical {}/rig.yaml", rig, {}},
        {"mapping {}/mapping.yaml", {"mapping.yaml"}, {}},
        {"calibrate offset --rig {}/rig.yaml --sensor none --target-mm 140 --can nocan9 --write", rig, {}},
        {"command all identify --can nocan9 --rig {}/rig.yaml", rig, {}},
        {"joints --can nocan9 --rig {}/rig.yaml", rig, {}},
        {"flash --dry-run --rig {}/rig.yaml --elf {}/can.log --out {}.own", rig, {}},
        {"run --no-camera --can nocan9 --rig {}/rig.yaml --maps {}.own --socket {}.own/s", rig, {}},
        {"black-box {}/can.log", {}, {"can.log"}},
    };
}

/// Texts of somebody else that name files outside; `@` is that folder.
struct Text {
    const char* command;
    const char* place;
    const char* text;
};
constexpr const char* kMetaOfOthers =
    "schema: octoskin-recording/1\nsource: simulation\nworld: @/rec/world.sdf\nscenario: "
    "../outside/rec/scenario.yaml\n";
constexpr Text kTexts[] = {
    {"replay {}", "rig.yaml", "extends: ../outside/rec/rig.yaml\n"},
    {"replay {} --out {}.own", "rig.yaml", "extends: @/rec/secret\n"},
    {"rig {}/rig.yaml", "rig.yaml", "extends: @/rec/secret\n"},
    {"rig --canonical {}/rig.yaml", "rig.yaml", "extends: ../outside/rec/secret\n"},
    {"query {}/maps/fused.ot --rig {}/rig.yaml --joints 0,0,0 --json", "rig.yaml", "extends: @/rec/secret\n"},
    {"evaluate {}", "meta.yaml", kMetaOfOthers},
    {"evaluate {}", "scenario.yaml", "extends: @/rec/scenario.yaml\n"},
    {"evaluate {}", "world.sdf", "<sdf version='1.7'><include><uri>@/rec/world.sdf</uri></include></sdf>"},
    {"evaluate {}/maps/fused.ot --rig {}/rig.yaml", "maps/maps.yaml", "extends: @/rec/secret\n"},
    {"mapping {}/mapping.yaml", "mapping.yaml", "extends: @/rec/secret\n"},
};

/// One half of the walk, in a folder of its own, so that two go at once.
class Walker {
  public:
    Walker(fs::path templates, const fs::path& home)
        : templates_(std::move(templates)), home_(home), outside_(home / "outside") {
        fs::create_directories(outside_);
        for (const char* from : {"rec", "out"})
            fs::copy(templates_ / from, outside_ / from, fs::copy_options::recursive);
        before_ = states_in(outside_, Bytes::trusted);
        bytes_before_ = states_in(outside_, Bytes::compared);
    }
    ~Walker() { EXPECT_EQ(states_in(outside_, Bytes::compared), bytes_before_); }
    Walker(const Walker&) = delete;
    Walker& operator=(const Walker&) = delete;

    void go(const Walk& walk, const std::string& place, Trap trap) {
        // A folder is what belongs there, or what octoskin makes.
        const std::string name_of_place = fs::path(place).filename().string();
        const bool is_folders = place == "maps" || place == "recording" || name_of_place == "depth" ||
                                name_of_place == ".octoskin-ready";
        if (trap == Trap::folder && is_folders) return;
        const fs::path folder = make(walk);
        const std::string name =
            walk.command + (": trap " + std::to_string(static_cast<int>(trap))) + " at " + place;
        if (!lay(trap, folder / place, outside_ / walk.from / place, outside_ / walk.from)) {
            unlaid_.insert(trap);
            return;
        }
        const Failure said = expect_harmless(walk, name);
        EXPECT_NE(said.exit_code, 0) << name << said.output;
        if (walk.from == std::string("out")) {  // before any work
            EXPECT_EQ(said.exit_code, 73) << name << said.output;
            EXPECT_THAT(said.output, testing::Not(testing::HasSubstr("ground truth"))) << name;
            return;
        }
        const bool is_link = trap == Trap::link_to_file || trap == Trap::absolute_link;
        const std::string file = fs::path(place).filename().string();
        if (place.ends_with(".octoskin-ready")) {  // left half moved, whatever it is
            EXPECT_THAT(said.error.message(), testing::HasSubstr("octoskin")) << name << said.output;
        } else if (walk.command == std::string(kEvaluateMap) && place == "meta.yaml") {
            // A warning; the error is that the map has no recording then.
            EXPECT_THAT(said.output, testing::HasSubstr(file + (is_link ? ": is a symbolic link" : ": is ")))
                << name;
        } else {
            EXPECT_THAT(said.error.message(), testing::HasSubstr(file)) << name << said.output;
            // Following these would go well.
            if (is_link) {
                EXPECT_THAT(said.error, testing_support::code_is(ErrorCode::link)) << name << said.output;
            }
        }
    }

    /// What is octoskin's own is cleared away or passed over: no such trap hides another.
    void go_cleared(const Walk& walk, Trap trap) {
        const fs::path folder = make(walk);
        std::string name = walk.command + (": trap " + std::to_string(static_cast<int>(trap))) + " at";
        for (const std::string& place : walk.cleared) {
            name += " " + place;
            if (!lay(trap, folder / place, outside_ / walk.from / place, outside_ / walk.from)) {
                unlaid_.insert(trap);
                return;
            }
        }
        expect_harmless(walk, name);
    }

    /// What is in the folder itself says something of outside, in a text that a command reads.
    void go_text(const Walk& walk, const std::string& place, const std::string& text) {
        const fs::path folder = make(walk);
        write(folder / place, std::regex_replace(text, std::regex("@"), outside_.string()));
        const Failure said = expect_harmless(walk, walk.command + (": " + place + " says " + text));
        // By its name alone, in the recording itself, what meta.yaml names is found.
        if (place == "meta.yaml") return;
        EXPECT_NE(said.exit_code, 0) << walk.command << place << text;
    }

    /// A second name of each of the victim's files, all at once: none of them is refused, so none hides
    /// another.
    void go_hard_links(const Walk& walk, const std::vector<std::string>& places) {
        const fs::path folder = make(walk);
        for (const std::string& place : places) {
            const fs::path twin = outside_ / walk.from / place;
            if (!fs::is_regular_file(twin)) continue;
            fs::remove(folder / place);
            fs::create_hard_link(twin, folder / place);
        }
        expect_harmless(walk, std::string(walk.command) + ": hard links");
    }

    [[nodiscard]] const std::set<Trap>& unlaid() const noexcept { return unlaid_; }
    [[nodiscard]] std::size_t runs() const noexcept { return runs_; }

  private:
    [[nodiscard]] fs::path make(const Walk& walk) const {
        const fs::path folder = home_ / "it";
        for (const char* name : {"it", "it.own"}) fs::remove_all(home_ / name);
        fs::create_directory(home_ / "it.own");
        fs::copy(templates_ / walk.from, folder, fs::copy_options::recursive);
        return folder;
    }

    Failure expect_harmless(const Walk& walk, const std::string& name) {
        ++runs_;
        std::string command = walk.command;
        for (auto at = command.find("{}"); at != std::string::npos; at = command.find("{}"))
            command.replace(at, 2, (home_ / "it").string());
        Failure said = failure_in(run("timeout 60 " + typed_for_error(command) + " < /dev/null"));
        EXPECT_EQ(states_in(outside_, Bytes::trusted), before_) << name << said.output;
        EXPECT_NE(said.exit_code, 124) << name << " hangs";
        EXPECT_THAT(said.exit_code, testing::AnyOf(0, 1, 2, 64, 65, 66, 69, 73, 77, 78))
            << name << said.output;
        EXPECT_THAT(said.output, testing::Not(testing::HasSubstr("a-secret"))) << name;
        return said;
    }

    fs::path templates_;
    fs::path home_;
    fs::path outside_;
    std::map<std::string, std::string> before_;
    std::map<std::string, std::string> bytes_before_;  ///< compared at the end
    std::set<Trap> unlaid_;
    std::size_t runs_ = 0;
};

class FolderWalkOfAll : public ProgramTest {
  protected:
    /// A recording that is replayed in 0.1 s, with its maps, and the results of an experiment.
    void make_templates() const {
        fs::create_directories(directory_ / "templates");
        const std::string rec = path("templates/rec");
        const Said made = octoskin("simulate " + rec + " --rig " + source("tests/data/gantry/rig.yaml") +
                                   " --scenario " + source("tests/data/gantry/scenario.yaml"));
        ASSERT_EQ(made.exit_code, 0) << made.output;
        // So that its own scene is asked for, and not the shipped one.
        write(rec + "/meta.yaml",
              std::regex_replace(content(rec + "/meta.yaml"), std::regex("(world|scenario)_crc32: .*"),
                                 "$1_crc32: 0x00000001"));
        ASSERT_EQ(octoskin("replay " + rec).exit_code, 0);
        write(rec + "/mapping.yaml", "base: fast\n");
        write(rec + "/secret", "a-secret: 1\na-secret-too:\n");
        make_results();
    }

    /// Of an experiment, as far as it is looked at before it begins.
    void make_results() const {
        const fs::path out = directory_ / "templates/out";
        fs::create_directory(out);
        fs::copy(directory_ / "templates/rec", out / "recording", fs::copy_options::recursive);
        fs::remove(out / "recording/mapping.yaml");
        for (const auto& entry : fs::directory_iterator(out / "recording/maps"))
            fs::copy_file(entry.path(), out / entry.path().filename());
        for (const char* name : {"metrics.json", "report.html"}) write(out / name, "a-secret");
        const auto folder = OpenFolder::open(out, FolderAccess::write).value();
        for (const char* name : {"recording", "maps.yaml", "metrics.json", "report.html"})
            ASSERT_TRUE(note_result(folder, name));
    }

    void walk_all(const std::vector<std::function<void(Walker&)>>& steps) {
        std::atomic<std::size_t> next{0};
        std::vector<std::jthread> threads;  // joined before what they use ends
        for (const char* half : {"a", "b"}) {
            threads.emplace_back([&, half] {
                Walker walker(directory_ / "templates", directory_ / half);
                for (std::size_t i = next++; i < steps.size() && !HasFatalFailure(); i = next++)
                    steps[i](walker);
                const std::lock_guard lock(mutex_);
                runs_ += walker.runs();
                unlaid_.insert(walker.unlaid().begin(), walker.unlaid().end());
            });
        }
    }

    std::mutex mutex_;
    std::size_t runs_ = 0;
    std::set<Trap> unlaid_;
};

TEST_F(FolderWalkOfAll, nothing_outside_is_changed_shown_or_waited_for) {
    make_templates();
    if (HasFatalFailure()) return;
    const std::vector<Walk> walks = all_walks();
    std::vector<std::function<void(Walker&)>> steps;
    for (const Walk& walk : walks) {
        for (const Trap trap : kTraps) {
            for (const std::string& place : walk.refused)
                steps.emplace_back([&walk, place, trap](Walker& walker) { walker.go(walk, place, trap); });
            if (!walk.cleared.empty())
                steps.emplace_back([&walk, trap](Walker& walker) { walker.go_cleared(walk, trap); });
        }
        // A daemon does not end by itself, and reads the same as the others.
        if (std::string_view(walk.command).starts_with("run ")) continue;
        steps.emplace_back(
            [&walk](Walker& walker) { walker.go_hard_links(walk, joined(walk.refused, walk.cleared)); });
    }
    for (const auto& [command, place, text] : kTexts) {
        for (const Walk& walk : walks) {
            if (walk.command != std::string_view(command)) continue;
            steps.emplace_back(
                [&walk, place = place, text = text](Walker& walker) { walker.go_text(walk, place, text); });
        }
    }
    walk_all(steps);
    RecordProperty("runs", static_cast<int>(runs_));
    std::printf("%zu runs\n", runs_);
    EXPECT_GT(runs_, 600U);
    for (const Trap trap : unlaid_) EXPECT_EQ(trap, Trap::device) << "root alone makes devices";
}

}  // namespace
}  // namespace octoskin
