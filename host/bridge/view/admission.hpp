// Which clients the view takes: by the headers of their handshake.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octoskin::view {

/// Why a connection is refused or ended.
enum class Refusal : std::uint8_t {
    host,         ///< the header Host names another machine: a foreign name that leads here (DNS rebinding)
    origin,       ///< a page of another origin
    subprotocol,  ///< none of Foxglove's
    too_many,     ///< all places are taken
    silent,       ///< no whole request in time, or no answer to pings
    malformed,    ///< no HTTP, no WebSocket frame or no message of the protocol
    too_large,    ///< headers or a message over the limit
    stalled,      ///< answers wait for it beyond the limit of memory
};
inline constexpr std::array<std::string_view, 8> kRefusalNames = {
    "host", "origin", "subprotocol", "too_many", "silent", "malformed", "too_large", "stalled"};
[[nodiscard]] constexpr std::string_view name_of(Refusal refusal) noexcept {
    return kRefusalNames[static_cast<std::size_t>(refusal)];
}

class Admission {
  public:
    /// `host`: of the server, beside the names of this machine. `origins`: further ones, as
    /// "https://app.foxglove.dev".
    Admission(std::string host, std::uint16_t port, std::vector<std::string> origins);

    /// The value of the header Host: a name of this machine with the server's port. The port may be left out
    /// if it is 80.
    [[nodiscard]] bool takes_host(std::string_view host) const;
    /// The value of the header Origin: absent (a client that is no page), the server's own page, or one of
    /// `origins`. Never "null", which any page can have.
    [[nodiscard]] bool takes_origin(std::optional<std::string_view> origin) const;
    /// The first of the client's list that the server has, from the header Sec-WebSocket-Protocol.
    [[nodiscard]] static std::optional<std::string> subprotocol(std::string_view offered);

  private:
    std::vector<std::string> hosts_;    ///< lower case, with the port
    std::vector<std::string> origins_;  ///< lower case
};

/// Whether a text can be the value of a header Origin: a scheme and a host, without a path.
[[nodiscard]] bool is_origin(std::string_view text);

}  // namespace octoskin::view
