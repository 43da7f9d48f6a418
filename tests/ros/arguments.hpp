// Command lines of the programs of this folder: `--name value`, `--flag`, and the rest.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace octoskin::ros {

class Arguments {
  public:
    /// `flags` take no value, `options` take one. Throws std::invalid_argument for another argument that
    /// begins with
    /// `--`, and for an option without a value.
    Arguments(int count, char** words, const std::set<std::string>& flags,
              const std::set<std::string>& options);

    [[nodiscard]] bool has(const std::string& name) const { return given_.contains(name); }
    [[nodiscard]] std::string text(const std::string& name, const std::string& otherwise) const;
    /// Throws std::invalid_argument if the value is not one of `allowed`; the first is the default.
    [[nodiscard]] std::string choice(const std::string& name, const std::vector<std::string>& allowed) const;
    /// Throws std::invalid_argument if the value is no number of at least 0.
    [[nodiscard]] double number(const std::string& name, double otherwise) const;
    [[nodiscard]] int whole(const std::string& name, int otherwise) const;
    [[nodiscard]] const std::vector<std::string>& rest() const { return rest_; }

  private:
    std::map<std::string, std::string> given_;
    std::vector<std::string> rest_;
};

/// Runs a program: prints `usage` for --help, and the message of an exception. Returns the exit code: 0, 1 if
/// it threw, 2 for a wrong command line (std::invalid_argument).
int run_program(int count, char** words, const char* usage, int (*program)(int, char**));

}  // namespace octoskin::ros
