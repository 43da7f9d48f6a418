// Runs a program as a user does, and keeps what it said.
#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

namespace octoskin {

struct Said {
    int exit_code = -1;
    std::string output;  ///< standard output and, unless `errors` go elsewhere, standard error
};

/// Through the shell, as typed.
inline Said run(const std::string& command, const std::string& errors = "2>&1") {
    Said said;
    FILE* const pipe = ::popen((command + " " + errors).c_str(), "r");
    if (pipe == nullptr) return said;  // no process to be had
    std::array<char, 4096> buffer{};
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
        said.output.append(buffer.data(), count);
    const int status = ::pclose(pipe);
    said.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return said;
}

/// Whether `arguments` begin with a command of octoskin-lab, and not of octoskin.
inline bool are_for_lab(const std::string& arguments) {
    const std::size_t begin = std::min(arguments.find_first_not_of(' '), arguments.size());
    const std::string command = arguments.substr(begin, arguments.find(' ', begin) - begin);
    return command == "simulate" || command == "evaluate" || command == "experiment" || command == "depth";
}

/// The program that has the command which `arguments` begin with, and them: as typed.
inline std::string typed(const std::string& arguments) {
    return (are_for_lab(arguments) ? OCTOSKIN_LAB_PROGRAM " " : OCTOSKIN_PROGRAM " ") + arguments;
}

inline Said octoskin(const std::string& arguments) {
    return run(typed(arguments));
}

}  // namespace octoskin
