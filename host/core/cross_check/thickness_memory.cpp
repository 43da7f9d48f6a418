#include "host/core/cross_check/thickness_memory.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {
namespace {

constexpr std::size_t kPlaces = 512;
constexpr double kExtentM = 1.2;
/// Sensors agree if their values differ by at most this.
constexpr float kAgreementM = 0.04F;
constexpr std::size_t kAgreeingMin = 2;
constexpr std::uint16_t kCountMax = 8;
constexpr double kSigmaM = 0.015;

}  // namespace

ThicknessMemory::ThicknessMemory() {
    places_.reserve(kPlaces);
}

std::optional<std::size_t> ThicknessMemory::find(const Eigen::Vector3d& p_map) const {
    std::optional<std::size_t> nearest;
    double nearest_m = kExtentM;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const double distance_m = (p_map - places_[i].p_map).norm();
        if (distance_m >= nearest_m) continue;
        nearest = i;
        nearest_m = distance_m;
    }
    return nearest;
}

void ThicknessMemory::add(std::uint16_t sensor, const Eigen::Vector3d& p_map, double thickness_m) {
    auto found = find(p_map);
    if (!found) {
        if (places_.size() < kPlaces) places_.emplace_back();
        found = next_;
        next_ = (next_ + 1) % kPlaces;
        places_[*found] = Place{.p_map = p_map, .next = 0, .words = {}};
    }
    Place& place = places_[*found];
    auto word = std::ranges::find_if(
        place.words, [sensor](const Word& of) { return of.count > 0 && of.sensor == sensor; });
    if (word == place.words.end()) {
        word = place.words.begin() + place.next;
        place.next = static_cast<std::uint8_t>((place.next + 1U) % kWords);
        *word = Word{.sensor = sensor, .count = 0, .mean_m = 0.0F};
    }
    word->count = std::min<std::uint16_t>(kCountMax, static_cast<std::uint16_t>(word->count + 1U));
    word->mean_m += (static_cast<float>(thickness_m) - word->mean_m) / static_cast<float>(word->count);
}

std::optional<ThicknessMemory::Known> ThicknessMemory::known_to_others(std::uint16_t sensor,
                                                                       const Eigen::Vector3d& p_map) const {
    const auto found = find(p_map);
    if (!found) return std::nullopt;
    const Place& place = places_[*found];
    std::array<float, kWords> others;
    std::size_t count = 0;
    for (const Word& word : place.words) {
        if (word.count == 0 || word.sensor == sensor) continue;
        std::size_t at = count++;  // insertion in ascending order
        for (; at > 0 && others[at - 1] > word.mean_m; --at) others[at] = others[at - 1];
        others[at] = word.mean_m;
    }
    if (count < kAgreeingMin || others[kAgreeingMin - 1] - others[0] > kAgreementM) return std::nullopt;
    double sum = 0.0;
    for (std::size_t i = 0; i < kAgreeingMin; ++i) sum += static_cast<double>(others[i]);
    return Known{sum / static_cast<double>(kAgreeingMin), kSigmaM};
}

}  // namespace octoskin
