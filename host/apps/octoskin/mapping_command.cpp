// octoskin mapping: what a mapping configuration says, in full.
#include <fmt/format.h>

#include <memory>

#include "host/apps/octoskin/commands.hpp"
#include "host/io/mapping/mapping_file.hpp"

namespace octoskin::app {

void add_mapping_command(CLI::App& app) {
    auto name = std::make_shared<std::string>("robust");
    CLI::App* command = app.add_subcommand("mapping", "Check a mapping configuration and print it in full");
    command->add_option("configuration", *name, "paper, robust, or a YAML file")->capture_default_str();
    command->callback([name] {
        const auto mapping = read_mapping(*name);
        if (!mapping) throw CommandFailure({ExitCode::bad_config, mapping.error().message()});
        fmt::print("{}", mapping_text(*mapping));
    });
}

}  // namespace octoskin::app
