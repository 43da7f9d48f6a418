#include "firmware/app/linux_node/configuration.hpp"

#include <bit>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

namespace octoskin::linux_node {
namespace {

using linux_port::ExitCode;
using linux_port::refuse;
using linux_port::StartFailure;

const char* words(NodeConfigError error) {
    switch (error) {
        case NodeConfigError::truncated:
            return "truncated";
        case NodeConfigError::wrong_magic:
            return "no configuration block (`octoskin rig RIG --node NAME --block FILE` writes one)";
        case NodeConfigError::wrong_length:
            return "of impossible length";
        case NodeConfigError::wrong_crc:
            return "damaged: its checksum is wrong";
        case NodeConfigError::wrong_version:
            return "of another version of octoskin";
        case NodeConfigError::invalid_field:
            return "complete, but a field has an impossible value";
    }
    return "?";
}

Result<NodeConfig, StartFailure> read_block(const std::filesystem::path& file) {
    // Opening a pipe would block until its other end is opened, and reading a device may never end.
    std::error_code error;
    const auto kind = std::filesystem::status(file, error);
    if (std::filesystem::exists(kind) && !std::filesystem::is_regular_file(kind))
        return refuse(ExitCode::no_input, file.string() + ": is not an ordinary file");
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return refuse(ExitCode::no_input, file.string() + ": cannot be read");
    // One byte over the largest block: a longer file is refused.
    std::vector<std::uint8_t> bytes(kNodeConfigBytesMax + 1);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(stream.gcount()));
    const auto config = decode_node_config(bytes);
    if (!config) return refuse(ExitCode::bad_config, file.string() + ": " + words(config.error()));
    if (config->board_type != kBoardType) {
        return refuse(ExitCode::bad_config,
                      file.string() + ": for boards of type " + std::to_string(config->board_type) +
                          ", but a Linux board is of type " + std::to_string(kBoardType) +
                          " (set board: ../boards/linux_board.yaml in the rig)");
    }
    return *config;
}

/// Device that the block needs and the command line does not name; empty if there is none.
std::string lacking(const NodeConfig& config, const Arguments& arguments) {
    for (std::size_t i = 0; i < config.sensor_count; ++i) {
        const SensorConfig& sensor = config.sensors.at(i);
        const std::string which = "sensor " + std::to_string(i) + " is on ";
        if (sensor.bus >= arguments.i2c.size())
            return which + "bus " + std::to_string(sensor.bus) + ", but --i2c names " +
                   std::to_string(arguments.i2c.size());
        if (sensor.xshut_line >= arguments.xshut.size())
            return which + "xshut_line " + std::to_string(sensor.xshut_line) + ", but --xshut names " +
                   std::to_string(arguments.xshut.size());
    }
    const auto data_ready = static_cast<std::size_t>(std::bit_width(config.data_ready_buses));
    if (data_ready > arguments.data_ready.size())
        return "bus " + std::to_string(data_ready - 1) + " has a data-ready line, but --data-ready names " +
               std::to_string(arguments.data_ready.size());
    return {};
}

}  // namespace

Result<NodeConfig, StartFailure> load_configuration(const Arguments& arguments) {
    auto config = read_block(arguments.config);
    if (!config) return config;
    if (const std::string lack = lacking(*config, arguments); !lack.empty())
        return refuse(ExitCode::bad_config, arguments.config.string() + ": " + lack);
    return config;
}

}  // namespace octoskin::linux_node
