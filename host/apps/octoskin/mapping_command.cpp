// octoskin mapping: what a mapping configuration says, in full.
#include <fmt/format.h>

#include <memory>

#include "host/apps/choosing/named_mapping.hpp"
#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/io/mapping/mapping_file.hpp"

namespace octoskin::app {

void add_mapping_command(CLI::App& app) {
    auto name = std::make_shared<std::string>(kDefaultMapping);
    CLI::App* command = app.add_subcommand("mapping", "Check a mapping configuration and print it in full");
    command->add_option("configuration", *name, configuration_help("One of"))->capture_default_str();
    command->callback([name] {
        const auto configuration = named_mapping(*name);
        if (!configuration) throw CommandFailure(configuration.error());
        print_text(mapping_text(configuration->mapping));
    });
}

}  // namespace octoskin::app
