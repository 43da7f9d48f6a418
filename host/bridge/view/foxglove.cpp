#include "host/bridge/view/foxglove.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/apps/command_line/json_at.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/bridge/view/json_text.hpp"
#include "host/io/snapshot/bytes.hpp"

namespace octoskin::foxglove {
namespace {

using Json = nlohmann::ordered_json;
using snapshot::ByteReader;
using snapshot::ByteWriter;
using view::text_of;

constexpr std::uint8_t kMessageOpcode = 1;
constexpr std::uint8_t kResponseOpcode = 3;
constexpr std::uint8_t kAssetOpcode = 4;
constexpr std::uint8_t kClientMessageOpcode = 1;
constexpr std::uint8_t kCallOpcode = 2;

Json service_schema(const std::string& name) {
    return {{"encoding", "json"},
            {"schemaName", name},
            {"schemaEncoding", "jsonschema"},
            {"schema", R"({"type":"object","properties":{}})"}};
}

bool is_identifier(const Json& value) {
    return value.is_number_unsigned() &&
           value.get<std::uint64_t>() <= std::numeric_limits<std::uint32_t>::max();
}

Result<Request, Fault> subscribe_of(const Json& list) {
    if (!list.is_array()) return unexpected(Fault::bad_member);
    if (list.size() > kListMax) return unexpected(Fault::too_many);
    Subscribe request;
    for (const Json& one : list) {
        if (!is_identifier(at(one, "id")) || !is_identifier(at(one, "channelId")))
            return unexpected(Fault::bad_member);
        request.subscriptions.push_back(
            {at(one, "id").get<std::uint32_t>(), at(one, "channelId").get<std::uint32_t>()});
    }
    return Request(std::move(request));
}

Result<Request, Fault> unsubscribe_of(const Json& list) {
    if (!list.is_array()) return unexpected(Fault::bad_member);
    if (list.size() > kListMax) return unexpected(Fault::too_many);
    Unsubscribe request;
    for (const Json& one : list) {
        if (!is_identifier(one)) return unexpected(Fault::bad_member);
        request.subscriptions.push_back(one.get<std::uint32_t>());
    }
    return Request(std::move(request));
}

Result<Request, Fault> fetch_of(const Json& message) {
    const Json& uri = at(message, "uri");
    if (!uri.is_string() || !is_identifier(at(message, "requestId"))) return unexpected(Fault::bad_member);
    FetchAsset request{at(message, "requestId").get<std::uint32_t>(), uri.get<std::string>()};
    if (request.uri.size() > kUriMax) return unexpected(Fault::too_many);
    return Request(std::move(request));
}

std::string asset_answer(std::uint32_t request, std::uint8_t status, std::string_view message) {
    std::string bytes;
    ByteWriter writer(bytes);
    writer.put(kAssetOpcode);
    writer.put(request);
    writer.put(status);
    writer.put(static_cast<std::uint32_t>(message.size()));
    bytes += message;
    return bytes;
}

}  // namespace

std::string server_info_text(const ServerInfo& info) {
    return text_of({{"op", "serverInfo"},
                    {"name", info.name},
                    {"capabilities", info.capabilities},
                    {"supportedEncodings", info.encodings},
                    {"metadata", info.metadata},
                    {"sessionId", info.session}});
}

std::string advertise_text(std::span<const ChannelInfo> channels) {
    Json list = Json::array();
    for (const ChannelInfo& channel : channels)
        list.push_back({{"id", channel.id},
                        {"topic", channel.topic},
                        {"encoding", channel.encoding},
                        {"schemaName", channel.schema_name},
                        {"schema", channel.schema},
                        {"schemaEncoding", channel.schema_encoding}});
    return text_of({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string unadvertise_text(std::span<const std::uint32_t> channels) {
    return text_of({{"op", "unadvertise"}, {"channelIds", channels}});
}

std::string advertise_services_text(std::span<const ServiceInfo> services) {
    Json list = Json::array();
    for (const ServiceInfo& service : services)
        list.push_back({{"id", service.id},
                        {"name", service.name},
                        {"type", service.type},
                        {"request", service_schema(service.type + "_Request")},
                        {"response", service_schema(service.type + "_Response")}});
    return text_of({{"op", "advertiseServices"}, {"services", std::move(list)}});
}

std::string status_text(Level level, const std::string& id, const std::string& message) {
    return text_of({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}, {"id", id}});
}

std::string remove_status_text(const std::string& id) {
    return text_of({{"op", "removeStatus"}, {"statusIds", Json::array({id})}});
}

std::string call_failure_text(std::uint32_t service, std::uint32_t call, const std::string& message) {
    return text_of(
        {{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", message}});
}

std::string message_head(std::uint32_t subscription, WallTime time) {
    std::string bytes;
    ByteWriter writer(bytes);
    writer.put(kMessageOpcode);
    writer.put(subscription);
    writer.put(static_cast<std::uint64_t>(time.ns));
    return bytes;
}

std::string response_head(std::uint32_t service, std::uint32_t call, std::string_view encoding) {
    std::string bytes;
    ByteWriter writer(bytes);
    writer.put(kResponseOpcode);
    writer.put(service);
    writer.put(call);
    writer.put(static_cast<std::uint32_t>(encoding.size()));
    bytes += encoding;
    return bytes;
}

std::string asset_head(std::uint32_t request) {
    constexpr std::uint8_t kSuccess = 0;
    return asset_answer(request, kSuccess, {});
}

std::string asset_failure(std::uint32_t request, std::string_view message) {
    constexpr std::uint8_t kError = 1;
    return asset_answer(request, kError, message);
}

std::string_view name_of(Fault fault) noexcept {
    switch (fault) {
        case Fault::no_json:
            return "no JSON";
        case Fault::no_operation:
            return "no 'op'";
        case Fault::bad_member:
            return "a list or an identifier is missing or has another type";
        case Fault::too_many:
            return "more than 1024 entries, or a URI of more than 2048 bytes";
        case Fault::truncated:
            return "a length is beyond the end";
        case Fault::bad_opcode:
            return "an unknown opcode";
    }
    return "";
}

Result<Request, Fault> parse_text(std::string_view text) {
    if (is_nested_too_deep(text)) return unexpected(Fault::no_json);
    const Json message = Json::parse(text, nullptr, false);
    if (message.is_discarded()) return unexpected(Fault::no_json);
    const Json& op = at(message, "op");
    if (!op.is_string()) return unexpected(Fault::no_operation);
    const auto operation = op.get<std::string>();
    if (operation == "subscribe") return subscribe_of(at(message, "subscriptions"));
    if (operation == "unsubscribe") return unsubscribe_of(at(message, "subscriptionIds"));
    if (operation == "fetchAsset") return fetch_of(message);
    constexpr std::size_t kShownMax = 64;
    return Request(Unsupported{operation.substr(0, kShownMax)});
}

Result<Request, Fault> parse_binary(std::string_view bytes) {
    ByteReader reader(bytes);
    const auto opcode = reader.get<std::uint8_t>();
    if (!reader.is_sound()) return unexpected(Fault::truncated);
    if (opcode == kClientMessageOpcode) return Request(Unsupported{"message"});
    if (opcode != kCallOpcode) return unexpected(Fault::bad_opcode);
    ServiceCall call;
    call.service = reader.get<std::uint32_t>();
    call.call = reader.get<std::uint32_t>();
    const auto length = reader.get<std::uint32_t>();
    constexpr std::size_t kHeadBytes = 1 + 3 * sizeof(std::uint32_t);
    if (!reader.is_sound() || length > bytes.size() - kHeadBytes) return unexpected(Fault::truncated);
    call.encoding = bytes.substr(kHeadBytes, length);
    call.payload = bytes.substr(kHeadBytes + length);
    return Request(std::move(call));
}

}  // namespace octoskin::foxglove
