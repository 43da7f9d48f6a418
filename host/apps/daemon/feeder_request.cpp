#include "host/apps/daemon/feeder_request.hpp"

#include <sys/socket.h>

#include <cassert>
#include <nlohmann/json.hpp>
#include <string_view>

#include "host/apps/query/query_answer.hpp"
#include "host/core/rig/camera_text.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kRequest = "camera";

std::string text_of(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string greeting(const std::string& name, openni2::FrameSize size) {
    return text_of({{"ok", true}, {"camera", name}, {"width", size.width}, {"height", size.height}}) + '\n';
}

}  // namespace

std::optional<std::string> fed_camera_of(const std::string& line) {
    if (line == kRequest) return std::string();
    if (!line.starts_with(std::string(kRequest) + ' ')) return std::nullopt;
    return line.substr(kRequest.size() + 1);
}

bool take_feeder(CameraInputs& cameras, const std::string& line, int connection) {
    const auto name = fed_camera_of(line);
    if (!name || cameras.why_not_fed(*name)) return false;
    // First: the camera's thread may close the connection at any time.
    const std::string answer = greeting(*name, cameras.size_of(*name));
    (void)::send(connection, answer.data(), answer.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    const bool is_taken = cameras.take_feeder(*name, connection);
    assert(is_taken);  // only this thread gives it a feeder
    return is_taken;
}

std::string feeder_refusal(const CameraInputs& cameras, const std::string& name) {
    const auto why = cameras.why_not_fed(name);
    if (why) return text_of(query_refused(*why));
    return text_of(query_refused({ExitCode::unavailable,
                                  {.code = ErrorCode::in_use,
                                   .what = camera_text(name) + " was fed until now",
                                   .remedy = "try again"}}));
}

}  // namespace octoskin
