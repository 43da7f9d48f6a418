#include "host/apps/daemon/sender_shares.hpp"

#include <algorithm>
#include <chrono>

namespace octoskin {
namespace {

/// One that was silent for so long has all of its share again: nothing is lost with it.
constexpr Nanoseconds kForgotten{1'000'000'000};
static_assert(SenderShares::kAtOnce <= SenderShares::kPerSecond);

}  // namespace

bool SenderShares::take(const SenderKey& sender, HostTime now) {
    Share* const share = share_of(sender, now);
    if (share == nullptr) return false;
    const std::chrono::duration<double> passed = now - share->newest;
    share->left = std::min(kAtOnce, share->left + kPerSecond * std::max(passed.count(), 0.0));
    share->newest = std::max(share->newest, now);
    if (share->left < 1.0) return false;
    share->left -= 1.0;
    return true;
}

/// Null: as many others have one.
SenderShares::Share* SenderShares::share_of(const SenderKey& sender, HostTime now) {
    const auto found = std::ranges::find(shares_, sender, &Share::sender);
    if (found != shares_.end()) return &*found;
    std::erase_if(shares_, [now](const Share& share) { return now - share.newest >= kForgotten; });
    if (shares_.size() >= kSendersMax) return nullptr;
    return &shares_.emplace_back(Share{sender, kAtOnce, now});
}

}  // namespace octoskin
