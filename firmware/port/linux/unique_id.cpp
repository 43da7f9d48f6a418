#include "firmware/port/linux/unique_id.hpp"

#include <fstream>
#include <string_view>

namespace octoskin::linux_port {
namespace {

std::uint64_t fnv1a(std::uint64_t hash, std::string_view text) {
    constexpr std::uint64_t kPrime = 0x0000'0100'0000'01B3;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * kPrime;
    return hash * kPrime;  // terminates the text: "a", "bc" differs from "ab", "c"
}

std::uint64_t hash_of(std::string_view role, const std::string& machine, std::span<const std::string> buses) {
    constexpr std::uint64_t kOffsetBasis = 0xCBF2'9CE4'8422'2325;
    std::uint64_t hash = fnv1a(fnv1a(kOffsetBasis, role), machine);
    for (const std::string& bus : buses) hash = fnv1a(hash, bus);
    return hash;
}

}  // namespace

std::optional<std::array<std::uint8_t, 12>> unique_id(std::span<const std::string> buses,
                                                      const std::filesystem::path& machine_id_file) {
    std::string machine;
    std::ifstream(machine_id_file) >> machine;
    constexpr std::size_t kDigits = 32;
    if (machine.size() != kDigits) return std::nullopt;
    const std::uint64_t first = hash_of("octoskin node", machine, buses);
    const std::uint64_t last = hash_of("octoskin node, the last four bytes", machine, buses);
    std::array<std::uint8_t, 12> uid{};
    for (std::size_t i = 0; i < uid.size(); ++i) {
        const std::uint64_t from = i < 8 ? first : last;
        uid.at(i) = static_cast<std::uint8_t>(from >> (8 * (i % 8)) & 0xFFU);
    }
    return uid;
}

}  // namespace octoskin::linux_port
