// Writes the tables of the reference pages from the declarations in the code, or checks that they are as
// written.
//
//     reference_pages --write DOCS      renders each table anew
//     reference_pages --check DOCS      exit code 1 if a table is stale, missing or unknown
//
// A page has the line `<!-- table: NAME -->`, the table, and the line `<!-- end of table -->`; all else on it
// is written by hand. Each declared table is on its page exactly once.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "host/apps/command_line/exit_codes.hpp"
#include "host/apps/daemon/problem.hpp"
#include "host/apps/monitor/status_meanings.hpp"
#include "host/core/counters/counter_meanings.hpp"
#include "host/errors/error_code.hpp"
#include "host/io/mapping/mapping_keys.hpp"
#include "hw/rigfile/hardware_keys.hpp"
#include "hw/rigfile/rig_keys.hpp"
#include "hw/sim/scenario/scenario_keys.hpp"
#include "tests/system/reference/page_tables.hpp"
#include "tests/system/reference/protocol_tables.hpp"

namespace octoskin {
namespace {

constexpr std::string_view kBegin = "<!-- table: ";
constexpr std::string_view kBeginEnd = " -->";
constexpr std::string_view kEnd = "<!-- end of table -->";

std::string_view word(Cause cause) {
    switch (cause) {
        case Cause::scene:
            return "scene";
        case Cause::outside:
            return "outside";
        case Cause::other_device:
            return "others";
        case Cause::mendable:
            return "mendable";
    }
    return "";
}

Tables exit_code_tables() {
    Tables tables;
    for (const app::ExitCodeMeaning& meaning : app::exit_code_meanings())
        add_row(tables, "exit codes", "| Code | Meaning |\n|---|---|",
                fmt::format("| {} | {} |", meaning.codes, cell(meaning.meaning)));
    return tables;
}

Tables error_tables() {
    Tables tables;
    for (const ErrorMeaning& error : kErrorMeanings)
        add_row(tables, "error codes", "| Code | Meaning |\n|---|---|",
                fmt::format("| `{}` | {} |", error.name, cell(error.meaning)));
    return tables;
}

Tables problem_tables() {
    Tables tables;
    for (const ProblemMeaning& problem : kProblemMeanings)
        add_row(tables, "problem codes", "| Code | Meaning |\n|---|---|",
                fmt::format("| `{}` | {} |", problem.name, cell(problem.meaning)));
    return tables;
}

std::string type_text(ValueType type) {
    return fmt::format("{}{}", name_of(type.kind), type.may_be_null ? " or null" : "");
}
Tables status_tables() {
    std::set<std::string_view> groups_with_units;
    for (const Meaning& meaning : status_meanings())
        if (!meaning.unit.empty()) groups_with_units.insert(meaning.group);
    Tables tables;
    for (const Meaning& meaning : status_meanings()) {
        const bool has_units = groups_with_units.contains(meaning.group);
        const std::string_view group = meaning.group.empty() ? "top" : meaning.group;
        add_row(tables, fmt::format("status of {}", group),
                has_units ? "| Key | Type | Unit | Meaning |\n|---|---|---|---|"
                          : "| Key | Type | Meaning |\n|---|---|---|",
                fmt::format("| `{}` | {} |{} {} |", meaning.name, cell(type_text(meaning.type)),
                            has_units ? fmt::format(" {} |", meaning.unit) : "", cell(meaning.text)));
    }
    return tables;
}

Tables status_page_tables() {
    Tables tables = status_tables();
    tables.merge(problem_tables());
    return tables;
}

Tables counter_tables() {
    Tables tables;
    for (const CounterMeaning& meaning : counter_meanings())
        add_row(tables, fmt::format("counters of {}", meaning.unit),
                "| Counter | Rejected because | Cause | Remedy |\n|---|---|---|---|",
                fmt::format("| `{}` | {} | {} | {} |", meaning.name, cell(meaning.text), word(meaning.cause),
                            cell(meaning.remedy)));
    return tables;
}

/// `cell` would take the paths of links and the code of this table's Markdown apart.
Tables mapping_tables() {
    Tables tables;
    for (const MappingKey& key : mapping_keys()) {
        const std::string denoised = value_text(key, denoised_mapping());
        const std::string paper = value_text(key, paper_mapping());
        add_row(
            tables, "mapping keys", "| Key | Unit | Expected | Default | Meaning |\n|---|---|---|---|---|",
            fmt::format("| `{}` | {} | {} | {} | {} |", key.path, key.unit, expected_text(key),
                        denoised == paper ? denoised : fmt::format("{} ({})", denoised, paper), key.meaning));
    }
    return tables;
}

/// A cell for what a key is called: its name in its table, or its path in the file.
enum class KeyCell { name, path };
bool has_unit(const rig::AnyKey& key) {
    return !rig::unit_of(key).empty();
}
Tables key_tables(std::span<const rig::KeyTable> declared, KeyCell cell_of_key) {
    // Tables of one title are one table of the page, with one head.
    std::map<std::string, std::vector<rig::AnyKey>, std::less<>> keys_by_name;
    for (const rig::KeyTable& table : declared) {
        std::vector<rig::AnyKey>& keys = keys_by_name[std::string(table.title)];
        keys.insert(keys.end(), table.keys.begin(), table.keys.end());
    }
    Tables tables;
    for (const auto& [name, keys] : keys_by_name) {
        const bool has_units = std::ranges::any_of(keys, has_unit);
        const bool has_block = std::ranges::any_of(keys, rig::is_in_node_block);
        const std::string head = fmt::format(
            "| Key |{} Expected | Default | Meaning |{}\n|---|{}---|---|---|{}", has_units ? " Unit |" : "",
            has_block ? " Node |" : "", has_units ? "---|" : "", has_block ? "---|" : "");
        for (const rig::AnyKey& key : keys) {
            const std::string_view path = rig::path_of(key);
            const std::string_view above =
                cell_of_key == KeyCell::path ? path.substr(0, path.rfind('.') + 1) : "";
            std::string row = fmt::format("| `{}{}` |", above, rig::name_of(path));
            if (has_units) row += fmt::format(" {} |", rig::unit_of(key));
            row += fmt::format(" {} | {} | {} |", rig::expected_text(key), rig::default_text(key),
                               rig::meaning_of(key));
            if (has_block) row += rig::is_in_node_block(key) ? " yes |" : " |";
            add_row(tables, name, head, row);
        }
    }
    return tables;
}

/// Of the rig file and of the hardware file of a board.
Tables rig_tables() {
    Tables tables = key_tables(rig::rig_key_tables(), KeyCell::name);
    tables.merge(key_tables(rig::hardware_key_tables(), KeyCell::path));
    return tables;
}

struct Page {
    std::string file;
    Tables tables;
};

/// The page with its tables rendered; faults are reported with file and line.
struct Rendered {
    std::string text;
    std::vector<std::string> faults;
};
Rendered render(const std::string& file, const std::string& page, Tables tables) {
    Rendered rendered;
    std::istringstream lines(page);
    bool is_in_table = false;
    int number = 0;
    const auto fault = [&](std::string_view what) {
        rendered.faults.push_back(fmt::format("{}:{}: {}", file, number, what));
    };
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line == kEnd) {
            if (!is_in_table) fault("the end of a table that has not begun");
            is_in_table = false;
        }
        if (is_in_table) continue;
        rendered.text += line + '\n';
        if (!line.starts_with(kBegin) || !line.ends_with(kBeginEnd)) continue;
        is_in_table = true;
        const std::string name = line.substr(kBegin.size(), line.size() - kBegin.size() - kBeginEnd.size());
        const auto table = tables.find(name);
        if (table == tables.end()) {
            fault(fmt::format("no table '{}' is declared, or it is on this page twice", name));
            continue;
        }
        rendered.text += table->second;
        tables.erase(table);
    }
    if (is_in_table) fault(fmt::format("a table without the line '{}'", kEnd));
    for (const auto& table : tables)
        rendered.faults.push_back(fmt::format("{}: the table '{}' is missing: add {}{}{} and {}", file,
                                              table.first, kBegin, table.first, kBeginEnd, kEnd));
    return rendered;
}

