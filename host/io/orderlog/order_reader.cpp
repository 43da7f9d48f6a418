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

}  // namespace

Result<OrderReader, CommitSourceError> OrderReader::open(const FilePlace& file) {
    const auto opened = file.open();
    if (!opened) return unexpected(CommitSourceError{opened.error().message()});
    std::ifstream stream(opened->path_for_libraries(), std::ios::binary);
    if (!stream) return unexpected(CommitSourceError{file.shown().string() + ": cannot be opened"});
    OrderReader reader(file.shown(), std::move(stream));
    const auto header = reader.read_line() ? parse_header(reader.line_) : std::nullopt;
    if (!header) {
        return reader.failure(
            "does not begin like an order log of this version, 'octoskin-order/2' or 'octoskin-order/1'; "
            "move the file away to replay in the order of capture times");
    }
    reader.header_ = *header;
    return reader;
}

Unexpected<CommitSourceError> OrderReader::failure(const std::string& what) const {
    return unexpected(CommitSourceError{file_.string() + ":" + std::to_string(line_number_) + ": " + what});
}

bool OrderReader::read_line() {
    line_.clear();
    ++line_number_;
    for (char next = 0; line_.size() <= kLineBytesMax && stream_.get(next); line_ += next) {
        if (next == '\n') return true;
    }
    return line_.size() > kLineBytesMax;  // no parser accepts a longer line
}

Result<std::optional<Commit>, CommitSourceError> OrderReader::end(const Trailer& trailer) {
    if (trailer.commits != commits_ + trailer.lost_commits) {
        return failure("there were " + std::to_string(trailer.commits) + " commits, " +
                       std::to_string(trailer.lost_commits) + " of them not recorded, and " +
                       std::to_string(commits_) + " are in the file");
    }
    trailer_ = trailer;
    if (read_line()) return failure("a line after the end");
    return std::optional<Commit>{};
}

Result<std::optional<Commit>, CommitSourceError> OrderReader::next() {
    if (trailer_) return std::optional<Commit>{};
    while (read_line()) {
        if (line_.starts_with('#')) continue;
        if (auto commit = parse_commit(line_, header_.joints)) {
            if (!can_be(*commit)) return failure("no sensor has that range: '" + line_.substr(0, 60) + "'");
            ++commits_;
            return commit;
        }
        if (const auto trailer = parse_trailer(line_)) return end(*trailer);
        return failure("not a line of an order log: '" + line_.substr(0, 60) + "'");
    }
    if (stream_.bad()) return failure("cannot be read on");
    return std::optional<Commit>{};
}

}  // namespace octoskin::orderlog
