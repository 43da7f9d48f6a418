#include "firmware/app/linux_node/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cstdio>

#include "common/wire/interface_name.hpp"

namespace octoskin::linux_node {
namespace {

using linux_port::ExitCode;
using linux_port::LineName;

constexpr const char* kAbout =
    "A sensor node on a Linux board: VL53L1X on its I2C buses to a CAN interface.\n"
    "Wiring, permissions and the first start: docs/hardware/linux-node.md.";
constexpr const char* kFooter =
    "SIGTERM, SIGINT: puts all sensors into reset, releases all lines, ends.\n"
    "Waits for a CAN interface that is down or gone.\n"
    "Exit codes: 0 ended by a signal; 64 command line; 66 no such file; 69 a device is missing or in use;\n"
    "70 a defect of octoskin-node; 77 no permission; 78 the configuration block.";

/// Appends the lines of `texts` to `lines`. Returns the error; empty if there is none.
std::string add_lines(const std::vector<std::string>& texts, std::vector<LineName>& lines) {
    for (const std::string& text : texts) {
        const auto parsed = linux_port::parse_lines(text);
        if (!parsed) return "'" + text + "': expected CHIP:LINE,LINE..., such as gpiochip0:17,27";
        for (const LineName& line : *parsed) {
            if (std::find(lines.begin(), lines.end(), line) != lines.end())
                return linux_port::text(line) + ": named twice";
            lines.push_back(line);
        }
    }
    return {};
}

std::optional<Uid> parse_uid(const std::string& text) {
    Uid uid{};
    if (text.size() != 2 * uid.size()) return std::nullopt;
    for (std::size_t i = 0; i < uid.size(); ++i) {
        const char* const digits = text.data() + 2 * i;
        const auto [end, error] = std::from_chars(digits, digits + 2, uid.at(i), 16);
        if (error != std::errc{} || end != digits + 2) return std::nullopt;
    }
    return uid;
}

struct Texts {
    std::vector<std::string> xshut;
    std::vector<std::string> data_ready;
    std::string uid;
    std::uint32_t i2c_lateness_ms = 20;
};

void declare(CLI::App& app, Arguments& arguments, Texts& texts) {
    app.add_option("--config", arguments.config,
                   "The node's configuration block: `octoskin rig RIG --node NAME --block FILE` writes it")
        ->required()
        ->type_name("FILE");
    app.add_option("--can", arguments.can, "CAN interface; the program does not bring it up")
        ->type_name("INTERFACE")
        ->capture_default_str();
    app.add_option("--i2c", arguments.i2c,
                   "Device of each I2C bus, in the order of the rig's `bus`: /dev/i2c-1 /dev/i2c-3")
        ->required()
        ->type_name("DEVICE")
        ->expected(1, static_cast<int>(kNodeBusesMax));
    app.add_option(
           "--xshut", texts.xshut,
           "XSHUT outputs, in the order of the rig's `xshut_line`: gpiochip0:17,27,22; several chips: "
           "one value after the other")
        ->required()
        ->type_name("CHIP:LINES");
    app.add_option("--data-ready", texts.data_ready,
                   "Data-ready input of each bus, in the order of the rig's `bus`: gpiochip0:23,24")
        ->type_name("CHIP:LINES");
    app.add_option(
           "--i2c-lateness-ms", texts.i2c_lateness_ms,
           "A transfer is given up after three times its time on the wire plus this time, for a thread that "
           "the machine runs late")
        ->check(CLI::Range(1, 1'000))
        ->capture_default_str();
    app.add_option("--uid", texts.uid, "24 hexadecimal digits, instead of a unique id from /etc/machine-id")
        ->type_name("DIGITS");
}

/// Parses `texts` into `arguments`. Returns the error; empty if there is none.
std::string take_texts(const Texts& texts, Arguments& arguments) {
    if (const auto why = add_lines(texts.xshut, arguments.xshut); !why.empty()) return "--xshut " + why;
    if (const auto why = add_lines(texts.data_ready, arguments.data_ready); !why.empty())
        return "--data-ready " + why;
    if (!wire::is_interface_name(arguments.can))
        return "--can '" + arguments.can + "': " + std::string(wire::kInterfaceNameRule);
    arguments.i2c_lateness = Microseconds{std::int64_t{texts.i2c_lateness_ms} * 1'000};
    if (!texts.uid.empty() && !(arguments.uid = parse_uid(texts.uid)))
        return "--uid '" + texts.uid + "': expected 24 hexadecimal digits";
    return {};
}

}  // namespace

std::variant<Arguments, ExitCode> parse_arguments(int argc, const char* const* argv, std::uint32_t build_id) {
    Arguments arguments;
    Texts texts;
    CLI::App app{kAbout, "octoskin-node"};
    app.footer(kFooter);
    std::array<char, 40> version{};
    (void)std::snprintf(version.data(), version.size(), "octoskin-node (build %08x)", build_id);
    app.set_version_flag("--version", version.data());
    declare(app, arguments, texts);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? ExitCode::ok : ExitCode::usage;
    }
    if (const std::string why = take_texts(texts, arguments); !why.empty()) {
        (void)std::fprintf(stderr, "octoskin-node: %s\n", why.c_str());
        return ExitCode::usage;
    }
    return arguments;
}

}  // namespace octoskin::linux_node
