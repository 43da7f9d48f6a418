#include "host/apps/query/query_errors.hpp"

#include <fmt/format.h>

#include <vector>

namespace octoskin {
namespace {

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

}  // namespace

Error error_of(const RobotQueryFault& fault, double padding_m) {
    switch (fault.error) {
        case RobotQueryError::unknown_link:
            return {.code = ErrorCode::unknown_name,
                    .what = "expected a link of the robot",
                    .value = "'" + fault.element + "'",
                    .key = "links_ignored"};
        case RobotQueryError::bad_padding:
            return {.code = ErrorCode::out_of_range,
                    .what = "expected 0 to 1 m",
                    .value = fmt::format("{}", padding_m),
                    .key = "padding_m"};
        case RobotQueryError::no_body:
            return {ErrorCode::no_content,
                    "the query is empty: no moving link that is not ignored has a <collision>"};
    }
    return {};
}

Error error_of(const PostureFault& fault, const HostRig& rig, const RobotModel& robot,
               std::span<const double> position, const std::string& of) {
    const auto of_joint = [&](ErrorCode code, const std::string& expected) {
        return Error{.code = code,
                     .what = expected,
                     .value = fmt::format("{:.6g}", position[fault.joint]),
                     .key = of + ": " + rig.joint_names().at(fault.joint)};
    };
    Error error;
    switch (fault.error) {
        case PostureError::wrong_count:
            return {.code = ErrorCode::mismatch,
                    .what = fmt::format("expected the positions of {} joints: {}", robot.joint_count(),
                                        listed(rig.joint_names())),
                    .value = fmt::format("{} positions", position.size()),
                    .key = of};
        case PostureError::not_finite:
            return of_joint(ErrorCode::bad_value, "expected a finite number");
        case PostureError::outside_limits:
            return of_joint(ErrorCode::out_of_range,
                            fmt::format("expected a value within the joint's limits, {:.6g} to {:.6g}",
                                        robot.limits()[fault.joint].min, robot.limits()[fault.joint].max));
        case PostureError::ambiguous_turn:
            error =
                of_joint(ErrorCode::out_of_range,
                         "expected at most half a turn of a continuous joint, because the way of a longer "
                         "one is not known");
            error.remedy = "give a posture on the way";
            return error;
        case PostureError::too_far:
            return {.code = ErrorCode::out_of_range,
                    .what = "the robot would be further than 1000 km from the map's origin",
                    .key = of};
    }
    return error;
}

}  // namespace octoskin
