// Files put together by hand as OpenNI2's recorder writes them, each damaged in one place that its player
// trusts.
#include "host/io/openni2/helpers/oni_check.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "host/io/openni2/helpers/packed_depth.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::openni2 {
namespace {

template <class T>
std::string bytes_of(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

std::string text(const std::string& characters) {
    return bytes_of(static_cast<std::uint32_t>(characters.size() + 1)) + characters + '\0';
}

struct Record {
    std::uint32_t type = 0;
    std::string fields;
    std::string payload = {};
    std::uint32_t node = 1;
    std::uint32_t more_fields = 0;   ///< that the header tells of
    std::uint32_t more_payload = 0;  ///< modulo 2^32
    std::uint32_t magic = 0x0052494E;

    [[nodiscard]] std::string bytes() const {
        return bytes_of(magic) + bytes_of(type) + bytes_of(node) +
               bytes_of(static_cast<std::uint32_t>(28 + fields.size() + more_fields)) +
               bytes_of(static_cast<std::uint32_t>(payload.size() + more_payload)) +
               bytes_of(std::uint64_t{0}) + fields + payload;
    }
};

Record property(const std::string& name, const std::string& value, std::uint32_t type = 0x06) {
    return {type, text(name) + bytes_of(static_cast<std::uint32_t>(value.size())) + value};
}
Record number(const std::string& name, std::uint64_t value) {
    return property(name, bytes_of(value), 0x03);
}
Record mode(std::uint32_t width, std::uint32_t height) {
    return property("xnMapOutputMode", bytes_of(width) + bytes_of(height) + bytes_of(std::uint32_t{30}));
}

/// 4 x 2 pixels of 0 and 1000 mm: a table of two, the first number, then differences.
const std::string kPacked = bytes_of(std::uint16_t{2}) + bytes_of(std::uint16_t{0}) +
                            bytes_of(std::uint16_t{1000}) + bytes_of(std::uint16_t{0}) + "\x56\xE1\x76\x6D";

enum At : std::size_t {
    added,
    bytes,
    mode_at,
    format,
    fov,
    ready,
    begun,
    first,
    second,
    removed,
    table,
    end
};

Record frame(std::uint32_t number, std::uint64_t timestamp = 0) {
    return {0x0A, bytes_of(timestamp) + bytes_of(number), kPacked};
}

struct File {
    std::string header =
        std::string("NI10\1\0\1\0\0\0\0\0", 12) + std::string(8, '\xFF') + bytes_of(std::uint32_t{1});
    std::string name = "Depth";
    std::uint32_t type = 2;
    std::string codec = "16zT";
    std::uint64_t table_off = 0;
    std::uint64_t entry_off = 0;
    std::vector<Record> records;

    File() {
        records = {{},
                   number("oniRequiredFrameSize", 16),
                   mode(4, 2),
                   number("oniPixelFormat", 100),
                   property("xnFOV", std::string(16, '\0')),
                   {0x09, ""},
                   {0x08, std::string(12, '\xFF')},
                   frame(1),
                   frame(2),
                   {0x07, ""},
                   {},
                   {0x0B, "", "", 0}};
        refresh();
    }
    [[nodiscard]] std::uint64_t place(std::size_t record) const {
        std::uint64_t place = header.size();
        for (std::size_t i = 0; i < record; ++i) place += records[i].bytes().size();
        return place;
    }
    void set_added(std::uint64_t table_place) {
        records[added].type = 0x0D;
        records[added].fields = text(name) + bytes_of(type) + codec + bytes_of(std::uint32_t{2}) +
                                std::string(16, '\0') + bytes_of(table_place);
    }
    /// The stream's first record and its table, for what the others are now.
    void refresh() {
        set_added(0);
        set_added(place(table) + table_off);
        std::string entries(20, '\0');
        for (const std::size_t frame : {std::size_t{first}, std::size_t{second}})
            entries += std::string(12, '\0') + bytes_of(place(frame) + entry_off);
        records[table].type = 0x0E;
        records[table].payload = entries;
    }
    [[nodiscard]] std::string whole() const {
        std::string whole = header;
        for (const Record& record : records) whole += record.bytes();
        return whole;
    }
};

class OniCheckTest : public testing::Test {
  protected:
    std::optional<OniFault> fault_in(const std::string& bytes) {
        return fault_of(scratch_.write("x.oni", bytes));
    }
    testing_support::ScratchFolder scratch_;
};

TEST_F(OniCheckTest, what_OpenNI2_records_has_no_fault) {
    File file;
    EXPECT_EQ(fault_in(file.whole()), std::nullopt) << fault_in(file.whole())->what;
    EXPECT_EQ(fault_in(file.whole() + std::string(1000, 'x')), std::nullopt) << "behind the end";
    file.codec = "NONE";
    file.records[first].payload = file.records[second].payload = std::string(16, 'x');
    file.refresh();
    EXPECT_EQ(fault_in(file.whole()), std::nullopt);
    file.type = 3;  // colours, of any size
    file.name = "Image";
    file.records[first].payload = std::string(24, 'x');
    file.refresh();
    EXPECT_EQ(fault_in(file.whole()), std::nullopt);
}

TEST_F(OniCheckTest, streams_of_one_file_are_kept_apart) {
    File file;
    file.header[20] = 2;
    const auto added_of = [](const std::string& name) {
        return text(name) + bytes_of(std::uint32_t{3}) + "NONE" + bytes_of(std::uint32_t{1}) +
               std::string(24, '\0');
    };
    std::vector<Record> of_colours{{0x0D, added_of("Image")},     mode(1600, 1200), {0x09, ""},
                                   {0x08, std::string(12, '\0')}, frame(1),         {0x07, ""}};
    of_colours[4].payload = std::string(1600 * 1200 * 3, 'x');
    for (Record& record : of_colours) record.node = 2;
    file.records.insert(file.records.begin() + begun, of_colours.begin(), of_colours.begin() + 3);
    file.records.insert(file.records.end() - 1, of_colours.begin() + 3, of_colours.end());
    file.set_added(0);
    file.records[table + 3].payload = std::string(32, '\0') + bytes_of(file.place(first + 3)) +
                                      std::string(12, '\0') + bytes_of(file.place(second + 3));
    EXPECT_EQ(fault_in(file.whole()), std::nullopt) << fault_in(file.whole())->what;
    file.records[begun].fields = added_of("Depth");
    EXPECT_EQ(fault_in(file.whole()).value().position, file.place(begun)) << "of the same name";
}

// As OpenNI2's recorder writes two streams: both are added, then each gets ready and begins.
TEST_F(OniCheckTest, a_stream_may_get_ready_after_the_data_of_another_begin) {
    File file;
    file.header[20] = 2;
    const std::string added = text("Image") + bytes_of(std::uint32_t{3}) + "NONE" +
                              bytes_of(std::uint32_t{1}) + std::string(24, '\0');
    std::vector<Record> before{{0x0D, added}, mode(64, 48)};
    std::vector<Record> after{{0x09, ""}, {0x08, std::string(12, '\0')}, frame(1)};
    after[2].payload = std::string(64 * 48 * 3, 'x');
    Record gone{0x07, ""};
    for (Record* record : {&before[0], &before[1], &after[0], &after[1], &after[2], &gone}) record->node = 2;
    file.records.insert(file.records.end() - 1, gone);
    file.records.insert(file.records.begin() + first, after.begin(), after.end());
    file.records.insert(file.records.begin() + begun - 1, before.begin(), before.end());
    file.set_added(0);
    file.records[table + 5].payload = std::string(32, '\0') + bytes_of(file.place(first + 5)) +
                                      std::string(12, '\0') + bytes_of(file.place(second + 5));
    const auto fault = fault_in(file.whole());
    EXPECT_EQ(fault, std::nullopt) << fault->what << " at " << fault->position;
}

TEST_F(OniCheckTest, a_stream_that_plays_may_be_changed) {
    for (const Record& record : {number("xnPixelFormat", 99), property("Gain", bytes_of(1.0), 0x04),
                                 property("x", std::string(1, '\0'), 0x05)}) {
        File file;
        file.records.insert(file.records.begin() + second, record);
        file.set_added(0);
        file.records[table + 1].payload = std::string(32, '\0') + bytes_of(file.place(first)) +
                                          std::string(12, '\0') + bytes_of(file.place(second + 1));
        const auto fault = fault_in(file.whole());
        EXPECT_EQ(fault, std::nullopt) << record.fields << fault->what;
    }
}

TEST_F(OniCheckTest, streams_are_added_and_set_before_the_data_of_any_begin) {
    // Each of them the player refuses without an end: then it reads the frames of the stream as records.
    const Record colours{0x0D, text("Image") + bytes_of(std::uint32_t{3}) + "NONE" + std::string(28, '\0'),
                         "", 2};
    for (const std::size_t at : {std::size_t{begun}, std::size_t{first}, std::size_t{removed}}) {
        File file;
        file.header[20] = 2;
        file.records.insert(file.records.begin() + static_cast<std::ptrdiff_t>(at), colours);
        file.set_added(0);
        // Before: it is the first frame of the other that comes too early.
        EXPECT_EQ(fault_in(file.whole()).value().position, file.place(at == begun ? first + 1 : at)) << at;
    }
    for (Record record : {number("xnPixelFormat", 99), property("xnRealWorldTranslationData", "123")}) {
        File file;
        file.header[20] = 2;
        file.records.insert(file.records.begin() + begun - 1, colours);
        record.node = 2;
        file.records.insert(file.records.begin() + first + 1, record);
        file.set_added(0);
        EXPECT_EQ(fault_in(file.whole()).value().position, file.place(first + 1)) << "set up late";
    }
    File again;
    again.records.insert(again.records.begin() + second, Record{0x09, ""});
    again.set_added(0);
    EXPECT_EQ(fault_in(again.whole()).value().position, again.place(second)) << "ready twice";
}

TEST_F(OniCheckTest, a_frame_is_numbered_and_timed_within_what_the_file_announces) {
    File file;
    file.header.replace(12, 8, bytes_of(std::uint64_t{100}));
    file.records[second] = frame(2, 100);
    EXPECT_EQ(fault_in(file.whole()), std::nullopt) << fault_in(file.whole())->what;
    for (const Record& other : {frame(0), frame(3), frame(0xFFFFFFFFU), frame(2, 101), frame(2, ~0ULL)}) {
        file.records[second] = other;
        EXPECT_EQ(fault_in(file.whole()).value().position, file.place(second));
    }
}

TEST_F(OniCheckTest, a_file_that_is_cut_anywhere_has_a_fault) {
    const std::string whole = File().whole();
    for (std::size_t length = 0; length < whole.size(); length += 3)
        EXPECT_NE(fault_in(whole.substr(0, length)), std::nullopt) << "cut to " << length;
}

struct Damage {
    const char* name;
    At at;
    std::function<void(File&)> make;
};

TEST_F(OniCheckTest, what_the_player_trusts_is_a_fault_of_the_record_that_has_it) {
    const auto insert = [](File& file, std::size_t at, const Record& record) {
        file.records.insert(file.records.begin() + static_cast<std::ptrdiff_t>(at), record);
    };
    const auto in_a_table = [](std::uint16_t entries, const std::string& rest) {
        return bytes_of(entries) + std::string(2U * entries, '\0') + rest;
    };
    const std::vector<Damage> damages{
        {"fields beyond the file", mode_at, [](File& f) { f.records[mode_at].more_fields = 1U << 30U; }},
        {"fields smaller than a header", fov, [](File& f) { f.records[fov].more_fields = 0U - 60U; }},
        {"sizes whose sum is 0 modulo 2^32", first,
         [](File& f) { f.records[first].more_payload = 0U - 60U; }},
        {"another magic", begun, [](File& f) { f.records[begun].magic = 0; }},
        {"fields larger than the buffer", fov,
         [](File& f) { f.records[fov].fields = std::string(7U << 20U, '\0'); }},
        {"a payload larger than the buffer", first,
         [](File& f) { f.records[first].payload = std::string(7U << 20U, '\x66'); }},
        {"a payload in a record that has none", fov, [](File& f) { f.records[fov].payload = "NIR"; }},
        {"a node that the player has no room for", fov, [](File& f) { f.records[fov].node = 2; }},
        {"a node that was not added", fov, [](File& f) { f.records[fov].node = 0; }},
        {"an unknown type", fov, [](File& f) { f.records[fov].type = 0x0F; }},
        {"a stream of an older format", added, [](File& f) { f.records[added].type = 0x0C; }},
        {"a stream with less fields", added, [](File& f) { f.records[added].fields.pop_back(); }},
        {"a name that is too long", added, [](File& f) { f.name = std::string(80, 'n'), f.refresh(); }},
        {"a kind of stream that is none", added, [](File& f) { f.type = 1, f.refresh(); }},
        {"no codec", added, [](File& f) { f.codec = std::string(4, '\0'), f.refresh(); }},
        {"JPEG", added, [](File& f) { f.type = 3, f.codec = "JPEG", f.refresh(); }},
        {"Im8z", added, [](File& f) { f.type = 3, f.codec = "Im8z", f.refresh(); }},
        {"16zT of colours", added, [](File& f) { f.type = 3, f.refresh(); }},
        {"a property's name beyond ASCII", fov, [](File& f) { f.records[fov].fields[5] = '\x80'; }},
        {"a stream's name beyond ASCII", added, [](File& f) { f.name = "D\xFFpth", f.refresh(); }},
        {"a text without an end", fov, [](File& f) { f.records[fov].fields[4 + 5] = 'x'; }},
        {"a value beyond its record", fov, [](File& f) { f.records[fov].fields[4 + 6] = '\x7F'; }},
        {"a number of 4 bytes", format,
         [](File& f) { f.records[format] = property("oniPixelFormat", std::string(4, '\0'), 0x03); }},
        {"a field of view of 8 bytes", fov,
         [](File& f) { f.records[fov] = property("xnFOV", std::string(8, '\0')); }},
        {"a mode of 4 bytes", mode_at,
         [](File& f) { f.records[mode_at] = property("xnMapOutputMode", std::string(4, '\0')); }},
        {"huge pictures", mode_at, [](File& f) { f.records[mode_at] = mode(4096, 4096); }},
        {"pictures of no width", mode_at, [](File& f) { f.records[mode_at] = mode(0, 2); }},
        {"huge frames", bytes,
         [](File& f) { f.records[bytes] = number("oniRequiredFrameSize", 1ULL << 31U); }},
        {"frames too small for the pictures", ready,
         [](File& f) { f.records[bytes] = number("oniRequiredFrameSize", 15); }},
        {"pictures that change their size", first, [&](File& f) { insert(f, first, mode(1600, 1200)); }},
        {"frames that change their size", first,
         [&](File& f) { insert(f, first, number("oniRequiredFrameSize", 1600 * 1200 * 2)); }},
        {"a format before the mode", mode_at,
         [](File& f) { std::swap(f.records[mode_at], f.records[format]); }},
        {"depth of another unit", format, [](File& f) { f.records[format] = number("oniPixelFormat", 101); }},
        {"a stream twice", begun, [&](File& f) { insert(f, begun, f.records[added]); }},
        {"ready twice", begun, [&](File& f) { insert(f, begun, f.records[ready]); }},
        {"a frame before the data begin", begun,
         [](File& f) { std::swap(f.records[begun], f.records[first]); }},
        {"a frame after the removal", table, [&](File& f) { insert(f, table, f.records[first]); }},
        {"a frame with less fields", first, [](File& f) { f.records[first].fields.pop_back(); }},
        {"a frame of more pixels", first, [](File& f) { f.records[first].payload += "\xFE"; }},
        {"a frame of fewer pixels", first, [](File& f) { f.records[first].payload.pop_back(); }},
        {"an uncompressed frame of more pixels", first,
         [](File& f) {
             f.codec = "NONE";
             f.records[first].payload = std::string(18, 'x');
             f.refresh();
         }},
        {"a frame that ends in a code", first, [](File& f) { f.records[first].payload.back() = '\xFF'; }},
        {"a table beyond the frame", first, [](File& f) { f.records[first].payload[1] = '\x7F'; }},
        {"a number beyond the table", first,
         [&](File& f) { f.records[first].payload = in_a_table(1, bytes_of(std::uint16_t{1}) + "\xE3\x6D"); }},
        {"an empty frame", first, [](File& f) { f.records[first].payload = ""; }},
        {"a table with fields", table, [](File& f) { f.records[table].fields = std::string(64, 'x'); }},
        {"a table for other frames", table,
         [](File& f) { f.records[table].payload += std::string(20, 'x'); }},
        {"a table's place elsewhere", end, [](File& f) { f.table_off = 1, f.refresh(); }},
        {"a place in the table where no frame is", table, [](File& f) { f.entry_off = 1, f.refresh(); }},
        {"the end before the stream's", removed,
         [](File& f) { f.records[removed] = f.records[end], f.refresh(); }},
    };
    for (const Damage& damage : damages) {
        SCOPED_TRACE(damage.name);
        File file;
        damage.make(file);
        const auto fault = fault_in(file.whole());
        ASSERT_TRUE(fault);
        EXPECT_EQ(fault->position, file.place(damage.at)) << fault->what;
    }
}

TEST_F(OniCheckTest, a_file_header_of_anything_else_is_a_fault_at_its_begin) {
    for (const std::size_t at : {0U, 3U, 4U, 6U, 8U}) {
        File file;
        file.header[at] = static_cast<char>(file.header[at] + 1);
        EXPECT_EQ(fault_in(file.whole()).value().position, 0U) << at;
    }
    File file;
    file.header[23] = '\x7F';  // streams that the player would make room for
    EXPECT_EQ(fault_in(file.whole()).value().position, 0U);
    EXPECT_EQ(fault_of(scratch_ / "absent.oni").value().position, 0U);
}

TEST_F(OniCheckTest, says_at_each_record_that_it_goes_on) {
    int records = 0;
    EXPECT_EQ(fault_of(scratch_.write("x.oni", File().whole()), [&] { ++records; }), std::nullopt);
    EXPECT_EQ(records, 12);
}

std::optional<std::size_t> plain_depths(const std::string& packed) {
    return depths_in({reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size()},
                     DepthPacking::plain);
}

TEST(PackedDepthTest, counts_as_the_decoder_does) {
    const std::string start = bytes_of(std::uint16_t{500});
    EXPECT_EQ(plain_depths(start), 1U);
    EXPECT_EQ(plain_depths(start + "\x66"), 3U);
    EXPECT_EQ(plain_depths(start + "\x6D"), 2U);
    EXPECT_EQ(plain_depths(start + "\xE0"), 1U);
    EXPECT_EQ(plain_depths(start + "\xFE"), 61U);
    EXPECT_EQ(plain_depths(start + "\xFF\x80"), 2U);
    EXPECT_EQ(plain_depths(start + "\xFF\x7F\x01"), 2U);
    EXPECT_EQ(plain_depths(start + "\x6F\x7F\x01"), 3U);
    EXPECT_EQ(plain_depths(start + "\xFF\x7F"), std::nullopt);
    EXPECT_EQ(plain_depths(start + "\x6F"), std::nullopt);
    EXPECT_EQ(plain_depths("x"), std::nullopt);
    EXPECT_EQ(plain_depths(""), std::nullopt);
}

}  // namespace
}  // namespace octoskin::openni2
