#include "host/apps/daemon/problem.hpp"

namespace octoskin {

std::string Problem::text() const {
    std::string text = on;
    for (const std::string* part : {&what, &remedy}) {
        if (part->empty()) continue;
        if (!text.empty()) text.append(": ");
        text.append(*part);
    }
    return text;
}

}  // namespace octoskin
