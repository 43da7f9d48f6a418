// octoskin mapping: checks a mapping configuration and prints it in full.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <regex>
#include <string>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/profile/named_mapping.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/mapping/mapping_keys.hpp"

namespace octoskin::app {

namespace {

/// Each key with its unit, the accepted values and the default, and its meaning on the lines below.
std::string keys_text() {
    const std::regex link(R"(\[([^\]]*)\]\([^)]*\))");
    std::string text;
    for (const MappingKey& key : mapping_keys()) {
        std::string meaning = std::regex_replace(std::string(key.meaning), link, "$1");
        std::erase_if(meaning, [](char character) { return character == '`' || character == '*'; });
        text +=
            fmt::format("{}{}{}{}: {}; default {}\n", key.path, key.unit.empty() ? "" : " [", key.unit,
                        key.unit.empty() ? "" : "]", expected_text(key), value_text(key, denoised_mapping()));
        if (!meaning.empty()) text += fmt::format("    {}\n", meaning);
    }
    return text;
}

}  // namespace

void add_mapping_command(CLI::App& app) {
    auto name = std::make_shared<std::string>(kDefaultMapping);
    auto lists_keys = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand("mapping", "Check a mapping configuration and print it in full");
    command->add_option("configuration", *name, configuration_help("One of"))->capture_default_str();
    command->add_flag("--keys", *lists_keys, "List each key with its unit, range, default and meaning");
    command->callback([name, lists_keys] {
        if (*lists_keys) return print_text(keys_text());
        const auto configuration = named_mapping(*name);
        if (!configuration) throw CommandFailure(configuration.error());
        print_text(mapping_text(configuration->mapping));
    });
}

}  // namespace octoskin::app
