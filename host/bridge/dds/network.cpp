#include "host/bridge/dds/network.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <vector>

namespace octoskin::dds {
namespace {

/// Ports of a higher one would be beyond 65535.
constexpr std::uint32_t kDomainMax = 232;

Error wrong(const char* name, const std::string& value, std::string rule) {
    return {.code = ErrorCode::bad_argument,
            .what = std::move(rule),
            .value = "'" + value + "'",
            .key = std::string("environment variable ") + name};
}

Result<std::uint32_t, Error> domain_of(const Environment& environment) {
    const auto text = environment("ROS_DOMAIN_ID");
    if (!text || text->empty()) return 0U;
    std::uint32_t domain = 0;
    const char* const end = text->data() + text->size();
    const auto parsed = std::from_chars(text->data(), end, domain);
    if (parsed.ec != std::errc{} || parsed.ptr != end || domain > kDomainMax)
        return unexpected(
            wrong("ROS_DOMAIN_ID", *text, fmt::format("expected a number from 0 to {}", kDomainMax)));
    return domain;
}

enum class Range : std::uint8_t { system_default, off, localhost, subnet };

Result<Range, Error> range_of(const Environment& environment) {
    const auto text = environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
    if (text && !text->empty()) {
        if (*text == "SUBNET") return Range::subnet;
        if (*text == "LOCALHOST") return Range::localhost;
        if (*text == "OFF") return Range::off;
        if (*text == "SYSTEM_DEFAULT") return Range::system_default;
        return unexpected(wrong("ROS_AUTOMATIC_DISCOVERY_RANGE", *text,
                                "expected SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT"));
    }
    const auto local = environment("ROS_LOCALHOST_ONLY");
    return local && *local == "1" ? Range::localhost : Range::subnet;
}

/// Separated by semicolons. Only characters of addresses and host names go into the XML.
Result<std::vector<std::string>, Error> peers_of(const Environment& environment) {
    std::vector<std::string> peers;
    const auto text = environment("ROS_STATIC_PEERS");
    if (!text) return peers;
    constexpr auto kCharacters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.:_-[]";
    std::size_t begin = 0;
    while (begin <= text->size()) {
        const std::size_t end = std::min(text->find(';', begin), text->size());
        std::string peer = text->substr(begin, end - begin);
        if (peer.find_first_not_of(kCharacters) != std::string::npos)
            return unexpected(
                wrong("ROS_STATIC_PEERS", peer, "expected host names or addresses, separated by ';'"));
        if (!peer.empty()) peers.push_back(std::move(peer));
        begin = end + 1;
    }
    return peers;
}

/// Fragments as large as Cyclone DDS's datagrams: of a map of 1 MiB a reader then asks for all that it lacks
/// at once. In fragments of 1344 bytes, the default, they are too many for one request.
constexpr const char* kFragments = "<FragmentSize>14000B</FragmentSize>";

/// A socket buffer for an image of 640 x 480, as far as net.core.rmem_max admits. Heartbeats: a map may be
/// more than a reader's socket buffer holds, and the reader asks for what it lost once it hears of it. By
/// default it may hear only after 100 ms, when the next map replaces this one.
constexpr const char* kInternal =
    R"(<Internal><SocketReceiveBufferSize min="default" max="4MB"/>)"
    R"(<HeartbeatInterval min="5ms" minsched="10ms" max="8s">20ms</HeartbeatInterval></Internal>)";

/// A node that is found by its ports only needs a participant with a known port.
std::string discovery(const std::vector<std::string>& peers) {
    if (peers.empty()) return {};
    std::string xml =
        "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>119</MaxAutoParticipantIndex><Peers>";
    for (const std::string& peer : peers) xml += "<Peer address=\"" + peer + "\"/>";
    return xml + "</Peers></Discovery>";
}

std::string configuration(const std::string& general, const std::vector<std::string>& peers) {
    return "<CycloneDDS><Domain id=\"any\"><General>" + general + kFragments + "</General>" +
           discovery(peers) + kInternal + "</Domain></CycloneDDS>";
}

}  // namespace

std::optional<std::string> process_environment(const char* name) {
    const char* const value = std::getenv(name);
    return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

Result<Network, Error> network_of(const Environment& environment, bool this_machine_only) {
    const auto domain = domain_of(environment);
    if (!domain) return unexpected(domain.error());
    Network network{
        .domain = *domain, .configuration = {}, .is_local_only = this_machine_only, .description = {}};
    const auto described = [&network](const std::string& what) {
        network.description = fmt::format("domain {}, {}", network.domain, what);
        return network;
    };
    if (this_machine_only) {
        network.configuration = configuration("<MulticastTimeToLive>0</MulticastTimeToLive>", {});
        return described("this machine only");
    }
    if (const auto uri = environment("CYCLONEDDS_URI"); uri && !uri->empty())
        return described("network as in CYCLONEDDS_URI");
    const auto range = range_of(environment);
    if (!range) return unexpected(range.error());
    auto peers = peers_of(environment);
    if (!peers) return unexpected(peers.error());
    const std::string with_peers = peers->empty() ? "" : " and ROS_STATIC_PEERS";
    switch (*range) {
        case Range::system_default:
            return described("Cyclone DDS's own settings");
        case Range::off:
            network.configuration = configuration("<AllowMulticast>false</AllowMulticast>", *peers);
            return described("discovery off" + with_peers);
        case Range::localhost:
            peers->insert(peers->begin(), "localhost");
            network.configuration = configuration(
                "<Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
                "<AllowMulticast>false</AllowMulticast>",
                *peers);
            return described("loopback only" + with_peers);
        case Range::subnet:
            network.configuration = configuration("", *peers);
            return described("this subnet" + with_peers);
    }
    return described("this subnet");
}

}  // namespace octoskin::dds
