// The declarations of the keys of a board's hardware file against the reader: ranges and required keys.
#include "hw/rigfile/hardware_keys.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hw/rigfile/board_hardware.hpp"
#include "hw/rigfile/document.hpp"
#include "tests/support/declared_keys.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::refusal_of;
using testing_support::value_at;

/// The keys of a memory range are declared once for three ranges; of the pins the first is an output.
std::string full_path(std::string_view path) {
    constexpr std::string_view kAnyRange = "memory.*";
    return path.starts_with(kAnyRange) ? fmt::format("memory.ram{}", path.substr(kAnyRange.size()))
                                       : std::string(path);
}

std::vector<AnyKey> all_keys() {
    std::vector<AnyKey> keys;
    for (const KeyTable& table : hardware_key_tables())
        keys.insert(keys.end(), table.keys.begin(), table.keys.end());
    return keys;
}

class HardwareKeys : public testing::Test {
  protected:
    /// The message about the shipped file with one value changed; "no error" if it is read.
    std::string message_with(std::string_view path, const std::string& text) {
        Value top = shipped();
        Value& value = value_at(top, full_path(path));
        value = testing_support::scalar(value.key, text);
        return message_of(top);
    }
    std::string message_without(std::string_view path) {
        Value top = shipped();
        Value& value = value_at(top, full_path(path));
        value.kind = Value::Kind::null;
        value.items.clear();
        return message_of(top);
    }

  private:
    static Value shipped() {
        return load_document(OCTOSKIN_SOURCE_DIR "/hw/boards/nucleo_g474re.hardware.yaml");
    }
    std::string message_of(const Value& top) {
        const auto board = read_board_hardware(folder_.write("board.hardware.yaml", document_text(top)));
        return board ? "no error" : board.error().message();
    }

    testing_support::ScratchFolder folder_;
};

TEST_F(HardwareKeys, whole_numbers_are_refused_just_outside_of_the_declared_range_and_not_at_its_ends) {
    int checked = 0;
    for (const AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const IntegerKey*>(&any);
        if (key == nullptr) continue;
        const auto [min, max] = (*key)->range;
        const std::string refusal = refusal_of(any) + ", found";
        for (const std::int64_t outside : {min - 1, max + 1})
            EXPECT_THAT(message_with((*key)->path, fmt::format("{}", outside)), HasSubstr(refusal))
                << (*key)->path;
        for (const std::int64_t end : {min, max})
            EXPECT_THAT(message_with((*key)->path, fmt::format("{}", end)), Not(HasSubstr(refusal)))
                << (*key)->path;
        ++checked;
    }
    EXPECT_EQ(checked, 10);
}

TEST_F(HardwareKeys, a_required_key_is_required) {
    EXPECT_EQ(message_with("name", "another"), "no error");
    int checked = 0;
    for (const AnyKey& key : all_keys()) {
        if (default_text(key) != "required") continue;
        EXPECT_THAT(message_without(path_of(key)), HasSubstr("expected this key, found none"))
            << path_of(key);
        ++checked;
    }
    EXPECT_EQ(checked, 24);
}

}  // namespace
}  // namespace octoskin::rig
