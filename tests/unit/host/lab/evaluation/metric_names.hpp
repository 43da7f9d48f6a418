#pragma once

#include <array>
#include <string_view>

namespace octoskin::evaluation {

/// Every scalar metric, in the order in which they are printed.
inline constexpr std::array<std::string_view, 26> kMetricNames{"occupied",
                                                               "free",
                                                               "missed",
                                                               "incorrect",
                                                               "lost",
                                                               "precision",
                                                               "recall",
                                                               "f1",
                                                               "iou",
                                                               "precision_tolerant",
                                                               "occluded_recall",
                                                               "object_recall",
                                                               "coverage",
                                                               "log_loss",
                                                               "brier",
                                                               "seen_occupied",
                                                               "seen_free",
                                                               "seen_unknown",
                                                               "f1_seen",
                                                               "f1_noise_free",
                                                               "body_2cm",
                                                               "body_5cm",
                                                               "availability",
                                                               "lost_beyond_camera",
                                                               "freed_occupied",
                                                               "freed_seen_unknown"};

}  // namespace octoskin::evaluation
