// Writes a DBC to standard output, for the shipped rigs or for the given nodes.
//     build/host-release/bin/write_dbc > hw/octoskin.dbc
//     build/host-release/bin/write_dbc 1:board 10:joints > bench.dbc
#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

#include "hw/dbc/dbc_text.hpp"

namespace {

using octoskin::dbc::Node;

constexpr int kUsageError = 64;  // sysexits' EX_USAGE
constexpr int kWriteError = 74;  // sysexits' EX_IOERR

std::optional<std::vector<Node>> nodes_from(int count, char** arguments) {
    std::vector<Node> nodes;
    for (int i = 0; i < count; ++i) {
        const auto node = octoskin::dbc::node_from_text(arguments[i]);
        if (!node || std::ranges::find(nodes, node->node_id, &Node::node_id) != nodes.end()) {
            std::fprintf(stderr, "write_dbc: '%s': expected ID:board or ID:joints, ids 1 to 62, each once\n",
                         arguments[i]);
            return std::nullopt;
        }
        nodes.push_back(*node);
    }
    return nodes;
}

}  // namespace

int main(int argc, char** argv) {
    const auto nodes = argc < 2 ? octoskin::dbc::shipped_nodes() : nodes_from(argc - 1, argv + 1);
    if (!nodes) {
        return kUsageError;
    }
    const std::string text = octoskin::dbc::dbc_text(*nodes);
    const bool is_written =
        std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
    return is_written ? 0 : kWriteError;
}
