#include "host/core/mapping/counted_brick.hpp"

#include <new>

namespace octoskin {
namespace {

BrickView none_if_unknown(const BrickView& view) noexcept {
    return view.is_unknown() ? BrickView{nullptr, 0.0F} : view;
}

}  // namespace

void CountedBrick::look_anew() noexcept {
    MapLayers& layers = editor_.layers();
    own_hits_ = BrickTree::OwnBricks(layers.counts.hits);
    own_misses_ = BrickTree::OwnBricks(layers.counts.misses);
    own_log_odds_ = BrickTree::OwnBricks(layers.log_odds);
}

void CountedBrick::find() noexcept {
    const MapLayers& layers = editor_.layers();
    hits_ = own_hits_.find(first_);
    misses_ = own_misses_.find(first_);
    log_odds_ = own_log_odds_.find(first_);
    prior_ = nullptr;
    const bool is_counted = hits_ != nullptr || layers.counts.has(first_);
    hits_view_ = hits_ != nullptr ? BrickView{hits_} : none_if_unknown(layers.counts.hits.find(first_));
    misses_view_ =
        misses_ != nullptr ? BrickView{misses_} : none_if_unknown(layers.counts.misses.find(first_));
    log_odds_view_ = log_odds_ != nullptr ? BrickView{log_odds_} : layers.log_odds.find(first_);
    prior_view_ = is_counted ? layers.counts.prior.find(first_) : log_odds_view_;
}

Status<MapRefusal> CountedBrick::open_closed_counts() noexcept {
    if (const auto is_open = editor_.open_counts(first_); !is_open) return is_open;
    look_anew();
    find();
    return Done{};
}

Status<MapRefusal> CountedBrick::open_prior() noexcept {
    if (prior_ != nullptr) return Done{};
    try {
        prior_ = &editor_.layers().counts.prior.open(first_);
    } catch (const std::bad_alloc&) {
        return unexpected(&MapCounters::no_memory);
    }
    prior_view_ = BrickView{prior_};
    return Done{};
}

Status<MapRefusal> CountedBrick::open_log_odds() noexcept {
    if (log_odds_ != nullptr) return Done{};
    BrickTree& log_odds = editor_.layers().log_odds;
    const auto is_open = editor_.change(first_, [&] { log_odds_ = &log_odds.open(first_); });
    if (!is_open) return is_open;
    own_log_odds_ = BrickTree::OwnBricks(log_odds);
    log_odds_view_ = BrickView{log_odds_};
    return Done{};
}

}  // namespace octoskin
