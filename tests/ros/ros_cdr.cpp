// Messages between JSON and bytes, without DDS: the README.md of this folder.
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>

#include "tests/ros/arguments.hpp"
#include "tests/ros/codec.hpp"

namespace octoskin::ros {
namespace {

constexpr const char* kUsage =
    R"(usage: ros_cdr decode TYPE [--all-bytes] < BYTES     prints the message as JSON and the number of unread bytes
       ros_cdr encode TYPE < JSON > BYTES           the fields of one message
       ros_cdr types                                prints the types with their hashes

The bytes begin with the four bytes of encapsulation. Exit code 1 if they are no message of the type.
)";

Bytes standard_input() {
    return {std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()};
}

void decode(const Codec& codec, const Shown& shown) {
    const Decoded decoded = codec.decode(standard_input(), shown);
    std::cout << line({{"unread", decoded.unread}, {"fields", decoded.fields}}) << '\n';
}

void encode(const Codec& codec) {
    const Bytes bytes = codec.encode(Json::parse(std::cin));
    std::cout.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void print_types() {
    for (const Codec& codec : codecs()) {
        std::cout << codec.name << ' ' << codec.dds_name << ' ' << codec.type_hash << '\n';
    }
}

int convert(int count, char** words) {
    const Arguments arguments(count, words, {"--all-bytes"}, {});
    const auto& rest = arguments.rest();
    if (rest == std::vector<std::string>{"types"}) {
        print_types();
    } else if (rest.size() == 2 && rest[0] == "decode") {
        decode(find_codec(rest[1]), {arguments.has("--all-bytes")});
    } else if (rest.size() == 2 && rest[0] == "encode") {
        encode(find_codec(rest[1]));
    } else {
        throw std::invalid_argument("needs decode TYPE, encode TYPE or types (--help)");
    }
    return 0;
}

}  // namespace
}  // namespace octoskin::ros

int main(int count, char** words) {
    return octoskin::ros::run_program(count, words, octoskin::ros::kUsage, &octoskin::ros::convert);
}
