// Lines of a text file in UTF-8 or UTF-16, with or without a byte order mark.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace octoskin {

/// Holds one line and one block of the file in memory. UTF-16 is detected by its byte order mark, or by a
/// zero in one of the first two bytes; its characters outside ASCII become '?'.
class LineStream {
  public:
    enum class End : std::uint8_t {
        line_feed,
        end_of_file,   ///< the file ends within this line
        nothing_left,  ///< there is no further line
    };

    /// `bytes_max`: of a line; the rest of a longer line is dropped.
    LineStream(std::ifstream stream, std::size_t bytes_max)
        : stream_(std::move(stream)), bytes_max_(bytes_max) {}

    /// Reads the next line and returns how it ended. O(bytes of the line).
    End next();

    /// Without its line feed; a carriage return is kept.
    [[nodiscard]] const std::string& line() const noexcept { return line_; }
    [[nodiscard]] bool is_cut() const noexcept { return is_cut_; }
    /// The number of `line`, from 1.
    [[nodiscard]] std::uint64_t number() const noexcept { return number_; }
    /// True if reading the file failed.
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
    std::size_t taken_ = 0;  ///< bytes of block_ already used
    Encoding encoding_ = Encoding::unknown;
    std::string line_;
    bool is_cut_ = false;
    std::uint64_t number_ = 0;
};

}  // namespace octoskin
