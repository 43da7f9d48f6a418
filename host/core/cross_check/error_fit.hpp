// Estimates an error that all sensors share by weighted least squares, and each sensor's evidence for it.
// Used for the camera's seven unknowns and for a joint's one.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "host/core/cross_check/range_change.hpp"

namespace octoskin {

/// One sensor's information about N unknowns: normal equations.
template <int N>
struct ErrorShare {
    Eigen::Matrix<double, N, N> information = Eigen::Matrix<double, N, N>::Zero();
    Eigen::Matrix<double, N, 1> moment = Eigen::Matrix<double, N, 1>::Zero();
    double weight = 0.0;  ///< 1/m^2

    /// Log-likelihood ratio of an error to none.
    [[nodiscard]] double speaks_for(const Eigen::Matrix<double, N, 1>& error) const {
        return error.dot(moment) - 0.5 * error.dot(information * error);
    }
};

/// The normal equations of one sensor's comparisons. Unknowns: N that all sensors share, and two of the
/// sensor's own: its offset (m), and how much thicker than expected the walls are that it sees from behind
/// (m).
template <int N>
class ErrorFit {
  public:
    using Vector = Eigen::Matrix<double, N, 1>;

    /// `change`: change of the range with each of the N unknowns.
    void add(const Vector& change, const RangeChange& range) {
        Eigen::Matrix<double, kAll, 1> all;
        all << change, 1.0, (range.is_from_behind ? -1.0 : 0.0);
        information_ += range.weight * all * all.transpose();
        moment_ += range.weight * range.off_m * all;
        weight_ += range.weight;
    }
    /// Reduces the weight of old comparisons; about 1500 count. Call once for each comparison of any sensor.
    void forget() {
        constexpr double kKept = 1.0 - 1.0 / 1500.0;
        information_ *= kKept;
        moment_ *= kKept;
        weight_ *= kKept;
    }
    /// Eliminates the sensor's own unknowns, with their prior, from its normal equations (Schur complement).
    [[nodiscard]] ErrorShare<N> without_own() const {
        constexpr double kOffsetSigmaM = 0.01;
        constexpr double kWallSigmaM = 0.04;
        Eigen::Matrix2d own = information_.template bottomRightCorner<kOwn, kOwn>();
        own.diagonal() += Eigen::Vector2d(std::pow(kOffsetSigmaM, -2.0), std::pow(kWallSigmaM, -2.0));
        const Eigen::Matrix<double, N, kOwn> shared = information_.template topRightCorner<N, kOwn>();
        const Eigen::Matrix<double, N, kOwn> by_own = shared * own.inverse();
        const Eigen::Vector2d moment_of_own = moment_.template tail<kOwn>();
        return {.information = information_.template topLeftCorner<N, N>() - by_own * shared.transpose(),
                .moment = moment_.template head<N>() - by_own * moment_of_own,
                .weight = weight_};
    }

  private:
    static constexpr int kOwn = 2;
    static constexpr int kAll = N + kOwn;
    Eigen::Matrix<double, kAll, kAll> information_ = Eigen::Matrix<double, kAll, kAll>::Zero();
    Eigen::Matrix<double, kAll, 1> moment_ = Eigen::Matrix<double, kAll, 1>::Zero();
    double weight_ = 0.0;
};

/// The sensors' evidence for an error: log-likelihood ratios of the error to none.
struct ErrorEvidence {
    std::vector<double> said;   ///< by sensor
    double sum = 0.0;           ///< sum, minus the prior's cost of the error
    double evidence = 0.0;      ///< the same without the strongest supporter
    std::size_t explained = 0;  ///< number of sensors that support the error
    double moved_m = 0.0;       ///< root mean square by which the error moves the predictions, metres

    /// A smaller effect is no fault.
    static constexpr double kMovedMinM = 0.006;
    /// `unlikely`: evidence that is rare without an error.
    [[nodiscard]] bool is_suspect(double unlikely) const {
        return evidence >= unlikely && moved_m >= kMovedMinM;
    }
    [[nodiscard]] bool is_to_be_named() const {
        return evidence >= 4.5 && explained >= 2 && moved_m >= kMovedMinM;
    }
    /// For an error that is already reported.
    [[nodiscard]] bool is_to_be_kept() const { return evidence >= 3.0; }
};

/// The most likely error by all sensors' information.
template <int N>
struct ErrorEstimate {
    Eigen::Matrix<double, N, N> information;  ///< including the prior's
    Eigen::Matrix<double, N, 1> moment;
    Eigen::Matrix<double, N, 1> likeliest;
    ErrorEvidence evidence;

    /// `sigmas`: prior standard deviations of the unknowns.
    ErrorEstimate(std::span<const ErrorShare<N>> shares, const Eigen::Matrix<double, N, 1>& sigmas) {
        ErrorShare<N> all;
        for (const ErrorShare<N>& share : shares) {
            all.information += share.information;
            all.moment += share.moment;
            all.weight += share.weight;
        }
        information = all.information;
        information.diagonal() += sigmas.cwiseAbs2().cwiseInverse();
        moment = all.moment;
        likeliest = information.ldlt().solve(moment);
        double most = 0.0;
        for (const ErrorShare<N>& share : shares) {
            evidence.said.push_back(share.speaks_for(likeliest));
            most = std::max(most, evidence.said.back());
        }
        constexpr double kSpeaksFrom = 1.0;
        evidence.explained = static_cast<std::size_t>(
            std::ranges::count_if(evidence.said, [](double said) { return said >= kSpeaksFrom; }));
        evidence.sum = 0.5 * likeliest.dot(moment);
        evidence.evidence = evidence.sum - most;
        const double moved = likeliest.dot(all.information * likeliest);
        evidence.moved_m = all.weight > 0.0 ? std::sqrt(std::max(0.0, moved / all.weight)) : 0.0;
    }
};

}  // namespace octoskin
