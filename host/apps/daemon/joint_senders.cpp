#include "host/apps/daemon/joint_senders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <ranges>

namespace octoskin {
namespace {

/// The name of a process may be any bytes: only printable ones are kept.
std::string program_of(pid_t pid) {
    if (pid <= 0) return {};
    std::ifstream file(fmt::format("/proc/{}/comm", pid));
    std::string name;
    std::getline(file, name);
    std::ranges::replace_if(
        name, [](char c) { return c < ' ' || c > '~'; }, '?');
    return name;
}

}  // namespace

std::string describe(const JointSender& sender, const std::string& program) {
    std::string text = sender.pid > 0 ? fmt::format("process {} ({}{}user {})", sender.pid, program,
                                                    program.empty() ? "" : ", ", sender.uid)
                                      : "a process that is not visible from here";
    if (!sender.address.empty()) text += " at " + sender.address;
    return text;
}

std::string describe(const JointSender& sender) {
    return describe(sender, program_of(sender.pid));
}

void JointSenders::hear(const JointSender& sender, HostTime at) {
    auto found = std::ranges::find(senders_, sender, &Heard::sender);
    if (found == senders_.end()) {
        if (senders_.size() >= kKept) senders_.erase(std::ranges::min_element(senders_, {}, &Heard::newest));
        senders_.push_back({sender, program_of(sender.pid), 0, at});
        found = std::prev(senders_.end());
    }
    ++found->samples;
    found->newest = std::max(found->newest, at);
    if (!are_several(at)) return;
    several_ = heard(at);
    several_at_ = at;
}

bool JointSenders::are_several(HostTime now) const {
    const auto is_heard = [now](const Heard& heard) { return now - heard.newest < kHeardFor; };
    return std::ranges::count_if(senders_, is_heard) > 1;
}

std::vector<JointSenders::Heard> JointSenders::heard(HostTime now) const {
    std::vector<Heard> those;
    for (const Heard& heard : senders_) {
        if (now - heard.newest < kHeardFor) those.push_back(heard);
    }
    return those;
}

}  // namespace octoskin
