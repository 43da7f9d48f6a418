#include "hw/dbc/dbc_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "common/wire/codec.hpp"
#include "hw/dbc/field_meanings.hpp"
#include "hw/dbc/signals.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin::dbc {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string text_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

TEST(Dbc, shipped_file_is_what_the_layouts_give) {
    EXPECT_EQ(text_of(OCTOSKIN_SOURCE_DIR "/hw/octoskin.dbc"), dbc_text(shipped_nodes()))
        << "the wire has changed: build/host-release/bin/write_dbc > hw/octoskin.dbc";
}

/// "range_2" of a RANGE_FD is "range2" in the table of cases; the joints of a pair have no number there.
std::string plain(std::string name) {
    std::erase(name, '_');
    return name;
}

TEST(Dbc, every_field_is_a_signal_of_its_name_where_the_protocol_says) {
    for (const test::MessageCase& layout : test::all_message_cases()) {
        const auto signals = signals_of(type_of(layout.message));
        for (const test::FieldCase& field : layout.fields) {
            const std::string name = field.name == "position_even"   ? "position2"
                                     : field.name == "position_odd"  ? "position3"
                                     : field.name == "position_last" ? "position6"
                                                                     : plain(field.name);
            const auto signal =
                std::ranges::find(signals, name, [](const Signal& s) { return plain(s.name); });
            ASSERT_NE(signal, signals.end()) << layout.name << " " << field.name;
            EXPECT_EQ(signal->start, field.start) << layout.name << " " << field.name;
            EXPECT_EQ(signal->bits, field.bits) << layout.name << " " << field.name;
        }
    }
}

TEST(Dbc, names_are_unique_within_a_message) {
    for (const wire::FrameSpec& spec : wire::kFrameSpecs) {
        std::set<std::string> names;
        for (const Signal& signal : signals_of(spec.type)) {
            EXPECT_TRUE(names.insert(signal.name).second) << spec.name << " " << signal.name;
        }
    }
}

TEST(Dbc, a_node_sends_what_its_kind_does_and_receives_commands) {
    const std::string board = dbc_text({{9, NodeKind::sensor_board, "Board"}});
    for (const char* message :
         {"BO_ 585 RANGE_FD_9: 64 Board", "BO_ 521 RANGE_9: 8 Board", "BO_ 777 RANGE_AUX_9: 8 Board",
          "BO_ 649 SENSOR_HEALTH_9: 8 Board", "BO_ 329 HEARTBEAT_9: 8 Board", "BO_ 713 NODE_INFO_9: 8 Board",
          "BO_ 457 SYNC_REPORT_9: 7 Board", "BO_ 201 COMMAND_9: 7 Host", "BO_ 255 COMMAND_all: 7 Host",
          "BO_ 64 SYNC: 3 Host"}) {
        EXPECT_THAT(board, HasSubstr(message));
    }
    EXPECT_THAT(board, Not(HasSubstr("JOINT_STATE")));
    const std::string joints = dbc_text({{10, NodeKind::joint_source, "Joints"}});
    EXPECT_THAT(joints, HasSubstr("BO_ 394 JOINT_STATE_10: 8 Joints"));
    EXPECT_THAT(joints, HasSubstr("BO_ 330 HEARTBEAT_10: 8 Joints"));
    for (const char* message : {" RANGE_10:", " RANGE_FD_10:", " RANGE_AUX_10:", " SENSOR_HEALTH_10:"}) {
        EXPECT_THAT(joints, Not(HasSubstr(message)));
    }
}

TEST(Dbc, a_node_is_given_as_its_id_and_kind) {
    const auto board = node_from_text("62:board");
    ASSERT_TRUE(board);
    EXPECT_EQ(board->node_id, 62);
    EXPECT_EQ(board->kind, NodeKind::sensor_board);
    EXPECT_EQ(board->name, "Board62");
    const auto joints = node_from_text("1:joints");
    ASSERT_TRUE(joints);
    EXPECT_EQ(joints->kind, NodeKind::joint_source);
    EXPECT_EQ(joints->name, "Joints1");
    for (const char* text : {"", "board", "1", "1:", "1:board ", ":board", "0:board", "63:board", "-1:board",
                             "4294967297:board", "1:camera", "1 :board"}) {
        EXPECT_FALSE(node_from_text(text)) << text;
    }
}

