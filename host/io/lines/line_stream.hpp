// Lines of a text file, in UTF-8 or UTF-16, with or without a byte order mark.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace octoskin {

/// Holds one line and one block of the file, whatever the file's size. UTF-16 is found by its byte order
/// mark, or by a zero in one of the first two bytes; of its characters those outside of ASCII become '?'.
class LineStream {
  public:
    enum class End : std::uint8_t {
        line_feed,
        end_of_file,   ///< there is a line, and the file ends within it
        nothing_left,  ///< there is none
    };

    /// `bytes_max`: of a line; what is behind them is left out.
    LineStream(std::ifstream stream, std::size_t bytes_max)
        : stream_(std::move(stream)), bytes_max_(bytes_max) {}

    /// The next line, and how it ended. O(bytes of the line).
    End next();

    /// Without its line feed; a carriage return stays.
    [[nodiscard]] const std::string& line() const noexcept { return line_; }
    [[nodiscard]] bool is_cut() const noexcept { return is_cut_; }
    /// Of `line`, from 1.
    [[nodiscard]] std::uint64_t number() const noexcept { return number_; }
    /// The file could not be read on.
    [[nodiscard]] bool has_failed() const { return stream_.bad(); }

  private:
    enum class Encoding : std::uint8_t { unknown, utf_8, utf_16_little, utf_16_big };
    static constexpr int kEnd = -1;

    bool fill();
    int byte();
    int character();
    void find_encoding();

    std::ifstream stream_;
    std::size_t bytes_max_;
    std::vector<char> block_;
    std::size_t taken_ = 0;  ///< of block_
    Encoding encoding_ = Encoding::unknown;
    std::string line_;
    bool is_cut_ = false;
    std::uint64_t number_ = 0;
};

}  // namespace octoskin
