#include "common/cut_text.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

TEST(CutText, keeps_what_is_short_enough) {
    EXPECT_EQ(cut_text("", 0), "");
    EXPECT_EQ(cut_text("pose", 4), "pose");
    EXPECT_EQ(cut_text("poses", 4), "pose...");
    EXPECT_EQ(cut_text("poses", 0), "...");
}

TEST(CutText, cuts_no_character_in_two) {
    EXPECT_EQ(cut_text("a\xC3\xA4\xC3\xB6", 4), "a\xC3\xA4...");
    EXPECT_EQ(cut_text("a\xC3\xA4\xC3\xB6", 3), "a\xC3\xA4...");
    EXPECT_EQ(cut_text("a\xC3\xA4\xC3\xB6", 2), "a...");
    EXPECT_EQ(cut_text("\x80\x80\x80", 2), "...");
}

}  // namespace
}  // namespace octoskin
