#include "hw/sim/board_link/board_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

extern char** environ;

namespace octoskin::sim {
namespace {

[[noreturn]] void fail(const std::string& what, int error) {
    throw BoardLinkError(what + ": " + std::strerror(error));
}

/// Both ends; the simulator's is closed in programs that it starts.
std::array<int, 2> make_sockets() {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()) != 0) fail("board link: no socket", errno);
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    return ends;
}

pid_t start(const std::filesystem::path& program, const std::vector<std::string>& arguments, int socket) {
    std::vector<std::string> all{program.string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--socket-fd", std::to_string(socket)});
    std::vector<char*> pointers;
    for (std::string& argument : all) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    pid_t child = -1;
    const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, pointers.data(), environ);
    if (error != 0) fail(program.string() + " cannot be started", error);
    return child;
}

}  // namespace

BoardProcess::BoardProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           Eyes eyes)
    : eyes_(std::move(eyes)) {
    const std::array<int, 2> ends = make_sockets();
    socket_.emplace(ends[0]);
    const LinkSocket theirs(ends[1]);  // closed here after the start, also if that failed
    child_ = start(program, arguments, ends[1]);
}

BoardProcess::~BoardProcess() {
    socket_.reset();
    if (child_ > 0) waitpid(child_, nullptr, 0);
}

BoardMessage BoardProcess::next() {
    auto message = socket_->receive();
    if (!message) throw BoardLinkError("the emulated board ended; its output is above");
    return std::move(*message);
}

void BoardProcess::begin(const RunUntil& turn) {
    socket_->send(turn);
}

HasRun BoardProcess::finish() {
    while (true) {
        const BoardMessage message = next();
        if (const auto* done = std::get_if<HasRun>(&message)) return *done;
        const auto* question = std::get_if<WhatIsSeen>(&message);
        if (question == nullptr) throw BoardLinkError("board link: an answer to no question");
        socket_->send(Seen{eyes_(*question)});
    }
}

BoardSummary BoardProcess::summary() {
    socket_->send(AskSummary{});
    BoardMessage message = next();
    auto* summary = std::get_if<BoardSummary>(&message);
    if (summary == nullptr) throw BoardLinkError("board link: no summary");
    return std::move(*summary);
}

}  // namespace octoskin::sim
