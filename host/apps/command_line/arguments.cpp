#include "host/apps/command_line/arguments.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>

#include "common/wire/interface_name.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "hw/rigfile/file_kind.hpp"
#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/key_hint.hpp"

namespace octoskin::app {
namespace {

std::string absolute(const std::string& path) {
    std::error_code error;
    const auto whole = std::filesystem::absolute(path, error);
    return error ? path : whole.lexically_normal().string();
}

void check_readable(const std::string& path) {
    if (const auto refused = refused_to_read(absolute(path))) throw CommandFailure(*refused);
}

std::string is_seed(std::string& text) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, value);
    if (parsed.ec == std::errc{} && parsed.ptr == end) return {};
    return "expected a whole number from 0 to 2^64 - 1, found '" + text + "'";
}

void check_interface_name(const std::string& interface) {
    // A recording's log repeats the name on each line.
    if (wire::is_interface_name(interface)) return;
    throw CommandFailure(ExitCode::usage,
                         {ErrorCode::bad_name, std::string(wire::kInterfaceNameRule), "'" + interface + "'"});
}

void check_frame_socket(const std::string& interface, int descriptor) {
    int type = 0;
    socklen_t size = sizeof(type);
    if (::getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) != 0) {
        throw CommandFailure(ExitCode::usage,
                             {.code = ErrorCode::wrong_kind_of_file,
                              .what = "is not a socket",
                              .remedy = "give one that carries frames as a raw CAN socket does",
                              .file = interface});
    }
    if (type == SOCK_STREAM) {
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::wrong_kind_of_file,
                                               .what = "is a stream socket, which does not keep frames apart",
                                               .remedy = "give a datagram socket (SOCK_SEQPACKET)",
                                               .file = interface});
    }
}

}  // namespace

CLI::Validator existing_file() {
    return {[](std::string& path) -> std::string {
                check_readable(path);
                std::error_code error;
                if (std::filesystem::is_directory(path, error))
                    throw CommandFailure(
                        ExitCode::usage,
                        in_file({ErrorCode::wrong_kind_of_file, "is a directory, not a file"}, path));
                if (const auto kind = rig::other_than_a_file(path); !kind.empty()) {
                    throw CommandFailure(ExitCode::no_input,
                                         {.code = ErrorCode::wrong_kind_of_file,
                                          .what = "is " + std::string(kind),
                                          .remedy = "give a regular file: it is read more than once",
                                          .file = absolute(path)});
                }
                if (std::filesystem::exists(path, error)) return {};
                throw CommandFailure(ExitCode::no_input,
                                     in_file({ErrorCode::not_found, "no such file"}, absolute(path)));
            },
            "FILE"};
}

CLI::Validator existing_path() {
    return {[](std::string& path) -> std::string {
                check_readable(path);
                std::error_code error;
                if (std::filesystem::exists(path, error)) return {};
                throw CommandFailure(
                    ExitCode::no_input,
                    in_file({ErrorCode::not_found, "no such file or directory"}, absolute(path)));
            },
            "PATH"};
}

void add_package_paths(CLI::App& command, std::vector<PackagePath>& packages) {
    const auto add = [&packages](const std::string& text) {
        auto package = package_path_of(text);
        if (!package) throw CommandFailure(ExitCode::usage, package.error());
        packages.push_back(*std::move(package));
    };
    command
        .add_option_function<std::vector<std::string>>(
            "--package-path",
            [add](const std::vector<std::string>& texts) { std::ranges::for_each(texts, add); },
            "Folder of a ROS package that has meshes of the robot; may be given several times")
        ->type_name("NAME=DIR")
        ->allow_extra_args(false);
}

void add_robot_options(CLI::App& command, GivenRobot& robot, const std::string& robot_help) {
    command.add_option("--robot", robot.urdf, robot_help)->check(existing_file());
    add_package_paths(command, robot.packages);
}

CLI::Validator seed() {
    return {is_seed, "SEED"};
}

