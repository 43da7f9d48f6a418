#include "host/apps/query/query_answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "common/time.hpp"
#include "host/apps/command_line/error_json.hpp"
#include "host/apps/query/query_errors.hpp"
#include "host/apps/query/query_values.hpp"
#include "host/core/query/own_space.hpp"
#include "host/core/query/path_query.hpp"
#include "host/core/query/pocket_views.hpp"
#include "host/core/query/robot_query.hpp"
#include "host/core/query/unknown_pockets.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

/// More postures would block the client, and other clients, for minutes.
constexpr std::size_t kPosturesMax = 50'000;

std::string configuration_text(std::size_t index) {
    return fmt::format("configuration {}", index + 1);
}

/// Processor time of this thread: the load of other programs does not count against a query.
Nanoseconds thread_time() {
    timespec used{};
    (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);  // available since Linux 2.6.12
    return Nanoseconds{std::int64_t{used.tv_sec} * 1'000'000'000 + used.tv_nsec};
}

/// Evaluates one request.
class Asking {
  public:
    Asking(const QueryRequest& request, QueryGround ground, const std::function<bool()>& is_ending)
        : request_(request), ground_(std::move(ground)), is_cancelled_(is_ending) {}

    Result<Json, AppError> run() {
        auto robot = RobotQuery::build(*ground_.rig, *ground_.robot,
                                       {.padding_m = request_.padding_m,
                                        .links_ignored = request_.links_ignored,
                                        .ignores_unmoved = !request_.asks_unmoved_links});
        if (!robot) return fail(ExitCode::usage, error_of(robot.error(), request_.padding_m));
        robot_.emplace(std::move(robot).value());
        if (request_.path.empty() && !ground_.present.empty()) request_.path = {ground_.present};
        if (request_.own_space_m && ground_.is_live && ground_.present.empty())
            return fail(ExitCode::unavailable, {ErrorCode::no_data,
                                                "the arm's posture is unknown, so no space counts as its own",
                                                {},
                                                "make sure that joint states arrive"});
        if (request_.path.empty() && (request_.kind == QueryKind::postures || request_.own_space_m))
            return fail(
                ExitCode::unavailable,
                {ErrorCode::no_data,
                 "the arm's posture is unknown",
                 {},
                 ground_.is_live ? "give its joints, or make sure that joint states arrive"
                                 : "give the posture to ask about as --joints, or its present posture "
                                   "as --stands"});
        if (const auto checked = check_present(); !checked) return unexpected(checked.error());
        if (const auto checked = check_path(); !checked) return unexpected(checked.error());
        if (const auto freed = free_own_space(); !freed) return unexpected(freed.error());
        return request_.kind == QueryKind::postures ? ask_postures() : ask_pockets();
    }

    /// The number of the refused configuration of the request's path, from 1.
    [[nodiscard]] std::optional<std::size_t> refused() const noexcept { return refused_; }

  private:
    [[nodiscard]] bool is_over_time() const {
        return ground_.work_max && thread_time() - begun_ > *ground_.work_max;
    }

    /// The error of a query that ended before `what`: cancelled, or over the processor time of one query.
    [[nodiscard]] Unexpected<AppError> ended(std::string_view what) const {
        if (!is_over_time())
            return fail(ExitCode::unavailable,
                        {ErrorCode::cancelled, fmt::format("the query was cancelled before {}", what)});
        const char* const remedy =
            request_.kind == QueryKind::postures
                ? "query parts of the path, or give a larger step or a smaller reach_m or own_space_m"
                : "give fewer views_tried or pockets_max, or a smaller radius_m or "
                  "own_space_m";
        return fail(
            ExitCode::unavailable,
            {.code = ErrorCode::time_limit,
             .what = fmt::format("one query may take {:.0f} s of processor time, which ended before {}",
                                 std::chrono::duration<double>(*ground_.work_max).count(), what),
             .remedy = remedy});
    }

    /// The present joints of a running daemon were checked before.
    Status<AppError> check_present() const {
        if (ground_.is_live || ground_.present.empty()) return Done{};
        const auto fault = robot_->fault_of(ground_.present);
        if (!fault) return Done{};
        return fail(ExitCode::usage,
                    error_of(*fault, *ground_.rig, *ground_.robot, ground_.present, "the present posture"));
    }

    /// Checks the path and makes its legs.
    Status<AppError> check_path() {
        double postures = 0.0;
        for (std::size_t i = 0; i < request_.path.size(); ++i) {
            const auto& position = request_.path[i];
            if (const auto fault = robot_->fault_of(position)) {
                refused_ = i + 1;
                return fail(ExitCode::usage,
                            error_of(*fault, *ground_.rig, *ground_.robot, position, configuration_text(i)));
            }
            // From the previous configuration; for the first one, from itself.
            const auto& before = request_.path[i > 0 ? i - 1 : 0];
            postures += static_cast<double>(
                legs_.emplace_back(*robot_, ground_.map, before, position, request_.step).postures());
            if (postures > static_cast<double>(kPosturesMax)) {
                return fail(ExitCode::usage, too_long(i + 1, postures));
            }
        }
        return Done{};
    }

    [[nodiscard]] Error too_long(std::size_t configurations, double postures) const {
        return {
            .code = ErrorCode::limit_exceeded,
            .what = fmt::format("expected at most {} postures in one query; between two postures no link "
                                "moves by more than half a voxel of {} m and no joint by more than a step "
                                "of {}",
                                kPosturesMax, ground_.map.resolution_m(), request_.step),
            .value = fmt::format("{:.0f} postures up to configuration {}", postures, configurations),
            .remedy = "query parts of the path (a larger step helps only where half a voxel is further)",
            .key = "path"};
    }

    /// Null if no distances are requested, or a search is faster.
    [[nodiscard]] const DistanceField* field_for_path() const {
        if (ground_.field == nullptr || !(request_.reach_m > 0.0) || robot_->capsule_count() == 0)
            return nullptr;
        AskedSpace asked;
        asked.reach_m = request_.reach_m;
        for (const Leg& leg : legs_) {
            for (std::size_t posture = 0; posture < leg.postures(); ++posture) {
                if (is_ending_()) return nullptr;
                const auto capsules = leg.pose(*robot_, posture);
                if (!capsules) return nullptr;  // the evaluation reports the error
                asked.include(*capsules);
            }
        }
        return ground_.field->of(ground_.map, asked);
    }

    /// Empty if the body or posture is invalid: the evaluation itself then refuses the query.
    [[nodiscard]] std::vector<PosedCapsule> own_capsules(std::span<const double> stands,
                                                         bool is_certain) const {
        const auto body = RobotQuery::build(*ground_.rig, *ground_.robot,
                                            {.ignores_unmoved = false, .is_of_certain_body = is_certain});
        const auto capsules = body ? body->pose(stands) : unexpected(PostureFault{});
        return capsules ? *capsules : std::vector<PosedCapsule>{};
    }

    /// At the arm's present posture, or at the beginning of the path.
    Status<AppError> free_own_space() {
        if (!request_.own_space_m) return Done{};
        const auto& stands = ground_.present.empty() ? request_.path.front() : ground_.present;
        // The whole arm, without the padding of the query.
        const auto around = own_capsules(stands, false);
        const auto certain = own_capsules(stands, true);
        if (octoskin::free_own_space(ground_.map, {around, certain}, *request_.own_space_m, is_ending_,
                                     demand()))
            return Done{};
        if (is_ending_()) return ended("the arm's own space was known");
        return fail(ExitCode::usage,
                    {.code = ErrorCode::limit_exceeded,
                     .what = fmt::format("expected at most {} million voxels of {} m around this arm",
                                         kOwnSpaceVoxelsMax >> 20U, ground_.map.resolution_m()),
                     .value = fmt::format("more within {} m", *request_.own_space_m),
                     .remedy = "give a smaller value, or query a map with larger voxels",
                     .key = "own_space_m"});
    }

    Result<Json, AppError> ask_postures() {
        Json legs = Json::array();
        PostureState worst = PostureState::free;
        std::size_t postures = 0;
        const LegConfig config{.reach_m = request_.reach_m,
                               .field = field_for_path(),
                               .demand = demand(),
                               .is_ending = is_ending_};
        for (std::size_t i = 0; i < legs_.size(); ++i) {
            const auto answer = ask(*robot_, ground_.map, legs_[i], config);
            if (is_ending_()) return ended("the path was evaluated");
            if (!answer) {
                return fail(ExitCode::usage, error_of(answer.error(), *ground_.rig, *ground_.robot,
                                                      request_.path[i], configuration_text(i)));
            }
            worst = std::max(worst, answer->worst.state);
            postures += answer->postures;
            legs.push_back(leg_json(*answer, ground_.map, *ground_.robot));
        }
        return Json{{"ok", true},
                    {"state", name(worst)},
                    {"postures", postures},
                    {"resolution_m", ground_.map.resolution_m()},
                    {"own_space_m", own_space_json()},
                    {"min_evidence", request_.min_evidence},
                    {"distances", request_.reach_m > 0.0 ? Json(config.field != nullptr ? "field" : "search")
                                                         : Json(nullptr)},
                    {"links", names_of(robot_->links())},
                    {"links_without_body", links_without_body()},
                    {"links_unknown", names_of(robot_->unknown_links())},
                    {"links_with_borrowed_body", links_with_borrowed_body()},
                    {"legs", std::move(legs)}};
    }

    [[nodiscard]] FreeDemand demand() const { return {request_.min_evidence, ground_.units}; }

    /// Null: no space was treated as the arm's own.
    [[nodiscard]] Json own_space_json() const {
        return request_.own_space_m ? Json(*request_.own_space_m) : Json(nullptr);
    }

    [[nodiscard]] Json names_of(std::span<const LinkId> links) const {
        Json names = Json::array();
        for (const LinkId link : links) names.push_back(ground_.robot->link_names()[link]);
        return names;
    }
    [[nodiscard]] Json links_with_borrowed_body() const {
        Json lenders = Json::object();
        for (const LinkWithBorrowedBody& link : ground_.rig->links_with_borrowed_body)
            lenders[link.link] = link.body_of;
        return lenders;
    }
    /// Includes those that the rig lists.
    [[nodiscard]] Json links_without_body() const {
        Json names = Json::array();
        for (const LinkWithoutBody& link : ground_.rig->links_without_body) names.push_back(link.link);
        return names;
    }

    Result<Json, AppError> ask_pockets() {
        const Eigen::Vector3d base = ground_.rig->T_map_base.translation();
        const PocketRegion region{base, request_.radius_m, request_.z_min_m.value_or(base.z())};
        const double voxel_m3 = std::pow(ground_.map.resolution_m(), 3);
        const auto voxels_min = static_cast<std::size_t>(std::ceil(request_.pocket_min_m3 / voxel_m3));
        if (region.z_min_m > base.z() + region.radius_m) {
            return fail(
                ExitCode::usage,
                {.code = ErrorCode::out_of_range,
                 .what = fmt::format("expected at most {:.3f} m: the region is {} m about the base, which is "
                                     "at {:.3f} m in the map",
                                     base.z() + region.radius_m, request_.radius_m, base.z()),
                 .value = fmt::format("{} m", region.z_min_m),
                 .remedy = "query from a lower height (z_min_m, --above)",
                 .key = "z_min_m"});
        }
        const auto found = UnknownPockets::find(ground_.map, region, voxels_min, is_ending_);
        if (is_ending_()) return ended("the pockets were found");
        if (!found) {
            return fail(ExitCode::usage,
                        {.code = ErrorCode::limit_exceeded,
                         .what = fmt::format("the region about the base has too many voxels of {} m, or "
                                             "extends beyond the octree",
                                             ground_.map.resolution_m()),
                         .value = fmt::format("{} m", request_.radius_m),
                         .remedy = "give a smaller radius",
                         .key = "radius_m"});
        }
        const PocketViewConfig config{
            .postures = request_.views_tried, .pockets = request_.pockets_max, .demand = demand()};
        std::vector<std::optional<PocketView>> views;
        const Json why_no_views = why_not_tried();
        if (why_no_views.is_null())
            views = find_views(*ground_.rig, *robot_, ground_.map, *found, request_.path.front(), config,
                               is_ending_);
        if (is_ending_()) return ended("the pockets were examined");
        Json pockets = Json::array();
        for (std::size_t i = 0; i < std::min(request_.pockets_max, found->pockets().size()); ++i)
            pockets.push_back(pocket_json(found->pockets()[i], i < views.size() ? views[i] : std::nullopt));
        if (is_ending_()) return ended("the ways to the views were evaluated");
        return Json{{"ok", true},
                    {"resolution_m", ground_.map.resolution_m()},
                    {"own_space_m", own_space_json()},
                    {"min_evidence", request_.min_evidence},
                    {"region_m3", rounded(static_cast<double>(found->region_voxels()) * voxel_m3)},
                    {"unknown_m3", rounded(static_cast<double>(found->unknown_voxels()) * voxel_m3)},
                    {"pockets_found", found->pockets().size()},
                    {"links", names_of(robot_->links())},
                    {"links_without_body", links_without_body()},
                    {"links_unknown", names_of(robot_->unknown_links())},
                    {"links_with_borrowed_body", links_with_borrowed_body()},
                    {"views_not_tried", why_no_views},
                    {"pockets", std::move(pockets)}};
    }

    /// Why no view into a pocket was searched; null if views were searched.
    [[nodiscard]] Json why_not_tried() const {
        if (request_.views_tried == 0) return "no posture was to be tried";
        if (request_.path.empty())
            return ground_.is_live ? "the arm's posture is unknown"
                                   : "the arm's posture is unknown: give it as --stands";
        if (std::ranges::all_of(ground_.rig->nodes,
                                [](const HostNode& node) { return node.sensors.empty(); }))
            return "the rig has no range sensor";
        return nullptr;
    }

    [[nodiscard]] Json pocket_json(const UnknownPocket& pocket, const std::optional<PocketView>& view) const {
        Json json = {{"volume_m3", rounded(pocket.volume_m3)},
                     {"voxels", pocket.voxels},
                     {"border_voxels", pocket.border_voxels},
                     {"centre_m", point_json(pocket.centre)},
                     {"border_m", point_json(ground_.map.centre_of(pocket.nearest_border))},
                     {"view", nullptr}};
        if (!view) return json;
        const Leg way(*robot_, ground_.map, request_.path.front(), view->position, request_.step);
        Json state = nullptr;  // a joint without limits may give a way without end
        Json free = nullptr;
        if (way.postures() <= kPosturesMax) {
            const auto answer =
                ask(*robot_, ground_.map, way,
                    {.reach_m = 0.0, .field = nullptr, .demand = demand(), .is_ending = is_ending_});
            if (answer) {
                state = name(answer->worst.state);
                free = free_json(answer->free, ground_.map, *ground_.robot);
            }
        }
        json["view"] = {{"joints", view->position},
                        {"state", name(view->state)},
                        {"sensor", view->sensor},
                        {"range_m", rounded(view->range_m)},
                        {"way", state},
                        {"free_evidence", free}};
        return json;
    }

    QueryRequest request_;
    QueryGround ground_;
    const std::function<bool()>& is_cancelled_;
    const Nanoseconds begun_ = thread_time();
    const std::function<bool()> is_ending_ = [this] { return is_cancelled_() || is_over_time(); };
    std::optional<RobotQuery> robot_;
    std::vector<Leg> legs_;  ///< one for each configuration of the path
    std::optional<std::size_t> refused_;
};

}  // namespace

Json query_refused(const AppError& error) {
    return {{"ok", false}, {"exit", static_cast<int>(error.exit)}, {"error", to_json(error.error)}};
}

std::optional<AppError> refusal_of(const Json& answer) {
    if (!answer.is_object() || answer.value("ok", Json()) != false || !answer.contains("error")) return {};
    const Json exit = answer.value("exit", Json());
    return AppError{exit.is_number_integer() ? static_cast<ExitCode>(exit.get<int>()) : ExitCode::unavailable,
                    error_of(answer.at("error"))};
}

Json answer_query(const QueryRequest& request, QueryGround ground, const std::function<bool()>& is_ending) {
    const auto begun = std::chrono::steady_clock::now();
    const Json map_time = seconds_json(ground.map_time);
    Asking asking(request, std::move(ground), is_ending);
    auto answer = asking.run();
    if (!answer) {
        Json refused = query_refused(answer.error());
        if (asking.refused()) refused["configuration"] = *asking.refused();
        return refused;
    }
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begun;
    (*answer)["map_time_s"] = map_time;
    (*answer)["took_us"] = std::round(took.count());
    return std::move(answer).value();
}

}  // namespace octoskin
