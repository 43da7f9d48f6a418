#include "host/bridge/view/view_client.hpp"

#include <algorithm>
#include <utility>

namespace octoskin::view {
namespace {

std::size_t bytes_of(const WebMessage& message) {
    return message.head.size() + (message.body ? message.body->size() : 0);
}

}  // namespace

bool ViewClient::put(WebMessage message) {
    const std::size_t bytes = bytes_of(message);
    if (text_bytes_ + bytes > kBytesMax) return false;
    text_bytes_ += bytes;
    texts_.push_back(std::move(message));
    return true;
}

bool ViewClient::has_subscription(std::uint32_t channel, std::uint32_t id) const {
    return subscriptions_.contains(channel) ||
           std::ranges::any_of(subscriptions_, [id](const auto& one) { return one.second.id == id; });
}

void ViewClient::subscribe(std::uint32_t channel, std::uint32_t id, NewestMessages newest,
                           std::unique_ptr<MessageStream> stream) {
    subscriptions_.emplace(channel, Subscription{id, std::move(newest), std::move(stream)});
}

std::optional<std::uint32_t> ViewClient::unsubscribe(std::uint32_t id) {
    const auto found =
        std::ranges::find_if(subscriptions_, [id](const auto& one) { return one.second.id == id; });
    if (found == subscriptions_.end()) return std::nullopt;
    const std::uint32_t channel = found->first;
    subscriptions_.erase(found);
    return channel;
}

void ViewClient::forget(std::uint32_t channel) {
    subscriptions_.erase(channel);
}

void ViewClient::publish(std::uint32_t channel, std::uint32_t key, const ChannelMessage& message) {
    const auto found = subscriptions_.find(channel);
    if (found == subscriptions_.end()) return;
    if (!found->second.waiting.insert_or_assign(key, message).second) ++dropped_;
}

std::optional<WebMessage> ViewClient::next_of(Subscription& subscription) {
    ChannelMessage message;
    if (!subscription.waiting.empty()) {
        message = std::move(subscription.waiting.begin()->second);
        subscription.waiting.erase(subscription.waiting.begin());
    } else if (subscription.stream != nullptr) {
        auto made = subscription.stream->next();
        if (!made) return std::nullopt;
        message = {std::make_shared<const std::string>(std::move(made->payload)), made->when};
    } else {
        return std::nullopt;
    }
    return WebMessage{foxglove::message_head(subscription.id, message.when), std::move(message.payload),
                      true};
}

std::optional<WebMessage> ViewClient::next() {
    if (!texts_.empty()) {
        WebMessage message = std::move(texts_.front());
        texts_.pop_front();
        text_bytes_ -= bytes_of(message);
        return message;
    }
    auto one = subscriptions_.upper_bound(served_);
    for (std::size_t i = 0; i < subscriptions_.size(); ++i, ++one) {
        if (one == subscriptions_.end()) one = subscriptions_.begin();
        if (auto message = next_of(one->second)) {
            served_ = one->first;
            return message;
        }
    }
    return std::nullopt;
}

}  // namespace octoskin::view