std::string configuration_help(const std::string& use) {
    return use + ": " + rig::joined(kBuiltInMappings) + ", or a YAML file";
}

bool wants_json_errors(int argc, const char* const* argv) noexcept {
    return argc > 1 && argv[1] == kJsonErrors;
}

void check_json_errors(int argc, const char* const* argv) {
    for (int i = 2; i < argc; ++i) {
        if (argv[i] != kJsonErrors) continue;
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                               .what = "expected once, as the first argument",
                                               .remedy = "put it before the command",
                                               .key = std::string(kJsonErrors)});
    }
}

std::string_view first_argument(int argc, const char* const* argv) noexcept {
    const int first = wants_json_errors(argc, argv) ? 2 : 1;
    return argc > first ? argv[first] : std::string_view();
}

void check_command_name(const CLI::App& app, const std::string& others, int argc, const char* const* argv) {
    const std::string word(first_argument(argc, argv));
    if (word.starts_with('-') || argc < (wants_json_errors(argc, argv) ? 3 : 2)) return;
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    if (std::find(names.begin(), names.end(), word) != names.end()) return;
    const auto near = rig::nearest_word(word, names);
    throw CommandFailure(ExitCode::usage, {ErrorCode::unknown_word, "expected a command", "'" + word + "'",
                                           (near ? "did you mean '" + *near + "'? The" : "the") +
                                               std::string(" commands are ") + rig::joined(names) +
                                               "; --help explains them" + others});
}

void check_option_names(const CLI::App& app, const std::string& program) {
    std::string command = program;
    std::vector<std::string> names;
    for (const CLI::App* at = &app; at != nullptr;) {
        for (const CLI::Option* option : at->get_options())
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        const auto chosen = at->get_subcommands();
        at = chosen.empty() ? nullptr : chosen.front();
        if (at != nullptr) command += " " + at->get_name();
        if (at != nullptr && at->get_prefix_command()) return;  // its words are another program's
    }
    for (const std::string& word : app.remaining(true)) {
        const std::string name = word.substr(0, word.find('='));
        if (!name.starts_with("--") || name.size() == 2) continue;
        if (std::ranges::find(names, name) != names.end()) continue;
        const auto near = rig::nearest_word(name, names);
        throw CommandFailure(
            ExitCode::usage,
            {ErrorCode::unknown_word, "expected an option of '" + command + "'", "'" + name + "'",
             (near ? "did you mean '" + *near + "'? " : "") + ("'" + command + " --help' lists them")});
    }
}

std::optional<int> descriptor_of(const std::string& interface) {
    constexpr std::string_view kPrefix = "fd:";
    check_interface_name(interface);
    if (!interface.starts_with(kPrefix)) return std::nullopt;
    int descriptor = -1;
    const char* const last = interface.data() + interface.size();
    const auto [end, error] = std::from_chars(interface.data() + kPrefix.size(), last, descriptor);
    if (error != std::errc{} || end != last)
        throw CommandFailure(ExitCode::usage,
                             {ErrorCode::bad_syntax, "expected fd: and the number of an open descriptor",
                              "'" + interface + "'"});
    if (descriptor < 0 || ::fcntl(descriptor, F_GETFD) < 0)
        throw CommandFailure(
            ExitCode::usage,
            in_file({ErrorCode::no_device, "no open descriptor has that number"}, interface));
    check_frame_socket(interface, descriptor);
    return descriptor;
}

socketcan::CanSocket open_can(const std::string& interface, const socketcan::SocketOptions& options) {
    if (const auto descriptor = descriptor_of(interface)) return {interface, *descriptor};
    auto socket = socketcan::CanSocket::open(interface, options);
    if (!socket)
        throw CommandFailure(ExitCode::unavailable,
                             in_file({ErrorCode::no_device, socket.error().what}, interface));
    return std::move(socket).value();
}

}  // namespace octoskin::app
