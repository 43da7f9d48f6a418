#include "host/lab/report/text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

namespace octoskin::report {
namespace {

/// Oracle: the JSON library refuses to write a string that is not UTF-8.
bool is_utf8(const std::string& text) {
    try {
        (void)nlohmann::json(text).dump();
        return true;
    } catch (const nlohmann::json::type_error&) {
        return false;
    }
}

TEST(Escaped, disarms_what_html_would_understand) {
    EXPECT_EQ(escaped("<b class=\"x\">Tom & 'Jerry'</b>"),
              "&lt;b class=&quot;x&quot;&gt;Tom &amp; &#39;Jerry&#39;&lt;/b&gt;");
}

TEST(Escaped, keeps_text_of_any_script) {
    EXPECT_EQ(escaped("café ± 漢字 \U0001F916"), "café ± 漢字 \U0001F916");
}

TEST(Escaped, replaces_bytes_that_are_not_utf8) {
    EXPECT_EQ(escaped("caf\xe9"), "caf\ufffd");
    EXPECT_EQ(escaped("\xc3"), "\ufffd");
    EXPECT_EQ(escaped("\xed\xa0\x80"), "\ufffd\ufffd\ufffd") << "a surrogate";
    EXPECT_EQ(escaped("\xc0\xaf"), "\ufffd\ufffd") << "an overlong slash";
    EXPECT_EQ(escaped(std::string_view("a\0b", 3)), "a\ufffdb");
}

TEST(Escaped, is_utf8_for_every_two_bytes_and_unchanged_if_they_were) {
    for (unsigned first = 0; first < 256; ++first) {
        for (unsigned second = 0; second < 256; ++second) {
            const std::string text = {static_cast<char>(first), static_cast<char>(second)};
            const std::string safe = escaped(text);
            ASSERT_TRUE(is_utf8(safe)) << first << ' ' << second;
            if (first >= 0x80 && is_utf8(text)) {
                ASSERT_EQ(safe, text) << first << ' ' << second;
            }
        }
    }
}

TEST(Escaped, is_utf8_for_random_bytes_and_unchanged_if_they_were) {
    std::mt19937 random(7);
    int kept = 0;
    for (int i = 0; i < 50000; ++i) {
        // Mostly lead and continuation bytes, so that valid sequences of three and four do occur.
        std::string text;
        text += static_cast<char>(0xE0 + random() % 0x16);
        for (unsigned j = 0; j < 2 + random() % 2; ++j) {
            text += static_cast<char>(0x80 + random() % 0x42);
        }
        const std::string safe = escaped(text);
        ASSERT_TRUE(is_utf8(safe)) << i;
        if (is_utf8(text)) {
            ASSERT_EQ(safe, text) << i;
            ++kept;
        }
    }
    EXPECT_GT(kept, 2000);
}

TEST(CountText, groups_thousands_with_narrow_spaces) {
    EXPECT_EQ(count_text(0), "0");
    EXPECT_EQ(count_text(999), "999");
    EXPECT_EQ(count_text(27510), "27\u202f510");
    EXPECT_EQ(count_text(1234567.4), "1\u202f234\u202f567");
    EXPECT_EQ(count_text(-629.2), "\u2212629");
    EXPECT_EQ(count_text(-0.4), "0");
}

TEST(RatioText, rounds_and_never_says_minus_zero) {
    EXPECT_EQ(ratio_text(0.62049), "0.620");
    EXPECT_EQ(ratio_text(-0.0267), "\u22120.027");
    EXPECT_EQ(ratio_text(-0.0002), "0.000");
    EXPECT_EQ(ratio_text(12.345, 2), "12.35");
}

TEST(PercentText, has_one_decimal_and_a_space_that_does_not_break) {
    EXPECT_EQ(percent_text(0.1094), "10.9\u00a0%");
    EXPECT_EQ(percent_text(-0.299), "\u221229.9\u00a0%");
}

TEST(SummaryText, shows_mean_spread_and_sign) {
    const evaluation::Summary voxels{2165.4, 30.2, {}};
    EXPECT_EQ(summary_text(voxels, {.is_count = true}), "2\u202f165 ± 30");
    EXPECT_EQ(summary_text(voxels, {.is_count = true, .is_difference = true}), "+2\u202f165 ± 30");
    const evaluation::Summary difference{-0.0181, 0.0133, {}};
    EXPECT_EQ(summary_text(difference, {.is_difference = true}), "\u22120.018 ± 0.013");
    EXPECT_EQ(summary_text({0.5, std::nullopt, {}}, {}), "0.500") << "one seed has no spread";
    EXPECT_EQ(summary_text({}, {}), "\u2013");
}

}  // namespace
}  // namespace octoskin::report
