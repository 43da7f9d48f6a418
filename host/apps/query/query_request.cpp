#include "host/apps/query/query_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <type_traits>

#include "common/cut_text.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kWord = "query";
constexpr const char* kExpectedLine = "expected: query {\"path\": [[JOINTS], ...], ...}";
constexpr std::string_view kKeys =
    "path, padding_m, reach_m, step, links_ignored, asks_unmoved_links, own_space_m, pockets, and with "
    "pockets "
    "radius_m, z_min_m, pocket_min_m3, pockets_max, views_tried";
constexpr double kPaddingMax_m = 1.0;

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

/// Moves the value of `key` out of `json`; throws std::invalid_argument with the key.
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
        throw std::invalid_argument(fmt::format("query: {} is {}{}; expected {}", key, shown(*found),
                                                found->is_array() && is_list<T> ? " of another kind" : "",
                                                kExpected<T>));
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
    return fail(
        ExitCode::usage,
        fmt::format(
            "query: invalid JSON from byte {} ({}); {}, with finite numbers: JSON has no NaN and no Infinity",
            at, at < text.size() ? shown(text.substr(at, kShown)) : "its end", kExpectedLine));
}

/// Refuses keys that the request would not use: their sender expects another answer.
void refuse_unasked(const Json& json, bool asks_pockets) {
    const auto refuse = [&json](std::initializer_list<const char*> keys, const char* why) {
        for (const char* key : keys)
            if (json.contains(key))
                throw std::invalid_argument(fmt::format("query: {} has no effect {}", key, why));
    };
    if (asks_pockets) {
        refuse({"reach_m"}, "in a query about pockets, for which no distances are computed: leave it out");
    } else {
        refuse({"radius_m", "z_min_m", "pocket_min_m3", "pockets_max", "views_tried"},
               "without \"pockets\": true: give that, too, or leave it out");
    }
}

/// nlohmann::json would silently use the last of several values of one key.
Json parse_once(std::string_view text) {
    std::set<std::string> keys;
    return Json::parse(text, [&keys](int depth, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::key && depth == 1 && !keys.insert(parsed.get<std::string>()).second)
            throw std::invalid_argument(fmt::format("query: the key {} comes twice", shown(parsed)));
        return true;
    });
}

/// The serializer writes null for a number that is not finite; in a long path the message gives the place.
void check_path(const Json& path) {
    const auto expected = kExpected<std::vector<std::vector<double>>>;
    if (!path.is_array()) return;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Json& configuration = path[i];
        if (!configuration.is_array())
            throw std::invalid_argument(fmt::format("query: configuration {} of path is {}; expected {}",
                                                    i + 1, shown(configuration), expected));
        for (std::size_t joint = 0; joint < configuration.size(); ++joint) {
            if (configuration[joint].is_number()) continue;
            throw std::invalid_argument(
                fmt::format("query: number {} of configuration {} of path is {}; expected {}", joint + 1,
                            i + 1, shown(configuration[joint]), expected));
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
        throw std::invalid_argument("query: path is empty; leave it out to query the arm's present posture");
    take(json, "padding_m", request.padding_m);
    take(json, "reach_m", request.reach_m);
    take(json, "step", request.step);
    take(json, "links_ignored", request.links_ignored);
    take(json, "asks_unmoved_links", request.asks_unmoved_links);
    take(json, "own_space_m", request.own_space_m);
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
        return fail(
            ExitCode::usage,
            fmt::format(
                "query expects an object: query {{}} is about the arm's present posture; it may contain {}",
                kKeys));
    try {
        Json json = parse_once(text);
        if (!json.is_object()) return fail(ExitCode::usage, kExpectedLine);
        QueryRequest request = from_json(json);
        if (!json.empty())
            return fail(ExitCode::usage, fmt::format("query: unknown key {}; the keys are {}",
                                                     shown(Json(json.begin().key())), kKeys));
        if (const std::string fault = fault_of(request); !fault.empty()) return fail(ExitCode::usage, fault);
        return request;
    } catch (const Json::parse_error& error) {
        return fail_at(text, error.byte);
    } catch (const Json::exception&) {
        return fail(ExitCode::usage, "query: a number is too large");
    } catch (const std::invalid_argument& wrong) {
        return fail(ExitCode::usage, wrong.what());
    }
}

std::string fault_of(const QueryRequest& request) {
    if (request.path.size() > kConfigurationsMax)
        return fmt::format("query: {} configurations; at most {} are possible in one query",
                           request.path.size(), kConfigurationsMax);
    if (request.kind == QueryKind::pockets && request.path.size() > 1)
        return fmt::format("query: path has {} configurations; views into pockets are searched from one",
                           request.path.size());
    const auto not_within = [](const char* key, double value, double min, double max) {
        return fmt::format("query: {} is {}; expected {} to {}", key, value, min, max);
    };
    if (!is_within(request.padding_m, 0.0, kPaddingMax_m))
        return not_within("padding_m", request.padding_m, 0.0, kPaddingMax_m);
    if (!is_within(request.reach_m, 0.0, kReachMax_m))
        return not_within("reach_m", request.reach_m, 0.0, kReachMax_m);
    if (!is_within(request.step, kStepMin, 10.0)) return not_within("step", request.step, kStepMin, 10.0);
    if (request.own_space_m && !is_within(*request.own_space_m, 0.0, kPaddingMax_m))
        return not_within("own_space_m", *request.own_space_m, 0.0, kPaddingMax_m);
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
    return {};
}

}  // namespace octoskin
