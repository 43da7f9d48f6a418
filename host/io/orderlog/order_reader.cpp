#include "host/io/orderlog/order_reader.hpp"

#include <variant>

#include "host/core/beams/beam_limits.hpp"

namespace octoskin::orderlog {
namespace {

/// A reading outside these bounds, from an untrusted file, could have a cone as large as the octree.
bool can_be(const Commit& commit) {
    const auto* const reading = std::get_if<RangeMeasurement>(&commit);
    return reading == nullptr || !reading->range_m || can_be_a_range(*reading->range_m, reading->sigma_m);
}

/// The beginning of a line, in quotes.
std::string shown(const std::string& line) {
    constexpr std::size_t kCharsMax = 60;
    std::string text = "'";
    return text.append(line, 0, kCharsMax).append("'");
}

}  // namespace

Result<OrderReader, Error> OrderReader::open(const FilePlace& file) {
    const auto opened = file.open();
    if (!opened) return unexpected(to_error(opened.error()));
    std::ifstream stream(opened->path_for_libraries(), std::ios::binary);
    if (!stream) return unexpected(in_file({ErrorCode::system_error, "cannot be opened"}, file.shown()));
    OrderReader reader(file.shown(), std::move(stream));
    const auto header = reader.read_line() ? parse_header(reader.line_) : std::nullopt;
    if (!header) {
        return reader.failure(
            {.code = ErrorCode::foreign_format,
             .what =
                 "does not begin like an order log of this version, 'octoskin-order/2' or 'octoskin-order/1'",
             .remedy = "move the file away to replay in the order of capture times"});
    }
    reader.header_ = *header;
    return reader;
}

Unexpected<Error> OrderReader::failure(Error error) const {
    return unexpected(in_file(std::move(error), file_, static_cast<int>(line_number_)));
}

bool OrderReader::read_line() {
    line_.clear();
    ++line_number_;
    for (char next = 0; line_.size() <= kLineBytesMax && stream_.get(next); line_ += next) {
        if (next == '\n') return true;
    }
    return line_.size() > kLineBytesMax;  // no parser accepts a longer line
}

Result<std::optional<Commit>, Error> OrderReader::end(const Trailer& trailer) {
    if (trailer.commits != commits_ + trailer.lost_commits) {
        return failure({ErrorCode::damaged,
                        "expected " + std::to_string(trailer.commits) + " commits without the " +
                            std::to_string(trailer.lost_commits) + " that were not recorded",
                        std::to_string(commits_)});
    }
    trailer_ = trailer;
    if (read_line()) return failure({ErrorCode::damaged, "a line after the end"});
    return std::optional<Commit>{};
}

Result<std::optional<Commit>, Error> OrderReader::next() {
    if (trailer_) return std::optional<Commit>{};
    while (read_line()) {
        if (line_.starts_with('#')) continue;
        if (auto commit = parse_commit(line_, header_.form)) {
            if (!can_be(*commit))
                return failure({ErrorCode::out_of_range, "no sensor has that range", shown(line_)});
            ++commits_;
            return commit;
        }
        if (const auto trailer = parse_trailer(line_)) return end(*trailer);
        return failure({ErrorCode::bad_syntax, "expected a line of an order log", shown(line_)});
    }
    if (stream_.bad()) return failure({ErrorCode::system_error, "cannot be read on"});
    return std::optional<Commit>{};
}

}  // namespace octoskin::orderlog
