#include "host/core/witness/thickness_memory.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {
namespace {

constexpr std::size_t kCells = 2048;
constexpr double kEdgeM = 0.6;
/// Others agree who are within this of each other.
constexpr float kAgreementM = 0.04F;
constexpr std::size_t kAgreeingMin = 2;
constexpr std::uint16_t kCountMax = 8;
constexpr double kSigmaM = 0.015;

}  // namespace

ThicknessMemory::ThicknessMemory() : cells_(kCells) {}

ThicknessMemory::Place ThicknessMemory::place_of(const Eigen::Vector3d& p_map) {
    Place place;
    for (int i = 0; i < 3; ++i)
        place[static_cast<std::size_t>(i)] =
            static_cast<std::int16_t>(std::clamp(std::floor(p_map[i] / kEdgeM), -30'000.0, 30'000.0));
    return place;
}

std::size_t ThicknessMemory::index_of(const Place& place) const {
    std::uint32_t hash = 2'166'136'261U;
    for (const std::int16_t coordinate : place)
        hash = (hash ^ static_cast<std::uint16_t>(coordinate)) * 16'777'619U;
    return (hash ^ (hash >> 15U)) % cells_.size();
}

void ThicknessMemory::add(std::uint16_t sensor, const Eigen::Vector3d& p_map, double thickness_m) {
    const Place place = place_of(p_map);
    Cell& cell = cells_[index_of(place)];
    if (cell.place != place) cell = Cell{.place = place, .next = 0, .words = {}};
    auto word = std::ranges::find_if(
        cell.words, [sensor](const Word& of) { return of.count > 0 && of.sensor == sensor; });
    if (word == cell.words.end()) {
        word = cell.words.begin() + cell.next;
        cell.next = static_cast<std::uint8_t>((cell.next + 1U) % kWords);
        *word = Word{.sensor = sensor, .count = 0, .mean_m = 0.0F};
    }
    word->count = std::min<std::uint16_t>(kCountMax, static_cast<std::uint16_t>(word->count + 1U));
    word->mean_m += (static_cast<float>(thickness_m) - word->mean_m) / static_cast<float>(word->count);
}

std::optional<ThicknessMemory::Known> ThicknessMemory::known_to_others(std::uint16_t sensor,
                                                                       const Eigen::Vector3d& p_map) const {
    const Place place = place_of(p_map);
    const Cell& cell = cells_[index_of(place)];
    if (cell.place != place) return std::nullopt;
    std::array<float, kWords> others;
    std::size_t count = 0;
    for (const Word& word : cell.words) {
        if (word.count == 0 || word.sensor == sensor) continue;
        std::size_t at = count++;  // in ascending order
        for (; at > 0 && others[at - 1] > word.mean_m; --at) others[at] = others[at - 1];
        others[at] = word.mean_m;
    }
    std::size_t first = 0;
    std::size_t agreeing = 0;
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t j = i;
        while (j < count && others[j] <= others[i] + kAgreementM) ++j;
        if (j - i > agreeing) {
            first = i;
            agreeing = j - i;
        }
    }
    if (agreeing < kAgreeingMin || 2 * agreeing <= count) return std::nullopt;
    double sum = 0.0;
    for (std::size_t i = first; i < first + agreeing; ++i) sum += static_cast<double>(others[i]);
    return Known{sum / static_cast<double>(agreeing), kSigmaM};
}

}  // namespace octoskin
