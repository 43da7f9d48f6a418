// Small files that a parser takes long over: whatever is in them, they are read or refused within a second of
// processor time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/nesting.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::is_no_error;
using testing_support::line_is;
using testing_support::no_error;
using testing_support::value_is;
using testing_support::what_is;

constexpr double kSecondsMax = 1.0;

double processor_seconds(const std::function<void()>& work) {
    const auto now = [] {
        timespec time{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    };
    const double begun = now();
    work();
    return now() - begun;
}

/// `text` again and again, up to `size` bytes.
std::string repeated(const std::string& text, std::size_t size) {
    std::string all;
    while (all.size() + text.size() <= size) all += text;
    return all;
}

/// What is wrong with it; `no_error`: nothing.
Error load(const std::filesystem::path& file) {
    try {
        (void)load_document(file);
        return no_error();
    } catch (const Error& error) {
        return error;
    }
}

constexpr std::size_t kYamlMax = 256U << 10U;
constexpr std::size_t kUrdfMax = 16U << 20U;

std::string keys(std::size_t count, std::size_t per_table) {
    std::string text;
    for (std::size_t i = 0; i < count && text.size() < kYamlMax - 40; ++i) {
        if (i % per_table == 0) text += "t" + std::to_string(i) + ":\n";
        text += " k" + std::to_string(i) + ":\n";
    }
    return text;
}

TEST(SlowFile, of_yaml_is_read_or_refused_within_a_second) {
    const testing_support::ScratchFolder folder;
    const std::vector<std::pair<const char*, std::string>> files = {
        {"keys in one table", keys(100'000, 100'000)},
        {"keys in tables of a thousand", keys(100'000, 1'000)},
        {"open lists", "a: " + repeated("[", kYamlMax - 3)},
        {"open lists and closed ones in comments", "a: " + repeated("[#]]]]\n", kYamlMax - 3)},
        {"open lists and closed ones in quotes", "a: " + repeated("[\"]]\",", kYamlMax - 3)},
        {"open tables", "a: " + repeated("{b: ", kYamlMax - 3)},
        {"compact lists", "a:\n" + repeated("- ", kYamlMax - 3)},
        {"complex keys", repeated("? ", kYamlMax)},
        {"empty lists in a list", "a: [" + repeated("[],", kYamlMax - 5) + "]"},
        {"scalars in a list", "a: [" + repeated("1,", kYamlMax - 5) + "]"},
        {"tables in a list", "a: [" + repeated("{b: 1},", kYamlMax - 5) + "]"},
        {"a long scalar", "a: " + repeated("x", kYamlMax - 3)},
        {"a long quoted scalar", "a: \"" + repeated("\\\\u0041", kYamlMax - 5) + "\""},
        {"folded lines", "a: >\n" + repeated(" x\n", kYamlMax - 5)},
        {"blank lines", "a: 1\n" + repeated("\n", kYamlMax - 5)},
        {"deeper and deeper lines",
         [] {
             std::string text;
             for (std::size_t depth = 0; text.size() + depth + 4 < kYamlMax; ++depth)
                 text += std::string(depth, ' ') + "a:\n";
             return text;
         }()},
        {"colons", "a: " + repeated(":", kYamlMax - 3)},
        {"anchors", "a: " + repeated("&b ", kYamlMax - 3)},
        {"tags", "a: " + repeated("!b ", kYamlMax - 3)},
        {"directives", repeated("%YAML 1.2\n", kYamlMax)},
        {"documents", repeated("---\na: 1\n", kYamlMax)},
        {"tabs", "a:\n" + repeated("\t", kYamlMax - 3)},
        {"zero bytes", "a: " + std::string(kYamlMax - 3, '\0')}};
    for (const auto& [name, text] : files) {
        const auto file = folder.write("slow.yaml", text);
        Error error;
        const double took = processor_seconds([&] { error = load(file); });
        EXPECT_LT(took, kSecondsMax) << name << ": " << error.message();
    }
}

TEST(SlowFile, of_yaml_has_its_limits_named) {
    const testing_support::ScratchFolder folder;
    EXPECT_THAT(load(folder.write("most.yaml", keys(999, 2'000))), is_no_error());
    EXPECT_THAT(load(folder.write("more.yaml", keys(1'001, 2'000))),
                AllOf(code_is(ErrorCode::limit_exceeded), file_is("more.yaml"), line_is(1002),
                      what_is(HasSubstr("1000 keys in a table"))));
    EXPECT_THAT(load(folder.write("deep.yaml", "a: 1\nb: " + std::string(65, '['))),
                AllOf(code_is(ErrorCode::limit_exceeded), file_is("deep.yaml"), line_is(2),
                      what_is(HasSubstr("64 brackets"))));
    EXPECT_FALSE(deep_brackets("a: " + repeated("[[[1]]],", 100'000)));
}

/// A robot, with `more` in its first link.
std::string robot(const std::string& attributes, const std::string& more) {
    return "<robot name='r'" + attributes + "><link name='a'>" + more +
           "</link><link name='b'/><joint name='j' type='fixed'><parent link='a'/><child "
           "link='b'/></joint></robot>";
}

TEST(SlowFile, of_a_robot_is_read_or_refused_within_a_second) {
    const testing_support::ScratchFolder folder;
    std::string attributes;
    for (int i = 0; attributes.size() < (4U << 20U); ++i) attributes += " a" + std::to_string(i) + "=''";
    std::string deep;
    for (int i = 0; i < 300'000; ++i) deep += "<a>";
    const std::vector<std::pair<const char*, std::string>> files = {
        {"attributes of the root", robot(attributes, "")},
        {"attributes of a link's element", robot("", "<visual" + attributes + "/>")},
        {"attributes of a comment's neighbour", robot("", "<!-- < --><visual" + attributes + "/>")},
        {"deep elements", robot("", deep)},
        {"comments", robot("", repeated("<!---->", kUrdfMax / 4))},
        {"links", "<robot name='r'>" + repeated("<link name='a'/>", kUrdfMax / 4) + "</robot>"},
        {"unknown elements", robot("", repeated("<a/>", kUrdfMax / 4))},
        {"text", robot("", repeated("x ", kUrdfMax - 1'000))},
        {"entities", robot("", repeated("&lt;", kUrdfMax / 4))}};
    for (const auto& [name, text] : files) {
        const auto file = folder.write("slow.urdf", text);
        const double took = processor_seconds([&, place = file] { (void)read_capsules(place, {}); });
        EXPECT_LT(took, kSecondsMax) << name;
    }
}

TEST(SlowFile, of_a_robot_has_its_crowded_element_named) {
    std::string attributes;
    for (int i = 0; i < 101; ++i) attributes += " a" + std::to_string(i) + "='='";
    const auto fault = crowded_element("<robot>\n<link" + attributes + "/></robot>");
    ASSERT_TRUE(fault);
    EXPECT_THAT(*fault, AllOf(code_is(ErrorCode::limit_exceeded), line_is(2),
                              what_is(HasSubstr("100 attributes")), value_is("101")));
    EXPECT_FALSE(
        crowded_element("<!-- <link" + attributes + "/> --><a><![CDATA[<b" + attributes + ">]]></a>"));
    EXPECT_FALSE(crowded_element("<a b='" + repeated("c=d ", 4'000) + "'/>"));
}

}  // namespace
}  // namespace octoskin::rig
