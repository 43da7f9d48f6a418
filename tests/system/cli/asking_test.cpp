// The commands that ask a daemon, before one that answers what a test wants.
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>
#include <vector>

#include "host/apps/daemon/control_socket.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::code_is;
using testing_support::remedy_is;
using testing_support::what_is;

class AskingTest : public ProgramTest {
  protected:
    /// What `commands` say, each through `call`, while a daemon gives this answer to everything.
    std::vector<Said> ask(const std::string& answer, const std::vector<std::string>& commands,
                          const std::function<Said(const std::string&)>& call) const {
        EventLoop loop;
        const auto socket =
            ControlSocket::open(path("control"), loop, [&](const std::string&) { return answer; });
        EXPECT_TRUE(socket) << socket.error().message();
        std::vector<Said> said;
        std::atomic<bool> is_done = false;
        std::thread asking([&] {
            for (const std::string& command : commands)
                said.push_back(call(command + " --socket " + path("control")));
            is_done = true;
        });
        const auto watch = loop.every(std::chrono::milliseconds(20), [&] {
            if (is_done) loop.stop(0);
        });
        loop.run();
        asking.join();
        return said;
    }
    /// The failures of `commands`.
    [[nodiscard]] std::vector<Failure> fail(const std::string& answer,
                                            const std::vector<std::string>& commands) const {
        std::vector<Failure> failures;
        for (const Said& each : ask(answer, commands, [](const std::string& arguments) {
                 return run(typed_for_error(arguments));
             }))
            failures.push_back(failure_in(each));
        EXPECT_EQ(failures.size(), commands.size());
        return failures;
    }
    /// That each of `commands` refuses the answer as that of a foreign program.
    void expect_foreign(const std::string& answer, const std::vector<std::string>& commands) const {
        for (const Failure& failure : fail(answer, commands))
            EXPECT_THAT(failure, fails_with(65, code_is(ErrorCode::foreign_format), path_is(path("control")),
                                            remedy_is(HasSubstr("--socket"))));
    }
};

/// The answer is more than a buffer of standard output holds, so that writing fails in mid-work.
TEST_F(AskingTest, a_reader_that_goes_away_is_no_failure) {
    const std::string answer =
        R"({"octoskin": ")" + std::string(200'000, 'x') +
        R"(", "rig": "a", "can": {"interface": "can0", "state": "up"}, "uptime_s": 1,)"
        R"("nodes": [], "cameras": [], "map": {"known_voxels": 1}, "problems": [{"code": "a", "text": "b"}]})";
    const auto said =
        ask(answer, {"status", "status --json", "monitor --once"}, [](const std::string& arguments) {
            return run("( ( sleep 0.3; " + typed(arguments) + "; echo code $? >&2 ) | true )");
        });
    ASSERT_EQ(said.size(), 3U);
    for (const Said& each : said) EXPECT_EQ(each.output, "code 0\n");
}

TEST_F(AskingTest, an_answer_of_something_else_is_told) {
    expect_foreign(R"({"ok": true, "recording": {}})", {"status", "record " + path("out"), "record --stop"});
}

TEST_F(AskingTest, an_answer_without_what_this_version_gives_is_refused_in_every_form) {
    const char* const with_sentences =
        R"({"octoskin": "octoskin 9.0", "rig": "a", "uptime_s": 1, "nodes": [], "map": {"known_voxels": 1},)"
        R"( "can": {"interface": "can0", "state": "up"}, "problems": ["a sentence"]})";
    for (const char* answer :
         {"{}", R"({"octoskin": "octoskin 9.0", "rig": "a", "uptime_s": 1, "nodes": [], "problems": []})",
          with_sentences})
        expect_foreign(answer, {"status", "status --json", "monitor --once"});
}

TEST_F(AskingTest, nothing_is_free_by_an_answer_without_a_posture) {
    for (const char* answer :
         {R"({"ok": true, "state": "free"})",
          R"({"ok": true, "state": "free", "legs": [], "links_unknown": [], "links_without_body": [],)"
          R"( "links_with_borrowed_body": {}})",
          R"({"ok": true, "pockets": []})"})
        expect_foreign(answer, {"query", "query --json"});
}

TEST_F(AskingTest, what_a_daemon_refuses_is_told_as_it_says) {
    const std::vector<std::string> commands{"status", "monitor --once", "record --stop", "query"};
    const std::string refused =
        R"({"ok": false, "exit": 69, "error": {"code": "limit_exceeded", "remedy": "ask again later", )"
        R"("message": "too many clients: ask again later"}})";
    for (const Failure& failure : fail(refused, commands))
        EXPECT_THAT(failure, fails_with(69, code_is(ErrorCode::limit_exceeded), what_is("too many clients"),
                                        remedy_is("ask again later")));
    for (const Said& each : ask(refused, commands, octoskin)) {
        EXPECT_EQ(each.exit_code, 69) << each.output;
        EXPECT_THAT(each.output, HasSubstr("too many clients: ask again later"));
    }
}

}  // namespace
}  // namespace octoskin