TEST(Dbc, units_and_factors_are_those_of_the_protocol) {
    const std::string text = dbc_text(shipped_nodes());
    for (const char* line :
         {" SG_ range : 18|13@1+ (1,0) [0|8191] \"mm\" Host\n",
          " SG_ sigma : 31|7@1+ (1,0) [0|127] \"mm\" Host\n",
          " SG_ capture_time : 38|12@1+ (64,0) [0|262080] \"us\" Host\n",
          " SG_ sigma_0 : 45|16@1+ (0.25,0) [0|16383.75] \"mm\" Host\n",
          " SG_ ambient : 31|16@1+ (0.0078125,0) [0|511.9921875] \"Mcps\" Host\n",
          " SG_ position_6 m3 : 8|24@1- (1e-06,0) [-8.388608|8.388607] \"rad\" Host\n",
          " SG_ period_error : 48|8@1- (0.1,0) [-12.8|12.7] \"%\" Host\n",
          " SG_ uptime m3 : 40|16@1+ (1,0) [0|65535] \"s\" Host\n",
          " SG_ count M : 3|3@1+ (1,0) [1|4] \"\" Host\n",
          " SG_ crc_of_2 m2 : 247|16@0+ (1,0) [0|65535] \"\" Host\n", "BA_ \"VFrameFormat\" BO_ 577 14;\n",
          " SG_ range_0 : 29|16@1+ (1,0) [0|65535] \"mm\" Host\n",
          " SG_ range_3 m4 : 365|16@1+ (1,0) [0|65535] \"mm\" Host\n", "SG_MUL_VAL_ 577 range_1 count 2-4;\n",
          "SG_MUL_VAL_ 577 range_3 count 4-4;\n", "SG_MUL_VAL_ 578 crc_of_2 count 2-2;\n"}) {
        EXPECT_THAT(text, HasSubstr(line));
    }
    EXPECT_THAT(text, Not(HasSubstr("BA_ \"VFrameFormat\" BO_ 513")));
}

TEST(Dbc, each_field_has_one_meaning_and_each_meaning_a_field) {
    std::multiset<std::string> meanings;
    for (const FieldMeaning& meaning : field_meanings()) {
        meanings.insert(std::string(frame_spec(meaning.type)->name) + " " + std::string(meaning.field));
    }
    std::set<std::string> fields;
    for (const wire::FrameSpec& spec : wire::kFrameSpecs) {
        for (const Signal& signal : signals_of(spec.type)) {
            EXPECT_EQ(signal.field.empty(), signal.name == "version" || signal.name.starts_with("crc"))
                << spec.name << " " << signal.name;
            EXPECT_EQ(signal.field.empty(), signal.meaning.empty()) << spec.name << " " << signal.name;
            if (!signal.field.empty()) fields.insert(spec.name + (" " + signal.field));
        }
    }
    EXPECT_EQ(meanings, std::multiset<std::string>(fields.begin(), fields.end()));
}

TEST(Dbc, each_value_with_a_meaning_is_one_of_its_field) {
    std::set<std::string> seen;
    for (const ValueMeaning& meaning : value_meanings()) {
        const std::string name = std::string(frame_spec(meaning.type)->name) + " " +
                                 std::string(meaning.field) + " " + std::string(meaning.value);
        EXPECT_TRUE(seen.insert(name).second) << name;
        const auto is_of_value = [&meaning](const Signal& signal) {
            return signal.field == meaning.field &&
                   std::ranges::any_of(signal.values, [&meaning](const auto& value) {
                       return value.second == meaning.value;
                   });
        };
        EXPECT_TRUE(std::ranges::any_of(signals_of(meaning.type), is_of_value)) << name;
        EXPECT_TRUE(meaning.detail.empty() || !detail_field(meaning.type, meaning.field).empty()) << name;
    }
}

TEST(Dbc, each_message_has_one_time_of_sending) {
    std::multiset<std::string> timed;
    for (const SendingTime& time : sending_times()) timed.insert(frame_spec(time.type)->name);
    std::multiset<std::string> all;
    for (const wire::FrameSpec& spec : wire::kFrameSpecs) all.insert(spec.name);
    EXPECT_EQ(timed, all);
}

TEST(Dbc, meanings_are_comments_of_the_signals) {
    const std::string text = dbc_text(shipped_nodes());
    EXPECT_THAT(text, HasSubstr("CM_ SG_ 513 range \"negative is sent as 0; saturates at 8191\";\n"));
    EXPECT_THAT(text, HasSubstr("CM_ SG_ 577 sensor_3 \"local index on the node\";\n"));
    for (const FieldMeaning& meaning : field_meanings()) {
        EXPECT_THAT(meaning.text, Not(HasSubstr("\""))) << meaning.field;
    }
}

TEST(DbcDeathTest, asserts_on_a_type_that_has_no_layout) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_DEATH(static_cast<void>(signals_of(static_cast<wire::FrameType>(14))), "spec");
}

}  // namespace
}  // namespace octoskin::dbc
