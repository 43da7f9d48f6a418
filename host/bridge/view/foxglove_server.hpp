// Channels and services for clients of Foxglove's protocol. It knows no socket: WebServer calls it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/bridge/view/foxglove.hpp"
#include "host/bridge/view/message_stream.hpp"
#include "host/bridge/view/view_client.hpp"
#include "host/bridge/view/view_counts.hpp"
#include "host/bridge/view/web_server.hpp"

namespace octoskin::view {

using ChannelId = std::uint32_t;
/// The JSON of an answer, or a sentence why there is none.
using Answer = Result<std::string, std::string>;
/// Takes the answer of a call, once; later than the call, or never.
struct Reply {
    std::function<void(Answer)> give;
    std::function<bool()> is_wanted;  ///< false: the client has gone
    void operator()(Answer answer) const { give(std::move(answer)); }
};

class FoxgloveServer final : public WebClients {
  public:
    /// Calls of one client without an answer; further ones fail at once.
    static constexpr std::size_t kCallsMax = 4;
    static constexpr std::size_t kSubscriptionsMax = foxglove::kListMax;
    /// Files that one client waits for; further ones fail at once.
    static constexpr std::size_t kAssetsMax = 256;

    /// What it needs of the transport.
    struct Transport {
        std::function<void(ClientId)> wake;           ///< there is a message for the client
        std::function<void(ClientId, Refusal)> drop;  ///< ends its connection
    };
    explicit FoxgloveServer(foxglove::ServerInfo info) : info_(std::move(info)) {}
    void connect(Transport transport) { transport_ = std::move(transport); }
    /// Forgets all clients: the transport is about to end.
    void disconnect() { clients_.clear(); }

    /// A channel is there for all clients from now on; `info.id` is ignored. `is_kept`: a new reader gets the
    /// newest message.
    [[nodiscard]] ChannelId open(foxglove::ChannelInfo info, bool is_kept);
    /// With messages of each reader's own. `source` must outlive the channel.
    [[nodiscard]] ChannelId open(foxglove::ChannelInfo info, StreamSource& source);
    void close(ChannelId channel);
    /// For all readers. Messages of one channel with several values of `key` do not replace each other.
    void publish(ChannelId channel, WallTime when, std::string payload, std::uint32_t key = 0);
    /// The streams of the channel have a message.
    void wake_readers(ChannelId channel);
    [[nodiscard]] std::uint32_t readers(ChannelId channel) const;
    /// A new reader gets none of the messages published so far.
    void forget_messages(ChannelId channel);

    /// Takes requests, which are JSON objects in one line.
    void add_service(std::string name, std::string type, std::function<void(std::string, Reply)> handler);

    /// Files for clients, by URI. `read` is called when the client is ready for the file: it gives the bytes,
    /// or a sentence why there are none. To be called before a client is there.
    using ReadAsset = std::function<Result<std::string, std::string>(const std::string& uri)>;
    void serve_assets(ReadAsset read);

    /// A sentence that all clients show, now and later, until another one with this `id`, or an empty one,
    /// replaces it.
    void notify(foxglove::Level level, const std::string& id, const std::string& sentence);
    /// Shows each client how many messages it did not get. Call it every few seconds.
    void notify_dropped();

    [[nodiscard]] const ViewCounts& counts() const noexcept { return counts_; }
    [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }

    void on_open(ClientId client) override;
    [[nodiscard]] std::optional<Refusal> on_message(ClientId client, std::string_view message,
                                                    bool is_binary) override;
    [[nodiscard]] std::optional<WebMessage> next(ClientId client) override;
    void on_close(ClientId client) override;
    void on_refused(Refusal why, const std::string& value) override;

  private:
    struct Channel {
        foxglove::ChannelInfo info;
        bool is_kept = false;
        StreamSource* source = nullptr;
        NewestMessages newest = {};
        std::uint32_t readers = 0;
    };
    struct Service {
        foxglove::ServiceInfo info;
        std::function<void(std::string, Reply)> handler;
    };
    struct Notice {
        foxglove::Level level;
        std::string sentence;
    };
    [[nodiscard]] ChannelId open(Channel channel);
    void put(ClientId client, WebMessage message);
    void put_text(ClientId client, std::string text);
    void put_text_to_all(const std::string& text);
    void take(ClientId id, const foxglove::Subscribe& request);
    void take(ClientId id, const foxglove::Unsubscribe& request);
    void take(ClientId id, foxglove::ServiceCall request);
    void take(ClientId id, foxglove::FetchAsset request);
    void take(ClientId id, const foxglove::Unsupported& request);
    [[nodiscard]] WebMessage next_asset(ViewClient& client);
    void subscribe(ClientId id, const foxglove::Subscription& wanted);
    void answer(ClientId id, std::uint32_t service, std::uint32_t call, Answer answer);
    void warn(ClientId id, const std::string& sentence);

    foxglove::ServerInfo info_;
    Transport transport_;
    std::map<ChannelId, Channel> channels_;
    ChannelId next_channel_ = 1;
    std::map<std::uint32_t, Service> services_;
    ReadAsset read_asset_;
    std::map<ClientId, ViewClient> clients_;
    std::map<std::string, Notice> notices_;
    ViewCounts counts_;
};

}  // namespace octoskin::view
