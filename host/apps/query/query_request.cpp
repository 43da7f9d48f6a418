#include "host/apps/query/query_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>

#include "common/cut_text.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kWord = "query";
constexpr const char* kExpectedLine = "expected: query {\"path\": [[JOINTS], ...], ...}";
constexpr std::string_view kKeys =
    "path, padding_m, reach_m, step, links_ignored, asks_unmoved_links, own_space_m, min_evidence, pockets, "
    "and with pockets radius_m, z_min_m, pocket_min_m3, pockets_max, views_tried";
constexpr double kPaddingMax_m = 1.0;
constexpr std::size_t kKeyShown = 40;

bool is_within(double value, double min, double max) {
    return value >= min && value <= max;  // false for a NaN
}

template <class T>
constexpr bool is_list = false;
template <class T>
constexpr bool is_list<std::vector<T>> = true;

/// The description of the expected value.
template <class T>
constexpr const char* kExpected = nullptr;
template <>
constexpr const char* kExpected<bool> = "true or false";
template <>
constexpr const char* kExpected<double> = "a number";
template <>
constexpr const char* kExpected<std::size_t> = "a whole number, 0 or more";
template <>
constexpr const char* kExpected<std::vector<std::string>> = "a list of names, such as [\"gripper\"]";
template <>
constexpr const char* kExpected<std::vector<std::vector<double>>> =
    "a list of joint configurations, each a list of finite numbers, such as [[0, -0.785, 1.5]]";

/// A list or an object is only named: its depth is limited only by the input's size, and printing it would
/// recurse as deep.
std::string shown(const Json& json) {
    if (json.is_array()) return "a list";
    if (json.is_object()) return "an object";
    constexpr std::size_t kShown = 40;
    return cut_text(json.dump(-1, ' ', true, Json::error_handler_t::replace), kShown);
}

/// Moves the value of `key` out of `json`; throws Error with the key.
template <class T>
void take(Json& json, const char* key, T& value) {
    const auto found = json.find(key);
    if (found == json.end()) return;
    try {
        if constexpr (std::is_same_v<T, std::size_t>) {  // otherwise it would be truncated to a whole number
            value = found->template get_ref<const Json::number_unsigned_t&>();
        } else {
            value = found->template get<T>();
        }
    } catch (const Json::exception&) {
        const bool is_other_list = found->is_array() && is_list<T>;
        throw Error{.code = ErrorCode::wrong_type,
                    .what = std::string("expected ") + kExpected<T>,
                    .value = shown(*found) + (is_other_list ? " of another kind" : ""),
                    .key = key};
    }
    json.erase(found);
}
template <class T>
void take(Json& json, const char* key, std::optional<T>& value) {
    T one{};
    if (!json.contains(key)) return;
    take(json, key, one);
    value = one;
}

/// The reason and the place of a JSON syntax error.
Unexpected<AppError> fail_at(std::string_view text, std::size_t byte) {
    constexpr std::size_t kShown = 20;
    const std::size_t at = std::min(byte > 0 ? byte - 1 : 0, text.size());
    const std::string found = at < text.size() ? shown(text.substr(at, kShown)) : "the end";
    return fail(ExitCode::usage, {.code = ErrorCode::bad_syntax,
                                  .what = std::string("invalid JSON, ") + kExpectedLine,
                                  .value = fmt::format("{} at byte {}", found, at),
                                  .remedy = "write finite numbers: JSON has no NaN and no Infinity"});
}

/// Refuses keys that the request would not use: their sender expects another answer.
void refuse_unasked(const Json& json, bool asks_pockets) {
    const auto refuse = [&json](std::initializer_list<const char*> keys, const char* why,
                                const char* remedy) {
        for (const char* key : keys)
            if (json.contains(key))
                throw Error{.code = ErrorCode::conflict, .what = why, .remedy = remedy, .key = key};
    };
    if (asks_pockets) {
        refuse({"reach_m"}, "has no effect in a query about pockets, for which no distances are computed",
               "leave it out");
    } else {
        refuse({"radius_m", "z_min_m", "pocket_min_m3", "pockets_max", "views_tried"},
               "has no effect without \"pockets\": true", "give \"pockets\": true, too, or leave it out");
    }
}

