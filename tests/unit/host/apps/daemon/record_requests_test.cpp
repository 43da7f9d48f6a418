// What anybody who may ask the daemon can ask of its recorder.
#include "host/apps/daemon/record_requests.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <functional>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <thread>

#include "host/core/text/printable.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::json;

std::string quoted(const std::string& folder) {
    return "'" + printable(folder) + "'";
}

class RecordRequestsTest : public testing::Test {
  protected:
    Json ask(const std::string& line) {
        EXPECT_TRUE(RecordRequests::is_one(line)) << line;
        return Json::parse(requests_.answer(line, settings_, pipeline_, HostTime{1'000'000'000}));
    }
    Json expect_refused(const std::string& line, ErrorCode code, const std::string& value = {}) {
        const Json answer = ask(line);
        EXPECT_FALSE(answer["ok"].get<bool>()) << line;
        EXPECT_EQ(answer["error"]["code"], std::string(name_of(code))) << line << answer;
        EXPECT_EQ(answer["error"].value("value", ""), value) << line << answer;
        EXPECT_TRUE(answer["recording"].is_null()) << line;
        return answer["error"];
    }

    testing_support::ScratchFolder folder_;
    Pipeline pipeline_ = test::make_pipeline(test::good_scene());
    RecordedSettings settings_{.rig = "name: a\n",
                               .robot = "<robot/>",
                               .mapping = "base: robust\n",
                               .rig_hash = 1,
                               .form = {.joints = {1}},
                               .cameras = {""},
                               .interface = "can0"};
    std::function<void()> before_copy_ = [] {};  ///< of a map
    RecordRequests requests_{[this](const FusedMap& map) {
        before_copy_();
        return map.copy();
    }};  ///< lets go of the pipeline before that goes
};

TEST_F(RecordRequestsTest, refuses_what_is_no_request_and_begins_nothing) {
    for (const char* const arguments : {"", " ", "x /tmp/a", "nan /tmp/a", "-1 /tmp/a", "1e7 /tmp/a",
                                        "inf /tmp/a", "1", "1/tmp/a", "1\t/tmp/a"}) {
        const Json error = expect_refused(std::string("record start ") + arguments, ErrorCode::bad_argument);
        EXPECT_EQ(error["message"], "expected: record start SECONDS FOLDER");
    }
    for (const char* const folder : {"", "a", "./a", "../a", "~/a", "\xff"})
        expect_refused(std::string("record start 0 ") + folder, ErrorCode::bad_value, quoted(folder));
    for (const char* const line :
         {"record ", "record start", "record stopped", "record  status", "record STOP"}) {
        const Json error = expect_refused(line, ErrorCode::bad_argument);
        EXPECT_NE(error.value("remedy", "").find("record stop [FOLDER], record status"), std::string::npos);
    }
    for (const char* const folder :
         {"/tmp/a\tb", "/tmp/\x1b[31mred", "/tmp/a\r", "/tmp/\u009b31m", "/tmp/\u202etxt", "/tmp/\xff"}) {
        for (const char* const request : {"record start 0 ", "record stop "})
            expect_refused(request + std::string(folder), ErrorCode::bad_name, quoted(folder));
    }
    expect_refused("record start 0 /tmp/\x1b[31mred", ErrorCode::bad_name, "'/tmp/\\x1b[31mred'");
    expect_refused("record stop", ErrorCode::no_data);
    expect_refused("record stop /tmp/a", ErrorCode::no_data);
    expect_refused("record stop here", ErrorCode::bad_value, "'here'");
    for (const char* const request : {"record start 0 /", "record stop /"})
        expect_refused(request + std::string(40'000, 'a'), ErrorCode::bad_name, "40001 bytes");
    EXPECT_EQ(ask("record status")["ok"], true);
}

TEST_F(RecordRequestsTest, refuses_to_begin_without_memory_or_thread_and_begins_when_there_is_some) {
    const std::string start = "record start 0 " + (folder_ / "recording").string();
    before_copy_ = [] { throw std::bad_alloc(); };
    expect_refused(start, ErrorCode::no_resources);
    EXPECT_NE(requests_.refusal().find("no memory"), std::string::npos);
    before_copy_ = [] { throw std::system_error(EAGAIN, std::generic_category()); };
    expect_refused(start, ErrorCode::no_resources);
    EXPECT_NE(requests_.refusal().find("no thread"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "recording"));
    before_copy_ = [] {};
    EXPECT_TRUE(ask(start)["ok"].get<bool>());
    EXPECT_EQ(requests_.refusal(), "");
}

TEST_F(RecordRequestsTest, refuses_a_folder_that_is_not_empty_and_leaves_no_trace) {
    EXPECT_TRUE(ask("record start 0 " + (folder_ / "whole").string())["ok"].get<bool>());
    EXPECT_TRUE(ask("record stop")["ok"].get<bool>());
    requests_.finish(std::chrono::seconds(20));
    const Json before = ask("record status");
    const Json refused = ask("record start 0 " + folder_.path().string());
    EXPECT_FALSE(refused["ok"].get<bool>());
    EXPECT_EQ(refused["exit"], 73);
    EXPECT_EQ(refused["error"]["code"], "already_exists") << refused;
    EXPECT_EQ(refused["error"]["file"], folder_.path().string()) << refused;
    EXPECT_EQ(ask("record status"), before);
    EXPECT_EQ(requests_.refusal(), "");
    EXPECT_TRUE(ask("record start 0 " + (folder_ / "next").string())["ok"].get<bool>());
    EXPECT_EQ(ask("record status")["recording"]["number"], 2);
}

/// Or one client's recording would keep the daemon from saving its map, or from beginning again.
TEST_F(RecordRequestsTest, refuses_a_name_that_the_daemon_uses_itself) {
    for (const char* name :
         {".fused.ot.octoskin-part", ".x", "fused.ot", "fused.bt", "fused.snapshot", "lock", "control",
          "joints", "control.lock", "fused.ot/", "x/../fused.ot", "fused.ot/."}) {
        const Json refused = ask("record start 0 " + (folder_.path() / name).string());
        EXPECT_FALSE(refused["ok"].get<bool>()) << name;
        EXPECT_EQ(refused["exit"], 64) << name;
        EXPECT_EQ(refused["error"]["code"], "bad_name") << name;
        EXPECT_FALSE(std::filesystem::exists(folder_.path() / name)) << name;
    }
    EXPECT_TRUE(ask("record start 0 " + (folder_ / "fused").string())["ok"].get<bool>());
}

TEST_F(RecordRequestsTest, ends_as_failed_without_memory_for_the_last_map) {
    EXPECT_TRUE(ask("record start 0 " + (folder_ / "recording").string())["ok"].get<bool>());
    before_copy_ = [] { throw std::bad_alloc(); };
    EXPECT_TRUE(ask("record stop")["ok"].get<bool>());
    requests_.finish(std::chrono::seconds(20));
    const Json recording = ask("record status")["recording"];
    EXPECT_EQ(recording["state"], "failed");
    EXPECT_NE(recording["error"].get<std::string>().find("no memory for a copy of the map"),
              std::string::npos)
        << recording;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "recording" / "meta.yaml")) << "nothing vouches for it";
}

TEST_F(RecordRequestsTest, logs_at_the_daemons_end_how_a_recording_ended_that_was_fast) {
    EXPECT_TRUE(ask("record start 0 " + (folder_ / "recording").string())["ok"].get<bool>());
    std::ostringstream lines;
    const auto before = spdlog::default_logger();
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::ostream_sink_mt>(lines)));
    requests_.stop(HostTime{2'000'000'000}, "the daemon ended");
    while (!requests_.recorder()->has_ended()) std::this_thread::yield();
    requests_.finish(std::chrono::seconds(20));
    spdlog::set_default_logger(before);
    EXPECT_NE(lines.str().find("the daemon ended"), std::string::npos) << lines.str();
}

TEST_F(RecordRequestsTest, ends_whole_and_says_why_when_the_buss_time_leaps) {
    EXPECT_TRUE(ask("record start 60 " + (folder_ / "recording").string())["ok"].get<bool>());
    EXPECT_EQ(ask("record status")["recording"]["ended_early"], "");
    pipeline_.builder().clear_motion({});
    requests_.finish(std::chrono::seconds(20));
    const Json recording = ask("record status")["recording"];
    EXPECT_EQ(recording["state"], "ended");
    EXPECT_EQ(recording["is_complete"], true);
    EXPECT_NE(recording["ended_early"].get<std::string>().find("the bus time jumped"), std::string::npos)
        << recording;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "recording" / "meta.yaml"));
}

TEST_F(RecordRequestsTest, makes_no_folder_above_its_own) {
    const Json error =
        expect_refused("record start 0 " + (folder_ / "no disk/recording").string(), ErrorCode::not_found);
    EXPECT_EQ(error["file"], (folder_ / "no disk").string());
    EXPECT_FALSE(std::filesystem::exists(folder_ / "no disk"));
}

TEST_F(RecordRequestsTest, ends_no_recording_but_the_one_that_is_named) {
    const std::string folder = (folder_ / "one").string();
    EXPECT_TRUE(ask("record start 0 " + folder + "/")["ok"].get<bool>());
    const Json others = ask("record stop " + (folder_ / "another").string());
    EXPECT_FALSE(others["ok"].get<bool>());
    EXPECT_EQ(others["exit"], 69);
    EXPECT_EQ(others["error"]["code"], "no_data");
    EXPECT_EQ(others["error"]["file"], (folder_ / "another").string());
    EXPECT_EQ(others["recording"]["folder"], folder);
    EXPECT_EQ(others["recording"]["state"], "recording");
    const Json own = ask("record stop " + folder_.path().string() + "/./one/");
    EXPECT_TRUE(own["ok"].get<bool>()) << own;
    EXPECT_NE(own["recording"]["state"], "recording");
}

TEST_F(RecordRequestsTest, tells_one_recording_from_the_next_and_how_the_one_before_ended) {
    const Json first = ask("record start 0 " + (folder_ / "first").string());
    EXPECT_EQ(first["recording"]["number"], 1);
    EXPECT_TRUE(first["before"].is_null());
    EXPECT_TRUE(ask("record stop")["ok"].get<bool>());
    requests_.finish(std::chrono::seconds(20));
    const Json second = ask("record start 0 " + (folder_ / "second").string());
    EXPECT_EQ(second["recording"]["number"], 2);
    EXPECT_EQ(second["before"]["number"], 1);
    EXPECT_EQ(second["before"]["folder"], (folder_ / "first").string());
    EXPECT_EQ(second["before"]["state"], "ended");
}

// What the daemon still has of the arm's way goes into order.log, and no more comes while this is recorded.
TEST_F(RecordRequestsTest, counts_what_went_into_the_map_since_it_began) {
    for (const StampedFrame& entry : test::good_scene().bus.frames())
        pipeline_.on_can(entry.frame, entry.stamp);
    EXPECT_TRUE(ask("record start 0 " + (folder_ / "late").string())["ok"].get<bool>());
    EXPECT_TRUE(ask("record stop")["ok"].get<bool>());
    requests_.finish(std::chrono::seconds(20));
    const std::string order = testing_support::ScratchFolder::read(folder_ / "late" / "order.log");
    EXPECT_NE(order.find("\nJ "), std::string::npos) << "there were no samples to be told from";
    EXPECT_EQ(ask("record status")["recording"]["commits"], 0);
}

TEST_F(RecordRequestsTest, records_to_one_folder_at_a_time) {
    const std::string first = (folder_ / "first one").string();
    EXPECT_EQ(ask("record start 0 " + first)["recording"]["folder"], first) << "a folder may have blanks";
    const Json second = ask("record start 0 " + (folder_ / "second").string());
    EXPECT_FALSE(second["ok"].get<bool>());
    EXPECT_EQ(second["exit"], 73);
    EXPECT_EQ(second["error"]["code"], "in_use") << second;
    EXPECT_EQ(second["error"]["file"], first) << second;
    EXPECT_NE(second["error"].value("remedy", "").find("octoskin record --stop"), std::string::npos)
        << second;
    EXPECT_TRUE(ask("record stop")["ok"].get<bool>());
    requests_.finish(std::chrono::seconds(20));
    EXPECT_EQ(ask("record status")["recording"]["state"], "ended");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "first one" / "meta.yaml"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "second"));
}

}  // namespace
}  // namespace octoskin
