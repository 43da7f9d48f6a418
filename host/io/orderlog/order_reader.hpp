// Reads order.log line by line, as the source of an ordered replay.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "host/core/pipeline/ordered_replay.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/orderlog/order_line.hpp"

namespace octoskin::orderlog {

class OrderReader final : public CommitSource {
  public:
    /// Errors name the file: it is missing, or does not begin like an order.log of this version.
    [[nodiscard]] static Result<OrderReader, Error> open(const FilePlace& file);

    /// An error names file and line: not a commit, a line after the end, or fewer commits than the end
    /// states. A file without an end, from a daemon that was killed, ends with its last complete line.
    [[nodiscard]] Result<std::optional<Commit>, Error> next() override;

    [[nodiscard]] const Header& header() const noexcept { return header_; }
    /// After the end; empty if the recording was cut off.
    [[nodiscard]] const std::optional<Trailer>& trailer() const noexcept { return trailer_; }
    /// Of the latest commit, from 1.
    [[nodiscard]] std::uint64_t line_number() const noexcept { return line_number_; }

  private:
    OrderReader(std::filesystem::path file, std::ifstream stream)
        : file_(std::move(file)), stream_(std::move(stream)) {}
    /// False at the end of the file, or at an incomplete last line.
    [[nodiscard]] bool read_line();
    [[nodiscard]] Unexpected<Error> failure(Error error) const;
    [[nodiscard]] Result<std::optional<Commit>, Error> end(const Trailer& trailer);

    std::filesystem::path file_;
    std::ifstream stream_;
    std::string line_;
    std::uint64_t line_number_ = 0;
    std::uint64_t commits_ = 0;
    Header header_;
    std::optional<Trailer> trailer_;
};

}  // namespace octoskin::orderlog