/// nlohmann::json would silently use the last of several values of one key.
Json parse_once(std::string_view text) {
    std::set<std::string> keys;
    return Json::parse(text, [&keys](int depth, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::key && depth == 1 && !keys.insert(parsed.get<std::string>()).second)
            throw Error{.code = ErrorCode::duplicate,
                        .what = "occurs twice",
                        .key = cut_text(parsed.get<std::string>(), kKeyShown)};
        return true;
    });
}

/// The serializer writes null for a number that is not finite; in a long path the message gives the place.
void check_path(const Json& path) {
    if (!path.is_array()) return;
    const auto refuse = [](const std::string& key, const Json& value) {
        throw Error{.code = ErrorCode::wrong_type,
                    .what = std::string("expected ") + kExpected<std::vector<std::vector<double>>>,
                    .value = shown(value),
                    .key = key};
    };
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Json& configuration = path[i];
        if (!configuration.is_array()) refuse(fmt::format("path[{}]", i), configuration);
        for (std::size_t joint = 0; joint < configuration.size(); ++joint) {
            if (!configuration[joint].is_number())
                refuse(fmt::format("path[{}][{}]", i, joint), configuration[joint]);
        }
    }
}

QueryRequest from_json(Json& json) {
    QueryRequest request;
    bool asks_pockets = false;
    take(json, "pockets", asks_pockets);
    request.kind = asks_pockets ? QueryKind::pockets : QueryKind::postures;
    refuse_unasked(json, asks_pockets);
    const bool has_path = json.contains("path");
    if (has_path) check_path(json["path"]);
    take(json, "path", request.path);
    if (has_path && request.path.empty())
        throw Error{.code = ErrorCode::no_content,
                    .what = "is empty",
                    .remedy = "leave it out to query the arm's present posture",
                    .key = "path"};
    take(json, "padding_m", request.padding_m);
    take(json, "reach_m", request.reach_m);
    take(json, "step", request.step);
    take(json, "links_ignored", request.links_ignored);
    take(json, "asks_unmoved_links", request.asks_unmoved_links);
    take(json, "own_space_m", request.own_space_m);
    take(json, "min_evidence", request.min_evidence);
    take(json, "radius_m", request.radius_m);
    take(json, "z_min_m", request.z_min_m);
    take(json, "pocket_min_m3", request.pocket_min_m3);
    take(json, "pockets_max", request.pockets_max);
    take(json, "views_tried", request.views_tried);
    return request;
}

}  // namespace

bool is_query(std::string_view line) noexcept {
    return line == kWord || (line.starts_with(kWord) && line[kWord.size()] == ' ');
}

