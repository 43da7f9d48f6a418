#include "host/apps/command_line/exit_codes.hpp"

#include <algorithm>
#include <array>

namespace octoskin::app {
namespace {

constexpr std::array kExitCodeMeanings = {
    ExitCodeMeaning{"0", "done"},
    ExitCodeMeaning{"1", "done, with a bad result"},
    ExitCodeMeaning{"2", "done, and the result is not known (query)", true},
    ExitCodeMeaning{"64", "command line"},
    ExitCodeMeaning{"65", "unusable data"},
    ExitCodeMeaning{"66", "no such file"},
    ExitCodeMeaning{"69", "a program or device is missing, or no daemon runs"},
    ExitCodeMeaning{"70", "a defect of octoskin"},
    ExitCodeMeaning{"71", "too little memory, descriptors or threads (ulimit)"},
    ExitCodeMeaning{"73", "cannot write"},
    ExitCodeMeaning{"74", "a device, standard input or standard output failed, or did not answer"},
    ExitCodeMeaning{"77", "no permission"},
    ExitCodeMeaning{"78", "rig, robot, scenario or mapping file"},
    ExitCodeMeaning{"129, 130, 131, 143", "interrupted by SIGHUP, Ctrl-C, SIGQUIT, SIGTERM"},
};

}  // namespace

std::span<const ExitCodeMeaning> exit_code_meanings() noexcept {
    return kExitCodeMeanings;
}

std::string exit_codes_text(bool has_queries) {
    constexpr std::size_t kColumns = 100;
    std::string text = "Exit codes:";
    std::size_t column = text.size();
    const auto add_word = [&](std::string_view word) {
        if (column + 1 + word.size() > kColumns) {
            text += '\n';
            column = 0;
        } else {
            text += ' ';
            ++column;
        }
        text += word;
        column += word.size();
    };
    for (const ExitCodeMeaning& meaning : kExitCodeMeanings) {
        if (meaning.is_of_queries && !has_queries) continue;
        const bool is_last = &meaning == &kExitCodeMeanings.back();
        const std::string entry =
            std::string(meaning.codes).append(" ").append(meaning.meaning).append(is_last ? "." : ";");
        for (std::size_t begin = 0; begin < entry.size();) {
            const std::size_t end = std::min(entry.find(' ', begin), entry.size());
            add_word(std::string_view(entry).substr(begin, end - begin));
            begin = end + 1;
        }
    }
    return text;
}

}  // namespace octoskin::app
