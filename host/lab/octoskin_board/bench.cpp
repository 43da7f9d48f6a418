#include "host/lab/octoskin_board/bench.hpp"
#include "host/apps/recording/permission.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "hw/rigfile/rig.hpp"
#include "hw/sim/experiment/board_parts.hpp"

namespace octoskin::board {
namespace {

using sim::stm32::BoardTime;
using sim::stm32::ElfImage;
using sim::stm32::kPsPerUs;
using sim::stm32::NucleoBoard;
using sim::stm32::NucleoOptions;

Result<NodeConfig, AppError> read_block(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
    const auto config = decode_node_config(bytes);
    if (!config) {
        return fail(ExitCode::bad_data,
                    in_file({ErrorCode::damaged, fmt::format("not a configuration block (error {})",
                                                             static_cast<int>(config.error()))},
                            file));
    }
    return *config;
}

Result<NodeConfig, AppError> config_of_rig(const std::filesystem::path& file, const std::string& wanted) {
    const auto rig = rig::read_rig(file);
    if (!rig) return unexpected(reading_error(ExitCode::bad_config, rig.error()));
    for (const rig::Node& node : rig->nodes) {
        if (wanted.empty() || node.name == wanted || std::to_string(node.config.node_id) == wanted)
            return node.config;
    }
    return fail(ExitCode::bad_config, {.code = ErrorCode::unknown_name,
                                       .what = "expected the name or number of a node of the rig",
                                       .value = "'" + wanted + "'",
                                       .file = file,
                                       .key = "--node"});
}

Result<NodeConfig, AppError> read_config(const Arguments& arguments) {
    if (!arguments.config.empty()) return read_block(arguments.config);
    if (!arguments.rig.empty()) return config_of_rig(arguments.rig, arguments.node);
    return fail(ExitCode::usage,
                {ErrorCode::bad_argument, "a configuration is needed", {}, "give --config or --rig"});
}

NucleoOptions options_of(const Arguments& arguments, const NodeConfig& config, const sim::BoardParts& parts) {
    NucleoOptions options;
    options.crystal.is_present = arguments.has_crystal;
    if (arguments.crystal_fails_s >= 0.0) {
        options.crystal.fails_at =
            BoardTime{static_cast<std::int64_t>(arguments.crystal_fails_s * 1e6) * kPsPerUs};
    }
    options.drift_ppm = arguments.drift_ppm;
    options.lsi_hz = arguments.lsi_hz;
    options.cycles_per_instruction = arguments.cycles_per_instruction;
    options.edges = arguments.has_slow_edges ? sim::stm32::BusEdges::slowest : sim::stm32::BusEdges::typical;
    options.bit_rates = {config.nominal_bitrate, config.data_bitrate};
    options.unique_id = parts.unique_id;
    options.seed = arguments.seed;
    return options;
}

}  // namespace

Result<std::unique_ptr<Bench>, AppError> Bench::build(const Arguments& arguments,
                                                      const SceneOfSensor& scene) {
    const auto config = read_config(arguments);
    if (!config) return unexpected(config.error());
    const auto image = ElfImage::load(arguments.elf);
    if (!image) return unexpected(reading_error(arguments.elf, {ExitCode::bad_data, image.error()}));
    sim::PartsReel reel{.seed = arguments.seed, .slow_clocks = arguments.slow_clocks};
    for (const std::string& text : arguments.sensor_traits) {
        if (auto traits = sim::parse_traits(text)) reel.traits.push_back(std::move(*traits));
    }
    const sim::BoardParts parts = sim::draw_board_parts(reel, *config);
    auto bench = std::make_unique<Bench>();
    bench->config_ = *config;
    std::array<std::uint8_t, kNodeConfigBytesMax> block{};
    try {
        bench->board_ = std::make_unique<NucleoBoard>(options_of(arguments, *config, parts), *image,
                                                      encode(*config, block));
    } catch (const std::runtime_error& error) {
        return fail(ExitCode::bad_data, in_file({ErrorCode::damaged, error.what()}, arguments.elf));
    }
    bench->sensors_ =
        std::make_unique<sim::stm32::SensorCarrier>(*bench->board_, *config, parts.sensors, scene);
    for (const std::string& text : arguments.i2c_faults) {
        const BusFault parsed = parse_i2c_fault(text);
        bench->board_->wire(parsed.bus).inject(parsed.fault);
    }
    if (arguments.is_alone_on_bus) bench->board_->can().set_link(sim::stm32::CanLink::unacknowledged);
    return bench;
}

Bench::SceneOfSensor wall_at(std::vector<double> range_m) {
    return [range_m = std::move(range_m)](std::uint8_t sensor) -> sim::RangingScene {
        const double range = range_m.at(sensor % range_m.size());
        return [range](std::uint32_t, sim::SimTime, const Roi&) {
            return sim::RangingReturn{
                .range_m = range, .sigma_m = 0.002, .peak_signal_mcps = 20.0, .ambient_mcps = 0.2};
        };
    };
}

std::string violation_report(NucleoBoard& board) {
    std::string text;
    for (const auto& violation : board.log().all()) {
        text += fmt::format("violation {}: {} (at {}, {:.6f} s, {} times)\n", name_of(violation.rule),
                            violation.what, board.image().place(violation.pc),
                            static_cast<double>(violation.time.ps) * 1e-12, violation.count);
    }
    return text;
}

std::string use_report(Bench& bench, double cpu_s) {
    NucleoBoard& board = bench.board();
    const double seconds = static_cast<double>(board.now().us) * 1e-6;
    const auto& core = board.core();
    std::string text = fmt::format(
        "{:.3f} s simulated in {:.3f} s of CPU time ({:.1f} times real time); {:.1f} million instructions, "
        "the core "
        "{:.1f} % "
        "busy; {} resets; lowest stack 0x{:08X}; violations {}\n",
        seconds, cpu_s, seconds / cpu_s, static_cast<double>(core.instructions()) * 1e-6,
        static_cast<double>(core.cycles()) / (160e4 * seconds), board.reset_count(), core.lowest_stack(),
        board.log().count());
    for (std::size_t bus = 0; bus < NucleoBoard::kI2cBuses; ++bus) {
        text += fmt::format("I2C{}: {} transfers, {} refused, {:.1f} % busy\n", bus + 1,
                            board.wire(bus).transfer_count(), board.wire(bus).refused_count(),
                            static_cast<double>(board.i2c_busy_ps(bus)) * 1e-10 / seconds);
    }
    return text;
}

}  // namespace octoskin::board
