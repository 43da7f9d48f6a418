// What waits for one client, in bounded memory: texts and answers in turn, and of each channel the newest
// message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "host/bridge/view/foxglove.hpp"
#include "host/bridge/view/message_stream.hpp"
#include "host/bridge/view/web_server.hpp"

namespace octoskin::view {

/// A message of a channel, shared by its readers.
struct ChannelMessage {
    std::shared_ptr<const std::string> payload;
    WallTime when{0};
};
/// By a number of the channel's own: several of one channel are kept beside each other, as those of several
/// sources of joint states.
using NewestMessages = std::map<std::uint32_t, ChannelMessage>;

class ViewClient {
  public:
    /// Of texts and answers that wait.
    static constexpr std::size_t kBytesMax = std::size_t{4} << 20U;

    /// False: kBytesMax would be exceeded.
    [[nodiscard]] bool put(WebMessage message);
    /// Whether the channel or the identifier is subscribed to already.
    [[nodiscard]] bool has_subscription(std::uint32_t channel, std::uint32_t id) const;
    /// There must be no such subscription yet.
    void subscribe(std::uint32_t channel, std::uint32_t id, NewestMessages newest,
                   std::unique_ptr<MessageStream> stream);
    /// The channel; empty: there is no such subscription.
    std::optional<std::uint32_t> unsubscribe(std::uint32_t id);
    /// The channel has gone.
    void forget(std::uint32_t channel);
    [[nodiscard]] bool reads(std::uint32_t channel) const { return subscriptions_.contains(channel); }
    /// Replaces a message that waits, and counts that.
    void publish(std::uint32_t channel, std::uint32_t key, const ChannelMessage& message);
    /// Texts first; then channels in turn, so that a busy one does not keep the others from the client.
    [[nodiscard]] std::optional<WebMessage> next();

    /// Messages that were replaced before they left.
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

    /// Files that it asked for and did not get yet.
    std::deque<foxglove::FetchAsset> assets;
    bool had_asset = false;  ///< its last message was one
    /// Calls without an answer yet.
    std::size_t calls = 0;
    /// How many of `dropped` the client knows of.
    std::uint64_t dropped_said = 0;

  private:
    struct Subscription {
        std::uint32_t id = 0;
        NewestMessages waiting;
        std::unique_ptr<MessageStream> stream;
    };
    [[nodiscard]] static std::optional<WebMessage> next_of(Subscription& subscription);

    std::deque<WebMessage> texts_;
    std::size_t text_bytes_ = 0;
    std::map<std::uint32_t, Subscription> subscriptions_;  ///< by channel
    std::uint32_t served_ = 0;                             ///< the channel whose message left last
    std::uint64_t dropped_ = 0;
};

}  // namespace octoskin::view
