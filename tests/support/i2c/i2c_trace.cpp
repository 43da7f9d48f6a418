#include "tests/support/i2c/i2c_trace.hpp"

#include <array>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace octoskin::test {
namespace {

unsigned hex(const std::string& word, std::size_t digits) {
    std::size_t used = 0;
    const unsigned long value = word.size() == digits ? std::stoul(word, &used, 16) : 0;
    if (used != digits) throw std::invalid_argument(word);
    return static_cast<unsigned>(value);
}

std::vector<std::uint8_t> index_bytes(const std::string& word) {
    const unsigned index = hex(word, 4);
    return {static_cast<std::uint8_t>(index >> 8U), static_cast<std::uint8_t>(index & 0xFFU)};
}

i2c::TransferError parse_error(std::istringstream& words) {
    using i2c::TransferError;
    constexpr std::array<std::pair<std::string_view, TransferError>, 5> kErrors = {
        {{"nack_address", TransferError::nack_address},
         {"nack_data", TransferError::nack_data},
         {"timeout", TransferError::timeout},
         {"arbitration_lost", TransferError::arbitration_lost},
         {"bus_stuck", TransferError::bus_stuck}}};
    std::string word;
    words >> word;
    for (const auto& [name, error] : kErrors) {
        if (word == name) return error;
    }
    throw std::invalid_argument("unknown error '" + word + "'");
}

void parse_read(std::istringstream& words, TraceEntry& entry) {
    std::string word;
    std::size_t length = 0;
    words >> word >> length;
    entry.write = index_bytes(word);
    if (!(words >> word)) throw std::invalid_argument("expected '->' or '!'");
    if (word == "!") {
        entry.read.assign(length, std::nullopt);
        entry.error = parse_error(words);
        return;
    }
    if (word != "->") throw std::invalid_argument("expected '->'");
    while (words >> word) {
        entry.read.push_back(word == "??" ? std::nullopt
                                          : std::optional(static_cast<std::uint8_t>(hex(word, 2))));
    }
    if (length == 0 || entry.read.size() != length) throw std::invalid_argument("length and bytes differ");
}

void parse_write(std::istringstream& words, TraceEntry& entry) {
    std::string word;
    words >> word;
    entry.write = index_bytes(word);
    while (words >> word && word != "!") entry.write.push_back(static_cast<std::uint8_t>(hex(word, 2)));
    if (words && word == "!") entry.error = parse_error(words);
    if (entry.write.size() == 2) throw std::invalid_argument("a write without bytes");
}

void append(Trace& trace, const std::string& text, i2c::Address& address) {
    std::istringstream words(text);
    std::string verb;
    if (!(words >> verb)) return;
    TraceEntry entry{.text = text, .address = address};
    if (verb == "ADDRESS") {
        words >> verb;
        address = static_cast<i2c::Address>(hex(verb, 2));
        return;
    }
    if (verb == "WAIT") {
        if (!(words >> entry.wait_ms) || entry.wait_ms == 0) throw std::invalid_argument(text);
    } else if (verb == "R") {
        parse_read(words, entry);
    } else if (verb == "W") {
        parse_write(words, entry);
    } else {
        throw std::invalid_argument("unknown verb " + verb);
    }
    trace.push_back(entry);
}

}  // namespace

Trace parse_trace(std::string_view text) {
    Trace trace;
    i2c::Address address = 0x29;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
        std::istringstream entries(line.substr(0, line.find('#')));
        for (std::string entry; std::getline(entries, entry, '|');) {
            try {
                append(trace, entry, address);
            } catch (const std::logic_error& error) {
                throw std::invalid_argument("trace entry '" + entry + "': " + error.what());
            }
        }
    }
    return trace;
}

}  // namespace octoskin::test
