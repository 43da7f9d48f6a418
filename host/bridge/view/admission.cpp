#include "host/bridge/view/admission.hpp"

#include <algorithm>
#include <utility>

#include "host/bridge/view/foxglove.hpp"

namespace octoskin::view {
namespace {

constexpr std::uint16_t kHttpPort = 80;

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::string lowered(std::string_view text) {
    std::string out(text);
    std::ranges::transform(out, out.begin(), lower);
    return out;
}

bool has(const std::vector<std::string>& list, const std::string& text) {
    return std::ranges::find(list, text) != list.end();
}

/// An IPv6 address has brackets in a URL.
std::string in_url(const std::string& host) {
    return host.find(':') != std::string::npos && !host.starts_with('[') ? '[' + host + ']' : host;
}

bool is_scheme_char(char c) {
    return (lower(c) >= 'a' && lower(c) <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
}

}  // namespace

Admission::Admission(std::string host, std::uint16_t port, std::vector<std::string> origins) {
    std::vector<std::string> names = {"localhost", "127.0.0.1", "[::1]"};
    host = in_url(lowered(host));
    if (!has(names, host)) names.push_back(std::move(host));
    for (const std::string& name : names) {
        hosts_.push_back(name + ':' + std::to_string(port));
        if (port == kHttpPort) hosts_.push_back(name);
    }
    for (const std::string& one : hosts_) origins_.push_back("http://" + one);
    for (const std::string& one : origins) origins_.push_back(lowered(one));
}

bool Admission::takes_host(std::string_view host) const {
    return has(hosts_, lowered(host));
}

bool Admission::takes_origin(std::optional<std::string_view> origin) const {
    return !origin || (*origin != "null" && has(origins_, lowered(*origin)));
}

std::optional<std::string> Admission::subprotocol(std::string_view offered) {
    while (!offered.empty()) {
        const std::size_t comma = std::min(offered.find(','), offered.size());
        std::string_view one = offered.substr(0, comma);
        offered.remove_prefix(std::min(comma + 1, offered.size()));
        while (!one.empty() && (one.front() == ' ' || one.front() == '\t')) one.remove_prefix(1);
        while (!one.empty() && (one.back() == ' ' || one.back() == '\t')) one.remove_suffix(1);
        if (std::ranges::find(foxglove::kSubprotocols, one) != foxglove::kSubprotocols.end())
            return std::string(one);
    }
    return std::nullopt;
}

bool is_origin(std::string_view text) {
    const std::size_t colon = text.find("://");
    if (colon == 0 || colon == std::string_view::npos) return false;
    const std::string_view host = text.substr(colon + 3);
    const bool has_other = std::ranges::any_of(
        host, [](char c) { return c <= ' ' || c > '~' || c == '/' || c == ',' || c == '*'; });
    const bool is_file = host.empty() && text == "file://";
    return std::ranges::all_of(text.substr(0, colon), is_scheme_char) && !has_other &&
           (!host.empty() || is_file);
}

}  // namespace octoskin::view
