#include "host/apps/daemon/sender_shares.hpp"

#include <algorithm>
#include <chrono>

namespace octoskin {
namespace {

/// A sender that was silent for this long has its whole share again: dropping it loses nothing.
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

void SenderShares::keep(const SenderKey& sender, HostTime came) {
    if (Share* const share = share_of(sender, came))
        share->useful = std::max(share->useful, std::optional(came));
}

/// Null: all shares are taken by others.
SenderShares::Share* SenderShares::share_of(const SenderKey& sender, HostTime now) {
    const auto found = std::ranges::find(shares_, sender, &Share::sender);
    if (found != shares_.end()) return &*found;
    std::erase_if(shares_, [now](const Share& share) { return now - share.newest >= kForgotten; });
    if (shares_.size() < kSendersMax) return &shares_.emplace_back(Share{sender, kAtOnce, now, {}});
    // With the rest of that share, and no more: however many programs take turns, they send no more than
    // eight would.
    Share* const lost = share_to_lose(now);
    if (lost != nullptr) lost->sender = sender;
    return lost;
}

/// The share with the largest rest: a new program may have a sample to send.
SenderShares::Share* SenderShares::share_to_lose(HostTime now) {
    Share* found = nullptr;
    for (Share& share : shares_) {
        const bool is_kept = share.useful && now - *share.useful < kForgotten;
        if (!is_kept && (found == nullptr || share.left > found->left)) found = &share;
    }
    if (found != nullptr) found->useful.reset();
    return found;
}

}  // namespace octoskin
