#include "host/core/time/clock_map.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

namespace octoskin {
namespace {

/// Longer than any exchange takes to settle, and far below the 35 minutes of `elapsed()`. After such a gap
/// the old line is of no use for a comparison.
constexpr Nanoseconds kForgetAfter{60'000'000'000};
/// Points kept beyond the window, for instants before the newest exchanges have settled.
constexpr std::size_t kPointsSettling = 8;

}  // namespace

/// Least squares relative to the newest point: nanoseconds stay exact in a double.
struct ClockMap::Line {
    std::span<const Point> points;
    double node_mean_us = 0.0;  ///< of node_us - origin
    double lag_mean_ns = 0.0;   ///< of host - node, in excess of the origin's
    double slope = 0.0;         ///< ns of host time per us of node time, in excess of 1000
    double spread = 0.0;        ///< sum of squared node_us deviations

    [[nodiscard]] const Point& origin() const { return points.back(); }
    [[nodiscard]] double offset_us(const Point& point) const {
        return static_cast<double>(point.node_us - origin().node_us);
    }
    [[nodiscard]] double lag_ns(const Point& point) const {
        return static_cast<double>((point.host - origin().host).count() -
                                   1000 * (point.node_us - origin().node_us));
    }

    explicit Line(std::span<const Point> through) : points(through) {
        const auto count = static_cast<double>(points.size());
        for (const Point& point : points) {
            node_mean_us += offset_us(point) / count;
            lag_mean_ns += lag_ns(point) / count;
        }
        double product = 0.0;
        for (const Point& point : points) {
            const double deviation_us = offset_us(point) - node_mean_us;
            spread += deviation_us * deviation_us;
            product += deviation_us * lag_ns(point);
        }
        slope = spread > 0.0 ? product / spread : 0.0;
    }

    [[nodiscard]] HostTime at(std::int64_t node_us) const {
        const std::int64_t offset = node_us - origin().node_us;
        const double lag = lag_mean_ns + slope * (static_cast<double>(offset) - node_mean_us);
        return origin().host + Nanoseconds{1000 * offset + std::llround(lag)};
    }

    [[nodiscard]] std::int64_t node_us_at(HostTime host) const {
        const auto since_ns = static_cast<double>((host - origin().host).count());
        return origin().node_us +
               std::llround((since_ns - lag_mean_ns + slope * node_mean_us) / (1000.0 + slope));
    }

