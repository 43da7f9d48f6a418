#include "host/io/lines/line_stream.hpp"

#include <string_view>

namespace octoskin {
namespace {

constexpr std::size_t kBlockBytes = 65'536;

}  // namespace

bool LineStream::fill() {
    if (!stream_) return false;
    block_.resize(kBlockBytes);
    stream_.read(block_.data(), static_cast<std::streamsize>(block_.size()));
    block_.resize(static_cast<std::size_t>(stream_.gcount()));
    taken_ = 0;
    return !block_.empty();
}

int LineStream::byte() {
    if (taken_ == block_.size() && !fill()) return kEnd;
    return static_cast<unsigned char>(block_[taken_++]);
}

/// Examines the beginning of the file, which is in the block.
void LineStream::find_encoding() {
    encoding_ = Encoding::utf_8;
    if (!fill()) return;
    const std::string_view begin(block_.data(), block_.size());
    if (begin.starts_with("\xEF\xBB\xBF")) {
        taken_ = 3;
    } else if (begin.starts_with("\xFF\xFE")) {
        taken_ = 2;
        encoding_ = Encoding::utf_16_little;
    } else if (begin.starts_with("\xFE\xFF")) {
        taken_ = 2;
        encoding_ = Encoding::utf_16_big;
    } else if (begin.size() >= 2 && (begin[0] == '\0') != (begin[1] == '\0')) {
        encoding_ = begin[0] == '\0' ? Encoding::utf_16_big : Encoding::utf_16_little;
    }
}

int LineStream::character() {
    const int first = byte();
    if (encoding_ == Encoding::utf_8 || first == kEnd) return first;
    const int second = byte();
    if (second == kEnd) return kEnd;
    const int upper = encoding_ == Encoding::utf_16_big ? first : second;
    const int lower = encoding_ == Encoding::utf_16_big ? second : first;
    return upper == 0 && lower < 0x80 ? lower : '?';
}

LineStream::End LineStream::next() {
    if (encoding_ == Encoding::unknown) find_encoding();
    line_.clear();
    is_cut_ = false;
    for (int next = character(); next != kEnd; next = character()) {  // at most the rest of the file
        if (next == '\n') {
            ++number_;
            return End::line_feed;
        }
        if (line_.size() < bytes_max_) {
            line_.push_back(static_cast<char>(next));
        } else {
            is_cut_ = true;
        }
    }
    if (line_.empty()) return End::nothing_left;
    ++number_;
    return End::end_of_file;
}

}  // namespace octoskin