int run(std::string_view mode, const std::string& docs) {
    const std::vector<Page> pages = {{"reference/command-line.md", exit_code_tables()},
                                     {"reference/errors.md", error_tables()},
                                     {"status.md", status_page_tables()},
                                     {"counters.md", counter_tables()},
                                     {"mapping.md", mapping_tables()},
                                     {"protocol.md", protocol_tables()},
                                     {"rig.md", rig_tables()},
                                     {"scenario.md", key_tables(sim::scenario_key_tables(), KeyCell::path)}};
    bool is_good = true;
    for (const Page& page : pages) {
        const std::string file = docs + "/" + page.file;
        std::ostringstream old;
        std::ifstream in(file);
        if (!in) {
            fmt::print(stderr, "{}: cannot read\n", file);
            return 1;
        }
        old << in.rdbuf();
        const Rendered now = render(file, old.str(), page.tables);
        for (const std::string& fault : now.faults) fmt::print(stderr, "{}\n", fault);
        is_good &= now.faults.empty();
        if (now.text == old.str()) continue;
        if (mode == "--write") {
            std::ofstream out(file);
            out << now.text;
            out.close();
            if (!out) fmt::print(stderr, "{}: cannot write\n", file);
            is_good &= static_cast<bool>(out);
        } else {
            fmt::print(stderr, "{}: a table is stale: run toolchains/write_reference\n", file);
            is_good = false;
        }
    }
    return is_good ? 0 : 1;
}

}  // namespace
}  // namespace octoskin

int main(int argc, char** argv) {
    const std::string_view mode = argc == 3 ? argv[1] : "";
    if (mode != "--write" && mode != "--check") {
        std::fputs("usage: reference_pages --write|--check DOCS\n", stderr);
        return 64;
    }
    return octoskin::run(mode, argv[2]);
}
