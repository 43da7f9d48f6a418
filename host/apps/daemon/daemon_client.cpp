#include "host/apps/daemon/daemon_client.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "common/time.hpp"
#include "host/apps/command_line/json_at.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/query/query_answer.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSignOfLife = R"({"ok":true})";

/// Whether there is something to read before `end`.
bool is_readable(int descriptor, HostTime end) {
    while (true) {  // again after a signal
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - monotonic_now());
        if (left.count() <= 0) return false;
        pollfd answer{descriptor, POLLIN, 0};
        const int ready = ::poll(&answer, 1, static_cast<int>(left.count()));
        if (ready >= 0 || errno != EINTR) return ready > 0;
    }
}

/// Sends a line and its line feed, and returns the line of the answer.
Result<std::string, Error> exchange_lines(int descriptor, const std::string& line, HostTime end) {
    // A new connection has room for a request.
    const ssize_t sent = ::send(descriptor, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EPIPE)
        return unexpected(
            Error{ErrorCode::system_error,
                  std::string("the daemon does not accept the request: ") + std::strerror(errno)});
    constexpr std::size_t kAnswerMax = std::size_t{64} << 20U;
    std::string answer;
    while (!answer.ends_with('\n')) {  // bounded by `end`
        if (answer.size() > kAnswerMax)
            return unexpected(
                Error{.code = ErrorCode::foreign_format,
                      .what = "the answer has no end",
                      .remedy = "another program may listen there; --socket names the daemon's"});
        if (!is_readable(descriptor, end))
            return unexpected(Error{ErrorCode::no_answer, "the daemon did not answer in time"});
        std::array<char, 4096> bytes{};
        const ssize_t count = ::recv(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT);
        if (count == 0 || (count < 0 && errno == ECONNRESET)) {
            return unexpected(Error{
                ErrorCode::no_answer,
                answer.empty() ? "the daemon closed the connection without an answer (has it just ended?)"
                               : "the daemon closed the connection in mid-answer (has it just ended?)"});
        }
        if (count < 0 && errno != EAGAIN && errno != EINTR)
            return unexpected(Error{ErrorCode::system_error,
                                    std::string("cannot read the daemon's answer: ") + std::strerror(errno)});
        if (count > 0) answer.append(bytes.data(), static_cast<std::size_t>(count));
    }
    answer.pop_back();
    return answer;
}

bool is_node(const Json& node) {
    return at(node, "id").is_number_integer() && at(node, "name").is_string() &&
           at(node, "verdict").is_string();
}

bool is_joints_socket(const Json& joints) {
    return joints.is_null() || (at(joints, "above_rate").is_boolean() && at(joints, "rate_hz").is_number());
}

bool is_problem(const Json& problem) {
    return at(problem, "code").is_string() && at(problem, "text").is_string();
}

bool is_status(const Json& status) {
    const Json& can = at(status, "can");
    const Json& nodes = at(status, "nodes");
    const Json& problems = at(status, "problems");
    return at(status, "octoskin").is_string() && at(status, "rig").is_string() &&
           at(status, "uptime_s").is_number() && at(can, "interface").is_string() &&
           at(can, "state").is_string() && nodes.is_array() && std::ranges::all_of(nodes, is_node) &&
           at(at(status, "map"), "known_voxels").is_number_unsigned() &&
           is_joints_socket(at(status, "joints_socket")) && problems.is_array() &&
           std::ranges::all_of(problems, is_problem);
}

}  // namespace

bool is_nested_too_deep(std::string_view json) {
    constexpr int kLevelsMax = 64;
    int level = 0;
    bool is_text = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (is_text && c == '\\') ++i;  // an escaped quote ends no text
        if (c == '"') is_text = !is_text;
        if (is_text) continue;
        if (c == '[' || c == '{') ++level;
        if (c == ']' || c == '}') --level;
        if (level > kLevelsMax) return true;
    }
    return false;
}

Result<std::string, AppError> ask_daemon(const std::filesystem::path& socket, const std::string& request,
                                         std::chrono::milliseconds patience) {
    const HostTime begun = monotonic_now();
    const auto descriptor = connect_unix_socket(socket, SOCK_STREAM, std::min(patience, kLetInMax));
    if (!descriptor) return unexpected(descriptor.error());
    auto answer = patience > kLetInMax ? exchange_lines(*descriptor, "hello\n", begun + kLetInMax)
                                       : Result<std::string, Error>(kSignOfLife);
    if (answer && *answer == kSignOfLife)
        answer = exchange_lines(*descriptor, request + '\n', begun + patience);
    ::close(*descriptor);
    if (!answer) return fail(ExitCode::io_failed, in_file(answer.error(), socket));
    if (is_nested_too_deep(*answer)) return unexpected(foreign_answer(socket));
    return std::move(answer).value();
}

Result<Json, AppError> ask_status(const std::filesystem::path& socket) {
    const auto answer = ask_daemon(socket, "status");
    if (!answer) return unexpected(answer.error());
    Json status = Json::parse(*answer, nullptr, false);
    if (const auto refused = refusal_of(status)) return unexpected(*refused);
    if (!is_status(status)) return unexpected(foreign_answer(socket));
    return status;
}

AppError foreign_answer(const std::filesystem::path& socket) {
    return {ExitCode::bad_data,
            {.code = ErrorCode::foreign_format,
             .what = "not the answer of a daemon of this version",
             .remedy = "restart the daemon if its version differs; --socket names another place",
             .file = socket}};
}

}  // namespace octoskin