std::string to_line(const QueryRequest& request) {
    Json json = {{"padding_m", request.padding_m},
                 {"links_ignored", request.links_ignored},
                 {"asks_unmoved_links", request.asks_unmoved_links}};
    if (!request.path.empty()) json["path"] = request.path;
    if (request.own_space_m) json["own_space_m"] = *request.own_space_m;
    if (request.min_evidence > 0.0) json["min_evidence"] = request.min_evidence;
    json["step"] = request.step;
    if (request.kind == QueryKind::postures) {
        json["reach_m"] = request.reach_m;
    } else {
        json["pockets"] = true;
        json["radius_m"] = request.radius_m;
        if (request.z_min_m) json["z_min_m"] = *request.z_min_m;
        json["pocket_min_m3"] = request.pocket_min_m3;
        json["pockets_max"] = request.pockets_max;
        json["views_tried"] = request.views_tried;
    }
    return std::string(kWord) + " " + json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<QueryRequest, AppError> read_query(std::string_view line) {
    const std::string_view text = line.substr(std::min(kWord.size() + 1, line.size()));
    if (text.find_first_not_of(' ') == std::string_view::npos)
        return fail(ExitCode::usage,
                    {.code = ErrorCode::bad_syntax,
                     .what = "query expects an object",
                     .remedy = fmt::format("query {{}} is about the arm's present posture; it may contain {}",
                                           kKeys)});
    try {
        Json json = parse_once(text);
        if (!json.is_object())
            return fail(ExitCode::usage, {ErrorCode::wrong_type, kExpectedLine, shown(json)});
        QueryRequest request = from_json(json);
        if (!json.empty())
            return fail(ExitCode::usage, {.code = ErrorCode::unknown_key,
                                          .what = "unknown key of a query",
                                          .remedy = fmt::format("the keys are {}", kKeys),
                                          .key = cut_text(json.begin().key(), kKeyShown)});
        if (auto fault = fault_of(request)) return fail(ExitCode::usage, std::move(*fault));
        return request;
    } catch (const Json::parse_error& error) {
        return fail_at(text, error.byte);
    } catch (const Json::exception&) {
        return fail(ExitCode::usage, {ErrorCode::out_of_range, "a number is too large"});
    } catch (const Error& wrong) {
        return fail(ExitCode::usage, wrong);
    }
}

std::optional<Error> fault_of(const QueryRequest& request) {
    const std::string configurations = fmt::format("{} configurations", request.path.size());
    if (request.path.size() > kConfigurationsMax)
        return Error{.code = ErrorCode::limit_exceeded,
                     .what = fmt::format("expected at most {} in one query", kConfigurationsMax),
                     .value = configurations,
                     .remedy = "query parts of the path",
                     .key = "path"};
    if (request.kind == QueryKind::pockets && request.path.size() > 1)
        return Error{.code = ErrorCode::conflict,
                     .what = "expected one configuration, from which views into pockets are searched",
                     .value = configurations,
                     .key = "path"};
    const auto not_within = [](const char* key, double value, double min, double max) {
        return Error{.code = ErrorCode::out_of_range,
                     .what = fmt::format("expected {} to {}", min, max),
                     .value = fmt::format("{}", value),
                     .key = key};
    };
    if (!is_within(request.padding_m, 0.0, kPaddingMax_m))
        return not_within("padding_m", request.padding_m, 0.0, kPaddingMax_m);
    if (!is_within(request.reach_m, 0.0, kReachMax_m))
        return not_within("reach_m", request.reach_m, 0.0, kReachMax_m);
    if (!is_within(request.step, kStepMin, 10.0)) return not_within("step", request.step, kStepMin, 10.0);
    if (request.own_space_m && !is_within(*request.own_space_m, 0.0, kPaddingMax_m))
        return not_within("own_space_m", *request.own_space_m, 0.0, kPaddingMax_m);
    if (!is_within(request.min_evidence, 0.0, kMinEvidenceMax))
        return not_within("min_evidence", request.min_evidence, 0.0, kMinEvidenceMax);
    if (!is_within(request.radius_m, 0.05, kRadiusMax_m))
        return not_within("radius_m", request.radius_m, 0.05, kRadiusMax_m);
    if (request.z_min_m && !is_within(*request.z_min_m, -1e3, 1e3))
        return not_within("z_min_m", *request.z_min_m, -1e3, 1e3);
    if (!is_within(request.pocket_min_m3, 0.0, 1e3))
        return not_within("pocket_min_m3", request.pocket_min_m3, 0.0, 1e3);
    if (request.pockets_max > kConfigurationsMax)
        return not_within("pockets_max", static_cast<double>(request.pockets_max), 0.0,
                          static_cast<double>(kConfigurationsMax));
    if (request.views_tried > kViewsTriedMax)
        return not_within("views_tried", static_cast<double>(request.views_tried), 0.0,
                          static_cast<double>(kViewsTriedMax));
    return std::nullopt;
}

}  // namespace octoskin
