#include "host/bridge/mcap/given_topics.hpp"

#include "host/bridge/robot/first_names.hpp"
#include "hw/rigfile/key_hint.hpp"

namespace octoskin::bridge {
namespace {

std::string remedy_for(const std::string& topic, const std::vector<std::string>& names) {
    if (const auto near = rig::nearest_word(topic, names)) return "did you mean " + *near + "?";
    return names.empty() ? "it has none" : "it has " + first_names(names);
}

}  // namespace

Status<Error> check_given_topics(const std::vector<std::string>& given,
                                 const std::set<std::string>& topics_of_bag, const std::string& option) {
    for (const std::string& topic : given) {
        if (topics_of_bag.contains(topic)) continue;
        return unexpected(Error{.code = ErrorCode::unknown_name,
                                .what = "expected a topic of the bag",
                                .value = "'" + topic + "'",
                                .remedy = remedy_for(topic, {topics_of_bag.begin(), topics_of_bag.end()}),
                                .key = option});
    }
    return Done{};
}

}  // namespace octoskin::bridge
