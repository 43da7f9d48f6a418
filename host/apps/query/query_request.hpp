// A query about a map: from `octoskin query`, on the daemon's control socket, and about a map file.
// query {"path": [[0, -0.785, 0, -2.356, 0, 1.571, 0.785]], "padding_m": 0.02}
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

enum class QueryKind : std::uint8_t { postures, pockets };

/// Metres; joints in rad, in metres for a prismatic joint.
struct QueryRequest {
    QueryKind kind = QueryKind::postures;
    /// The joint configurations of a path, each in the order of the rig's `joints`; empty: the arm's present
    /// posture.
    std::vector<std::vector<double>> path;
    double padding_m = 0.0;
    double reach_m = 0.5;  ///< limit up to which clearances are reported; 0: none are
    double step = 0.05;    ///< largest change of a joint between two postures of a path
    std::vector<std::string> links_ignored;
    bool asks_unmoved_links = false;
    /// Within the arm's present body, and where unknown within this distance of it, space counts as free;
    /// empty: it does not.
    std::optional<double> own_space_m;
    /// Free space with less evidence, in images and ranges, counts as unknown; 0: none does.
    double min_evidence = 0.0;

    double radius_m = 1.0;  ///< radius of the ball about the robot's base in which pockets are searched
    std::optional<double> z_min_m;  ///< and their minimum height in the map; empty: the base's height
    double pocket_min_m3 = 1e-4;
    std::size_t pockets_max = 10;
    std::size_t views_tried = 3000;  ///< number of postures; 0: no view is searched
};

inline constexpr std::size_t kConfigurationsMax = 1000;
inline constexpr double kReachMax_m = 5.0;
inline constexpr double kMinEvidenceMax = 1000.0;
inline constexpr double kStepMin = 5e-3;
inline constexpr std::size_t kViewsTriedMax = 20'000;
inline constexpr double kRadiusMax_m = 5.0;

/// The text form of a request, without a line feed.
[[nodiscard]] std::string to_line(const QueryRequest& request);
[[nodiscard]] bool is_query(std::string_view line) noexcept;
/// Parses the text form. Errors (`usage`) name the key that is unknown, of the wrong type or out of range.
[[nodiscard]] Result<QueryRequest, AppError> read_query(std::string_view line);
/// The error of a request that did not come from read_query(); empty if it is valid.
[[nodiscard]] std::optional<Error> fault_of(const QueryRequest& request);

}  // namespace octoskin
