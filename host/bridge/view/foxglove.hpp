// Foxglove's WebSocket protocol as texts and bytes. Its two subprotocols are identical on the wire.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"

namespace octoskin::foxglove {

inline constexpr std::array<std::string_view, 2> kSubprotocols = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
/// Subscriptions, or identifiers to unsubscribe, in one request.
inline constexpr std::size_t kListMax = 1024;

struct ServerInfo {
    std::string name;
    std::vector<std::string> capabilities = {};
    std::vector<std::string> encodings = {};           ///< of service calls
    std::map<std::string, std::string> metadata = {};  ///< shown by clients as it is
    std::string session;                               ///< another one: identifiers have another meaning
};
struct ChannelInfo {
    std::uint32_t id = 0;
    std::string topic;
    std::string encoding;
    std::string schema_name;
    std::string schema_encoding = {};
    std::string schema = {};
};
struct ServiceInfo {
    std::uint32_t id = 0;
    std::string name;
    std::string type;
};
enum class Level : std::uint8_t { info, warning, error };

[[nodiscard]] std::string server_info_text(const ServerInfo& info);
[[nodiscard]] std::string advertise_text(std::span<const ChannelInfo> channels);
[[nodiscard]] std::string unadvertise_text(std::span<const std::uint32_t> channels);
/// Requests and responses are JSON objects.
[[nodiscard]] std::string advertise_services_text(std::span<const ServiceInfo> services);
/// A client shows the newest message of each `id`.
[[nodiscard]] std::string status_text(Level level, const std::string& id, const std::string& message);
[[nodiscard]] std::string remove_status_text(const std::string& id);
[[nodiscard]] std::string call_failure_text(std::uint32_t service, std::uint32_t call,
                                            const std::string& message);
/// The 13 bytes before the payload of a message.
[[nodiscard]] std::string message_head(std::uint32_t subscription, WallTime time);
/// The bytes before the file of an answer to FetchAsset.
[[nodiscard]] std::string asset_head(std::uint32_t request);
/// The whole answer.
[[nodiscard]] std::string asset_failure(std::uint32_t request, std::string_view message);
/// The bytes before the payload of an answer to a call.
[[nodiscard]] std::string response_head(std::uint32_t service, std::uint32_t call, std::string_view encoding);

struct Subscription {
    std::uint32_t id = 0;  ///< chosen by the client
    std::uint32_t channel = 0;
    friend bool operator==(const Subscription&, const Subscription&) = default;
};
struct Subscribe {
    std::vector<Subscription> subscriptions;
};
struct Unsubscribe {
    std::vector<std::uint32_t> subscriptions;
};
struct ServiceCall {
    std::uint32_t service = 0;
    std::uint32_t call = 0;
    std::string encoding;
    std::string payload;
};
/// Asks for a file, as a mesh of the robot.
struct FetchAsset {
    std::uint32_t request = 0;  ///< chosen by the client
    std::string uri;            ///< at most kUriMax bytes
};
inline constexpr std::size_t kUriMax = 2048;
/// An operation of the protocol that this server does not have.
struct Unsupported {
    std::string operation;  ///< at most 64 bytes
};
using Request = std::variant<Subscribe, Unsubscribe, ServiceCall, FetchAsset, Unsupported>;

enum class Fault : std::uint8_t {
    no_json,       ///< the text is not JSON, or nests too deep
    no_operation,  ///< the JSON is no object with a text `op`
    bad_member,    ///< a list or an identifier is missing or has another type
    too_many,      ///< over kListMax, or a URI over kUriMax
    truncated,     ///< a length is beyond the message's end
    bad_opcode,    ///< the first byte is no operation
};
[[nodiscard]] std::string_view name_of(Fault fault) noexcept;

/// Safe for any bytes. Throws std::bad_alloc.
[[nodiscard]] Result<Request, Fault> parse_text(std::string_view text);
[[nodiscard]] Result<Request, Fault> parse_binary(std::string_view bytes);

}  // namespace octoskin::foxglove
