#include "tests/ros/headers.hpp"

#include <chrono>
#include <functional>

namespace octoskin::ros {
namespace {

/// Every object that is a header: the message's own and those within it.
void for_each_header(Json& json, const std::function<void(Json&)>& change) {
    for (auto& [name, member] : json.items()) {
        if (name == "header" && member.is_object()) {
            change(member);
        } else if (member.is_structured()) {
            for_each_header(member, change);
        }
    }
}

Json time_now() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now);
    return {{"sec", seconds.count()},
            {"nanosec", std::chrono::duration_cast<std::chrono::nanoseconds>(now - seconds).count()}};
}

}  // namespace

void Headers::change(Json& fields, const Codec& codec) const {
    if (!fields.contains("header") &&
        codec.decode(codec.encode(Json::object()), {}).fields.contains("header")) {
        fields["header"] = Json::object();
    }
    for_each_header(fields, [this](Json& header) {
        if (!frame_.empty()) {
            header["frame_id"] = frame_;
        }
        if (is_stamped_now_) {
            header["stamp"] = time_now();
        }
    });
}

}  // namespace octoskin::ros
