#include "tests/ros/codec.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace octoskin::ros {

const Codec& find_codec(const std::string& name) {
    std::string short_name = name;
    if (const auto infix = name.find("/msg/"); infix != std::string::npos) {
        short_name.erase(infix, 4);
    }
    const auto& all = codecs();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Codec& codec) {
        return codec.name == short_name || codec.dds_name == name;
    });
    if (found == all.end()) {
        throw std::invalid_argument("no field list of type '" + name + "' in tests/ros/fields");
    }
    return *found;
}

Bytes read_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw std::runtime_error("cannot read '" + path + "'");
    }
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string line(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace octoskin::ros
