// An error that all sensors share, by weighted least squares, and what each sensor says of it. The same for
// the camera's seven unknowns and for a joint's one.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "host/core/witness/range_change.hpp"

namespace octoskin {

/// What one sensor knows of N unknowns: normal equations.
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

/// The normal equations of one sensor's comparisons: of N unknowns that all sensors share, and of what is the
/// sensor's own, its offset (m) and how much thicker than expected the walls are that it sees from behind
/// (m).
template <int N>
class ErrorFit {
  public:
    using Vector = Eigen::Matrix<double, N, 1>;

    /// `change`: of the range with each of the N.
    void add(const Vector& change, const RangeChange& range) {
        Eigen::Matrix<double, kAll, 1> all;
        all << change, 1.0, (range.is_from_behind ? -1.0 : 0.0);
        information_ += range.weight * all * all.transpose();
        moment_ += range.weight * range.off_m * all;
        weight_ += range.weight;
    }
    /// The oldest of some 1500 comparisons, of all sensors, count for little: to be called with each.
    void forget() {
        constexpr double kKept = 1.0 - 1.0 / 1500.0;
        information_ *= kKept;
        moment_ *= kKept;
        weight_ *= kKept;
    }
    /// The sensor's own unknowns, with their prior, taken out of its normal equations (Schur complement).
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

/// What the sensors say of an error: log-likelihood ratios to none.
struct ErrorEvidence {
    std::vector<double> said;   ///< by sensor
    double sum = 0.0;           ///< less what the error is unlikely by itself
    double evidence = 0.0;      ///< the same without the sensor that speaks for it most
    std::size_t explained = 0;  ///< sensors that speak for it
    double moved_m = 0.0;       ///< by so much it moves what is predicted, in the mean of squares

    /// Less is no fault.
    static constexpr double kMovedMinM = 0.006;
    /// `unlikely`: so much evidence is rare where nothing is off.
    [[nodiscard]] bool is_suspect(double unlikely) const {
        return evidence >= unlikely && moved_m >= kMovedMinM;
    }
    [[nodiscard]] bool is_to_be_named() const {
        return evidence >= 4.5 && explained >= 2 && moved_m >= kMovedMinM;
    }
    /// Of what is named.
    [[nodiscard]] bool is_to_be_kept() const { return evidence >= 3.0; }
};

/// The likeliest error, by what all sensors know.
template <int N>
struct ErrorEstimate {
    Eigen::Matrix<double, N, N> information;  ///< the prior's, too
    Eigen::Matrix<double, N, 1> moment;
    Eigen::Matrix<double, N, 1> likeliest;
    ErrorEvidence evidence;

    /// `sigmas`: what may be off before anything is compared.
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
