// `octoskin record` beside a daemon that answers as a test says.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/system/said.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using testing_support::ScratchFolder;

class RecordCommand : public testing::Test {
  protected:
    using Answer = std::function<Json(const std::string& request)>;

    explicit RecordCommand() {
        socket_ = ControlSocket::open(folder_ / "control", loop_, [this](const std::string& request) {
                      asked_.push_back(request);
                      return answer_(request).dump();
                  }).value();
    }
    /// Once in a test: a loop that was stopped is over. `answers`: whether the daemon lets anybody in.
    Said record(const std::string& arguments, bool answers = true) {
        Said ran;
        is_done_ = false;
        std::thread command([&] {
            ran = octoskin("record " + arguments + " --socket " + (folder_ / "control").string());
            is_done_ = true;
        });
        const auto watch = loop_.every(20ms, [&] {
            if (is_done_) loop_.stop(0);
        });
        if (answers) loop_.run();
        command.join();
        return ran;
    }
    [[nodiscard]] Json recording(int number, const std::string& name, const std::string& state) const {
        return {{"state", state},   {"folder", (folder_ / name).string()},
                {"error", ""},      {"seconds", 7.5},
                {"can_frames", 4},  {"depth_frames", 3},
                {"commits", 2},     {"lost_can", 0},
                {"lost_depth", 0},  {"lost_commits", 0},
                {"number", number}, {"is_complete", true},
                {"ended_early", ""}};
    }

    ScratchFolder folder_;
    EventLoop loop_;
    std::atomic<bool> is_done_ = false;
    std::vector<std::string> asked_;
    Answer answer_;
    std::unique_ptr<ControlSocket> socket_;
};

/// One that was started anew knows nothing of what the one before it recorded.
TEST_F(RecordCommand, says_so_when_the_daemon_knows_of_no_recording) {
    answer_ = [](const std::string&) -> Json { return {{"ok", true}, {"recording", nullptr}}; };
    const Said ran = record((folder_ / "out").string());
    EXPECT_EQ(ran.exit_code, 69) << ran.output;
    EXPECT_NE(ran.output.find("knows of no recording"), std::string::npos) << ran.output;
}

TEST_F(RecordCommand, follows_its_own_recording_alone) {
    answer_ = [this](const std::string& request) -> Json {
        if (request.starts_with("record start"))
            return {{"ok", true}, {"recording", recording(1, "own", "recording")}, {"before", nullptr}};
        return {{"ok", true},
                {"recording", recording(2, "others", "recording")},
                {"before", recording(1, "own", "ended")}};
    };
    const Said ran = record((folder_ / "own").string());
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    EXPECT_NE(ran.output.find((folder_ / "own").string() + ": 7.5 s, 4 CAN frames"), std::string::npos)
        << ran.output;
}

TEST_F(RecordCommand, says_why_its_recording_ended_before_it_was_to) {
    answer_ = [this](const std::string& request) -> Json {
        Json own = recording(1, "own", request.starts_with("record start") ? "recording" : "ended");
        own["ended_early"] = "the bus time went back";
        return {{"ok", true}, {"recording", own}};
    };
    const Said ran = record((folder_ / "own").string());
    EXPECT_EQ(ran.exit_code, 1) << ran.output;
    EXPECT_NE(ran.output.find((folder_ / "own").string() +
                              ": complete, but it ended before its time: the bus time went back"),
              std::string::npos)
        << ran.output;
}

TEST_F(RecordCommand, says_so_when_the_daemon_knows_only_of_others) {
    answer_ = [this](const std::string& request) -> Json {
        const bool is_start = request.starts_with("record start");
        return {{"ok", true},
                {"recording", recording(is_start ? 1 : 3, is_start ? "own" : "others", "recording")},
                {"before", is_start ? Json() : recording(2, "others too", "ended")}};
    };
    const Said ran = record((folder_ / "own").string());
    EXPECT_EQ(ran.exit_code, 69) << ran.output;
    EXPECT_NE(ran.output.find((folder_ / "own").string() + ": the daemon"), std::string::npos) << ran.output;
    EXPECT_NE(ran.output.find("no longer knows this one"), std::string::npos) << ran.output;
}

TEST_F(RecordCommand, tells_a_daemon_that_no_longer_answers_from_one_that_ended) {
    answer_ = [this](const std::string& request) -> Json {
        if (request.starts_with("record start")) loop_.stop(0);  // from now on it hangs
        return {{"ok", true}, {"recording", recording(1, "own", "recording")}};
    };
    const Said ran = record((folder_ / "own").string());
    EXPECT_EQ(ran.exit_code, 74) << ran.output;
    EXPECT_NE(ran.output.find((folder_ / "own").string() +
                              ": the daemon no longer answers, and may continue to record"),
              std::string::npos)
        << ran.output;
    EXPECT_NE(ran.output.find("octoskin record --stop " + (folder_ / "own").string()), std::string::npos);
}

TEST_F(RecordCommand, begins_nothing_once_it_has_given_up_waiting_for_the_begin) {
    answer_ = [](const std::string&) -> Json { return {{"ok", true}, {"recording", nullptr}}; };
    const Said ran = record((folder_ / "own").string(), false);
    EXPECT_EQ(ran.exit_code, 74) << ran.output;
    EXPECT_NE(ran.output.find("is not known: `octoskin record --stop " + (folder_ / "own").string()),
              std::string::npos)
        << ran.output;
    const auto turn = loop_.every(100ms, [&] { loop_.stop(0); });
    loop_.run();
    EXPECT_TRUE(asked_.empty()) << asked_.front();
}

TEST_F(RecordCommand, names_the_folder_whose_recording_it_ends) {
    answer_ = [this](const std::string& request) -> Json {
        const bool is_stop = request.starts_with("record stop");
        return {{"ok", true}, {"recording", recording(1, "own", is_stop ? "ended" : "recording")}};
    };
    EXPECT_EQ(record("--stop " + (folder_ / "own/").string()).exit_code, 0);
    EXPECT_EQ(asked_.back(), "record stop " + (folder_ / "own").string());
}

TEST_F(RecordCommand, refuses_a_folder_whose_name_would_be_two_lines) {
    const Said ran =
        octoskin("record \"$(printf '/tmp/a\\nrecord stop')\" --socket " + (folder_ / "control").string());
    EXPECT_EQ(ran.exit_code, 64) << ran.output;
    for (const char* const part : {"without control characters", "'/tmp/a\\x0arecord stop'"})
        EXPECT_NE(ran.output.find(part), std::string::npos) << part << "\n" << ran.output;
}

}  // namespace
}  // namespace octoskin::test
