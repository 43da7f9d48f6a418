#include "host/apps/command_line/log_format.hpp"

#include <spdlog/formatter.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "host/core/text/printable.hpp"

namespace octoskin::app {
namespace {

std::string text_of(const spdlog::details::log_msg& message) {
    return printable(std::string_view(message.payload.data(), message.payload.size()));
}

/// The "%*" of the pattern: the message as printable text.
class PrintableText final : public spdlog::custom_flag_formatter {
  public:
    void format(const spdlog::details::log_msg& message, const std::tm& /*time*/,
                spdlog::memory_buf_t& line) override {
        const std::string text = text_of(message);
        line.append(text.data(), text.data() + text.size());
    }
    [[nodiscard]] std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
        return std::make_unique<PrintableText>();
    }
};

class JournalFormatter final : public spdlog::formatter {
  public:
    void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
        constexpr std::array<char, 7> kPriority{
            '7', '7', '6', '4', '3', '2', '6'};  // by spdlog's level; the values are syslog priorities
        const std::string text = text_of(message);
        line.push_back('<');
        line.push_back(kPriority.at(static_cast<std::size_t>(message.level)));
        line.push_back('>');
        line.append(text.data(), text.data() + text.size());
        line.push_back('\n');
    }
    [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override {
        return std::make_unique<JournalFormatter>();
    }
};

}  // namespace

void set_log_format() {
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<PrintableText>('*').set_pattern("%H:%M:%S %^%l%$ %*");
    spdlog::set_formatter(std::move(formatter));
}

void set_journal_format() {
    spdlog::set_formatter(std::make_unique<JournalFormatter>());
}

}  // namespace octoskin::app
