#include "host/bridge/view/map_board.hpp"

#include <utility>

#include "host/io/snapshot/bytes.hpp"

namespace octoskin::view {

class MapBoard::Reader final : public MessageStream {
  public:
    explicit Reader(MapBoard& board) : board_(board) {
        board_.readers_.insert(this);
        if (board_.newest_) lacks_.on_map(board_.newest_->map, {});
    }
    ~Reader() override { board_.readers_.erase(this); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    [[nodiscard]] std::optional<StreamMessage> next() override {
        if (!board_.newest_) return std::nullopt;
        const auto piece = lacks_.next(board_.newest_->map, kFrameBytes, board_.newest_->changed);
        if (!piece) return std::nullopt;
        StreamMessage message{{}, board_.newest_->when};
        snapshot::ByteWriter writer(message.payload);
        writer.put(piece->flags);
        writer.put(board_.newest_->time.ns);
        message.payload += piece->payload;
        return message;
    }
    [[nodiscard]] watch::MapReader& lacks() noexcept { return lacks_; }

  private:
    MapBoard& board_;
    watch::MapReader lacks_;
};

void MapBoard::on_map(const watch::WatchedMap& map, WallTime when) {
    FusedMap now = map.map();
    const bool begins =
        std::exchange(is_another_, false) || !newest_ || newest_->map.resolution_m() != now.resolution_m();
    const bool has_reader = !readers_.empty();
    const auto changed =
        has_reader && !begins ? watch::changed_bricks(now, newest_->map) : watch::BrickCodes{};
    auto records = readers_.size() > 1 ? watch::BrickRecords(now, changed) : watch::BrickRecords();
    newest_.emplace(Newest{std::move(now), map.time(), when, std::move(records)});
    for (Reader* const reader : readers_) {
        if (begins) reader->lacks().begin_again();
        reader->lacks().on_map(newest_->map, changed);
    }
}

std::unique_ptr<MessageStream> MapBoard::stream() {
    return std::make_unique<Reader>(*this);
}

}  // namespace octoskin::view
