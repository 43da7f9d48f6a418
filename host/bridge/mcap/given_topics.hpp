// Topics of a bag that the user named.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/errors/error.hpp"

namespace octoskin::bridge {

/// Error (unknown_name): the bag does not have one of them; with the most similar of its topics, or the
/// first few. `option`: that which gave them.
[[nodiscard]] Status<Error> check_given_topics(const std::vector<std::string>& given,
                                               const std::set<std::string>& topics_of_bag,
                                               const std::string& option);

}  // namespace octoskin::bridge
