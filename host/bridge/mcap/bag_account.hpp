// What an import used of a bag, and why not the rest.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace octoskin::bridge {

/// The reason for messages of topics that a replay does not use.
inline constexpr std::string_view kNotNeeded = "not_needed";

/// Each message is used, or rejected for one reason.
struct TopicAccount {
    std::string type;
    std::uint64_t messages = 0;
    std::uint64_t used = 0;
    std::map<std::string, std::uint64_t, std::less<>> rejected = {};

    void note_rejected(std::string_view reason, std::uint64_t count = 1) {
        if (count > 0) rejected[std::string(reason)] += count;
    }
    [[nodiscard]] std::uint64_t rejected_in_all() const {
        std::uint64_t all = 0;
        for (const auto& [reason, count] : rejected) all += count;
        return all;
    }
};

/// By topic.
using BagAccount = std::map<std::string, TopicAccount, std::less<>>;

}  // namespace octoskin::bridge
