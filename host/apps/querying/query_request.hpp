// What is asked of a map: by `octoskin query`, on the daemon's control socket, and of a map file.
//
//     query {"path": [[0, -0.785, 0, -2.356, 0, 1.571, 0.785]], "padding_m": 0.02}
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

/// Metres; joints in rad, metres for a prismatic one.
struct QueryRequest {
    QueryKind kind = QueryKind::postures;
    /// Joint configurations on the way, each as the rig's `joints` has them; empty: as the arm stands.
    std::vector<std::vector<double>> path;
    double padding_m = 0.0;
    double reach_m = 0.5;  ///< up to here clearances are told; 0: none are
    double step = 0.05;    ///< of a joint between two postures of a path, at most
    std::vector<std::string> links_ignored;
    bool asks_unmoved_links = false;
    /// What lies within the arm as it stands, and what is unknown so near to it, counts as free; empty: not.
    std::optional<double> own_space_m;

    double radius_m = 1.0;          ///< of the ball about the robot's base where pockets are looked for
    std::optional<double> z_min_m;  ///< and above what height, in the map; empty: the base's
    double pocket_min_m3 = 1e-4;
    std::size_t pockets_max = 10;
    std::size_t views_tried = 3000;  ///< postures; 0: no view is looked for
};

inline constexpr std::size_t kConfigurationsMax = 1000;
inline constexpr double kReachMax_m = 5.0;
inline constexpr double kStepMin = 5e-3;
inline constexpr std::size_t kViewsTriedMax = 20'000;
inline constexpr double kRadiusMax_m = 5.0;

/// As it is sent, without a line feed.
[[nodiscard]] std::string to_line(const QueryRequest& request);
[[nodiscard]] bool is_query(std::string_view line) noexcept;
/// The same back. Errors (`usage`) name the key: one that is unknown, of the wrong kind or out of range.
[[nodiscard]] Result<QueryRequest, AppError> read_query(std::string_view line);
/// Why it cannot be asked; empty if it can. For a request that was not read.
[[nodiscard]] std::string fault_of(const QueryRequest& request);

}  // namespace octoskin
