#include "host/io/digest/sha256.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

// Values of FIPS 180-4's examples.
TEST(Sha256, equals_published_values) {
    EXPECT_EQ(sha256_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_of(std::string(1'000'000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, of_parts_is_that_of_the_whole_and_fields_are_kept_apart) {
    Sha256 parts;
    parts.add("a");
    parts.add("bc");
    EXPECT_EQ(parts.hexadecimal(), sha256_of("abc"));
    Sha256 one;
    one.add_field("a");
    one.add_field("bc");
    Sha256 other;
    other.add_field("ab");
    other.add_field("c");
    EXPECT_NE(one.hexadecimal(), other.hexadecimal());
}

}  // namespace
}  // namespace octoskin