    /// The estimate is a weighted sum of the points and exact on straight lines. So its error is at most the
    /// sum, with absolute weights, of two terms per point: the point's own error, and the distance by which a
    /// wandering clock can leave its tangent between the point and the instant.
    [[nodiscard]] Nanoseconds error_bound(std::int64_t node_us, const ClockMapConfig& config) const {
        const double x_us = static_cast<double>(node_us - origin().node_us);
        double bound_ns = 0.0;
        for (const Point& point : points) {
            const double deviation_us = offset_us(point) - node_mean_us;
            const double weight = 1.0 / static_cast<double>(points.size()) +
                                  (spread > 0.0 ? (x_us - node_mean_us) * deviation_us / spread : 0.0);
            const double away_s = 1e-6 * (offset_us(point) - x_us);
            const double wander_ns = 1e9 * 0.5 * config.wander_per_s * away_s * away_s;
            bound_ns += std::abs(weight) * (static_cast<double>(config.stamp_error.count()) + wander_ns);
        }
        return Nanoseconds{static_cast<std::int64_t>(std::ceil(bound_ns))};
    }
};

ClockMap::Line ClockMap::line(std::size_t count) const {
    assert(count >= 1 && count <= points_.size());
    const std::size_t used = std::min(count, config_.window);
    return Line(std::span(points_).subspan(count - used, used));
}

void ClockMap::forget() {
    points_.clear();
    suspect_.reset();
}

bool ClockMap::is_plausible_step(const SyncSample& from, const SyncSample& to) const {
    const Nanoseconds host = to.host - from.host;
    const Nanoseconds node = elapsed(from.heard, to.heard);
    const double allowed_ns = config_.drift_max * static_cast<double>(host.count()) +
                              2.0 * static_cast<double>(config_.stamp_error.count());
    return host.count() > 0 && node.count() > 0 &&
           static_cast<double>(std::chrono::abs(host - node).count()) <= allowed_ns;
}

bool ClockMap::is_consistent(const SyncSample& sample) const {
    if (!is_plausible_step({points_.back().host, heard_last_}, sample)) {
        return false;
    }
    if (points_.size() < 2) {
        return true;
    }
    const Line known = line(points_.size());
    const std::int64_t node_us = points_.back().node_us + elapsed(heard_last_, sample.heard).count();
    const Nanoseconds allowed = known.error_bound(node_us, config_) + config_.stamp_error;
    return std::chrono::abs(sample.host - known.at(node_us)) <= allowed;
}

SampleEffect ClockMap::add(const SyncSample& sample) {
    if (!points_.empty() && sample.host - points_.back().host > kForgetAfter) {
        forget();
    }
    SampleEffect verdict = SampleEffect::used;
    if (!points_.empty() && !is_consistent(sample)) {
        if (!suspect_ || !is_plausible_step(*suspect_, sample)) {
            suspect_ = sample;
            return SampleEffect::contradicts;
        }
        points_ = {{suspect_->heard.us, suspect_->host}};
        heard_last_ = suspect_->heard;
        verdict = SampleEffect::relocked;
        ++relocks_;
    }
    const std::int64_t node_us = points_.empty()
                                     ? sample.heard.us
                                     : points_.back().node_us + elapsed(heard_last_, sample.heard).count();
    points_.push_back({node_us, sample.host});
    heard_last_ = sample.heard;
    suspect_.reset();
    if (points_.size() > config_.window + kPointsSettling) {
        points_.erase(points_.begin());
    }
    return verdict;
}

std::optional<ClockFault> ClockMap::fault(HostTime now) const {
    if (suspect_) {
        return ClockFault::in_doubt;
    }
    if (points_.size() < 2) {
        return ClockFault::not_ready;
    }
    if (now - points_.back().host > config_.silence_max) {
        return ClockFault::silent;
    }
    return std::nullopt;
}

std::int64_t ClockMap::unwrap(const wire::TimeResidue& residue, HostTime now) const {
    // The span divides 2^32, and node times in points_ are congruent to the counter modulo 2^32.
    assert(residue.span_us > 0 && (residue.span_us & (residue.span_us - 1)) == 0);
    const std::int64_t latest_us = line(points_.size()).node_us_at(now) + config_.now_slack.count();
    const std::int64_t span_us = residue.span_us;
    const std::int64_t above_us = (latest_us - static_cast<std::int64_t>(residue.value_us)) % span_us;
    return latest_us - (above_us < 0 ? above_us + span_us : above_us);
}

Result<MappedTime, ClockFault> ClockMap::locate(const wire::TimeResidue& residue, HostTime now) const {
    if (const auto reason = fault(now)) {
        return unexpected(*reason);
    }
    const std::int64_t node_us = unwrap(residue, now);
    const auto is_unsettled = [&](const Point& point) {
        return point.node_us + config_.settling.count() > node_us;
    };
    const auto settled = std::ranges::find_if(points_, is_unsettled) - points_.begin();
    if (settled < 2) {
        return unexpected(ClockFault::not_ready);
    }
    const Line known = line(static_cast<std::size_t>(settled));
    return MappedTime{known.at(node_us), known.error_bound(node_us, config_)};
}

std::optional<Nanoseconds> ClockMap::error_bound(HostTime now) const {
    if (fault(now)) {
        return std::nullopt;
    }
    const Line known = line(points_.size());
    return known.error_bound(known.node_us_at(now), config_);
}

std::optional<double> ClockMap::drift() const {
    if (points_.size() < 2) {
        return std::nullopt;
    }
    return line(points_.size()).slope / 1000.0;
}

}  // namespace octoskin
