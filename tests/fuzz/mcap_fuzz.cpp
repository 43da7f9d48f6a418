// MCAP files: read to the end, in the order of their times, with every fault counted.
#include <cassert>
#include <limits>

#include "host/io/mcap/mcap_reader.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    static const fuzz::InputDirectory directory;
    auto reader = mcap::McapReader::open(directory.write("a.mcap", fuzz::text_of({data, size})));
    if (!reader) {
        assert(reader.error().code == ErrorCode::foreign_format);
        return 0;
    }
    WallTime newest{std::numeric_limits<std::int64_t>::min()};
    std::uint64_t disordered = 0;
    std::uint8_t sum = 0;
    for (;;) {
        const auto message = reader->next();
        assert(message);
        if (!*message) break;
        const mcap::Message& one = **message;
        assert(reader->channels().at(one.head.channel_id) == *one.channel);
        for (const std::uint8_t byte : one.data) sum = static_cast<std::uint8_t>(sum + byte);
        if (one.head.logged < newest) ++disordered;
        newest = std::max(newest, one.head.logged);
    }
    assert(disordered <= reader->count(mcap::Fault::out_of_order));
    assert(reader->count(mcap::Fault::cut) <= 1);
    const auto end = reader->next();
    assert(end && !*end);
    return 0;
}
