#include "host/bridge/view/foxglove_server.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <new>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/apps/daemon/daemon_client.hpp"

namespace octoskin::view {
namespace {

using Json = nlohmann::ordered_json;

/// As the daemon's control socket takes them.
constexpr std::size_t kRequestBytesMax = std::size_t{40} << 10U;
constexpr const char* kDroppedId = "octoskin.dropped";

WebMessage text_message(std::string text) {
    return {std::move(text), nullptr, false};
}

/// The request as one line; empty: it is no JSON object.
std::optional<std::string> one_line(const std::string& payload) {
    if (payload.size() > kRequestBytesMax || is_nested_too_deep(payload)) return std::nullopt;
    const Json json = Json::parse(payload, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    std::string line = json.dump();  // a number may be longer than it was
    return line.size() <= kRequestBytesMax ? std::optional(std::move(line)) : std::nullopt;
}

}  // namespace

ChannelId FoxgloveServer::open(foxglove::ChannelInfo info, bool is_kept) {
    return open(Channel{.info = std::move(info), .is_kept = is_kept});
}

ChannelId FoxgloveServer::open(foxglove::ChannelInfo info, StreamSource& source) {
    return open(Channel{.info = std::move(info), .source = &source});
}

ChannelId FoxgloveServer::open(Channel channel) {
    const ChannelId id = next_channel_++;
    channel.info.id = id;
    put_text_to_all(foxglove::advertise_text(std::span(&channel.info, 1)));
    channels_.emplace(id, std::move(channel));
    return id;
}

void FoxgloveServer::close(ChannelId channel) {
    if (channels_.erase(channel) == 0) return;
    for (auto& [id, client] : clients_) client.forget(channel);
    put_text_to_all(foxglove::unadvertise_text(std::span(&channel, 1)));
}

void FoxgloveServer::publish(ChannelId channel, WallTime when, std::string payload, std::uint32_t key) {
    const auto found = channels_.find(channel);
    if (found == channels_.end()) return;
    const ChannelMessage message{std::make_shared<const std::string>(std::move(payload)), when};
    if (found->second.is_kept) found->second.newest.insert_or_assign(key, message);
    if (found->second.readers == 0) return;
    for (auto& [id, client] : clients_) client.publish(channel, key, message);
    wake_readers(channel);
}

void FoxgloveServer::wake_readers(ChannelId channel) {
    for (const auto& [id, client] : clients_)
        if (client.reads(channel)) transport_.wake(id);
}

std::uint32_t FoxgloveServer::readers(ChannelId channel) const {
    const auto found = channels_.find(channel);
    return found == channels_.end() ? 0 : found->second.readers;
}

void FoxgloveServer::forget_messages(ChannelId channel) {
    const auto found = channels_.find(channel);
    if (found != channels_.end()) found->second.newest.clear();
}

void FoxgloveServer::add_service(std::string name, std::string type,
                                 std::function<void(std::string, Reply)> handler) {
    const auto id = static_cast<std::uint32_t>(services_.size() + 1);
    foxglove::ServiceInfo info{id, std::move(name), std::move(type)};
    put_text_to_all(foxglove::advertise_services_text(std::span(&info, 1)));
    services_.emplace(id, Service{std::move(info), std::move(handler)});
}

void FoxgloveServer::serve_assets(ReadAsset read) {
    info_.capabilities.emplace_back("assets");
    read_asset_ = std::move(read);
}

void FoxgloveServer::notify(foxglove::Level level, const std::string& id, const std::string& sentence) {
    const auto found = notices_.find(id);
    if (found == notices_.end() ? sentence.empty() : found->second.sentence == sentence) return;
    if (sentence.empty()) {
        notices_.erase(found);
        return put_text_to_all(foxglove::remove_status_text(id));
    }
    notices_.insert_or_assign(id, Notice{level, sentence});
    put_text_to_all(foxglove::status_text(level, id, sentence));
}

void FoxgloveServer::notify_dropped() {
    std::vector<std::pair<ClientId, std::uint64_t>> behind;
    for (auto& [id, client] : clients_) {
        if (client.dropped() == client.dropped_said) continue;
        counts_.dropped += client.dropped() - client.dropped_said;
        client.dropped_said = client.dropped();
        behind.emplace_back(id, client.dropped());
    }
    for (const auto& [id, dropped] : behind)
        put_text(id, foxglove::status_text(
                         foxglove::Level::info, kDroppedId,
                         fmt::format("{} messages were left out because newer ones came before this client "
                                     "had read them",
                                     dropped)));
}

void FoxgloveServer::put(ClientId client, WebMessage message) {
    const auto found = clients_.find(client);
    if (found == clients_.end()) return;
    if (!found->second.put(std::move(message))) return transport_.drop(client, Refusal::stalled);
    transport_.wake(client);
}

void FoxgloveServer::put_text(ClientId client, std::string text) {
    put(client, text_message(std::move(text)));
}

void FoxgloveServer::put_text_to_all(const std::string& text) {
    for (const auto& [id, client] : clients_) put_text(id, text);
}

void FoxgloveServer::on_open(ClientId client) {
    ++counts_.clients;
    ViewClient& opened = clients_[client];
    std::vector<foxglove::ChannelInfo> channels;
    for (const auto& [id, channel] : channels_) channels.push_back(channel.info);
    std::vector<foxglove::ServiceInfo> services;
    for (const auto& [id, service] : services_) services.push_back(service.info);
    std::vector<std::string> texts = {foxglove::server_info_text(info_), foxglove::advertise_text(channels),
                                      foxglove::advertise_services_text(services)};
    for (const auto& [id, notice] : notices_)
        texts.push_back(foxglove::status_text(notice.level, id, notice.sentence));
    for (std::string& text : texts)
        if (!opened.put(text_message(std::move(text)))) return transport_.drop(client, Refusal::stalled);
}

std::optional<Refusal> FoxgloveServer::on_message(ClientId client, std::string_view message, bool is_binary) {
    auto request = is_binary ? foxglove::parse_binary(message) : foxglove::parse_text(message);
    if (!request) {
        spdlog::warn("a client's message is refused: {}", foxglove::name_of(request.error()));
        return Refusal::malformed;
    }
    std::visit([this, client](auto&& one) { take(client, std::move(one)); }, std::move(request).value());
    return std::nullopt;
}

void FoxgloveServer::take(ClientId id, const foxglove::Subscribe& request) {
    for (const foxglove::Subscription& wanted : request.subscriptions) subscribe(id, wanted);
    transport_.wake(id);
}

void FoxgloveServer::subscribe(ClientId id, const foxglove::Subscription& wanted) {
    const auto channel = channels_.find(wanted.channel);
    if (channel == channels_.end())  // closed while the request was on its way, or wrong
        return warn(id, fmt::format("there is no channel {}", wanted.channel));
    ViewClient& client = clients_[id];
    if (client.has_subscription(wanted.channel, wanted.id))
        return warn(id, fmt::format("channel {} or subscription {} is in use", wanted.channel, wanted.id));
    auto stream = channel->second.source != nullptr ? channel->second.source->stream() : nullptr;
    client.subscribe(wanted.channel, wanted.id, channel->second.newest, std::move(stream));
    ++channel->second.readers;
}

void FoxgloveServer::take(ClientId id, const foxglove::Unsubscribe& request) {
    for (const std::uint32_t subscription : request.subscriptions) {
        const auto channel = clients_[id].unsubscribe(subscription);
        if (channel)
            --channels_.at(*channel).readers;
        else
            warn(id, fmt::format("there is no subscription {}", subscription));
    }
}

void FoxgloveServer::take(ClientId id, foxglove::ServiceCall request) {
    const auto fail = [&](const std::string& why) {
        ++counts_.refused_calls;
        put_text(id, foxglove::call_failure_text(request.service, request.call, why));
    };
    const auto service = services_.find(request.service);
    if (service == services_.end()) return fail("there is no service of this number");
    if (request.encoding != "json") return fail("the encoding must be json");
    auto line = one_line(request.payload);
    if (!line) return fail("expected a JSON object of at most 40 KiB");
    if (clients_[id].calls >= kCallsMax) return fail("four calls wait for an answer: wait for one of them");
    ++clients_[id].calls;
    service->second.handler(std::move(*line),
                            {.give = [this, id, number = request.service, call = request.call](
                                         Answer given) { answer(id, number, call, std::move(given)); },
                             .is_wanted = [this, id] { return clients_.contains(id); }});
}

void FoxgloveServer::answer(ClientId id, std::uint32_t service, std::uint32_t call, Answer answer) {
    const auto client = clients_.find(id);
    if (client == clients_.end()) return;
    --client->second.calls;
    if (!answer) return put_text(id, foxglove::call_failure_text(service, call, answer.error()));
    put(id, {foxglove::response_head(service, call, "json"),
             std::make_shared<const std::string>(std::move(answer).value()), true});
}

void FoxgloveServer::take(ClientId id, foxglove::FetchAsset request) {
    if (!read_asset_) return take(id, foxglove::Unsupported{"fetchAsset"});
    std::deque<foxglove::FetchAsset>& waiting = clients_[id].assets;
    if (waiting.size() >= kAssetsMax) {
        const auto failure = foxglove::asset_failure(request.request, "256 files wait: wait for one of them");
        return put(id, {failure, nullptr, true});
    }
    waiting.push_back(std::move(request));
    transport_.wake(id);
}

WebMessage FoxgloveServer::next_asset(ViewClient& client) {
    const foxglove::FetchAsset asked = std::move(client.assets.front());
    client.assets.pop_front();
    client.had_asset = true;
    try {
        auto file = read_asset_(asked.uri);
        if (!file) return {foxglove::asset_failure(asked.request, file.error()), nullptr, true};
        return {foxglove::asset_head(asked.request),
                std::make_shared<const std::string>(std::move(file).value()), true};
    } catch (const std::bad_alloc&) {  // of a file of many megabytes, not of a few bytes
        return {foxglove::asset_failure(asked.request, "there is too little memory for this file"), nullptr,
                true};
    }
}

void FoxgloveServer::take(ClientId id, const foxglove::Unsupported& request) {
    ++counts_.unsupported;
    warn(id, "this server does not have the operation '" + request.operation + "'");
}

void FoxgloveServer::warn(ClientId id, const std::string& sentence) {
    put_text(id, foxglove::status_text(foxglove::Level::warning, "octoskin.request", sentence));
}

std::optional<WebMessage> FoxgloveServer::next(ClientId client) {
    const auto found = clients_.find(client);
    if (found == clients_.end()) return std::nullopt;
    ViewClient& ready = found->second;
    // Files and other messages in turn: neither keeps the other from the client.
    if (!ready.assets.empty() && !ready.had_asset) return next_asset(ready);
    ready.had_asset = false;
    auto message = ready.next();
    if (!message && !ready.assets.empty()) return next_asset(ready);
    return message;
}

void FoxgloveServer::on_close(ClientId client) {
    const auto found = clients_.find(client);
    if (found == clients_.end()) return;
    for (auto& [id, channel] : channels_)
        if (found->second.reads(id)) --channel.readers;
    counts_.dropped += found->second.dropped() - found->second.dropped_said;
    clients_.erase(found);
}

void FoxgloveServer::on_refused(Refusal why, const std::string& value) {
    ++counts_.refused[static_cast<std::size_t>(why)];
    if (why == Refusal::origin && value != "null")
        spdlog::warn("refused a page of the origin '{0}'; to accept it: --allow-origin {0}", value);
    else
        spdlog::warn("refused a connection ({}){}{}", name_of(why), value.empty() ? "" : ": ", value);
}

}  // namespace octoskin::view
