// A query as it comes on the control socket: what is read can be asked, and is the same when it is written
// and read again.
#include <cassert>

#include "host/apps/query/query_request.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    const std::string line = "query " + std::string(fuzz::text_of({data, size}));
    const auto request = read_query(line);
    if (!request) {
        assert(!request.error().message().empty());
        return 0;
    }
    assert(is_query(line) && !fault_of(*request));
    const std::string written = to_line(*request);
    const auto again = read_query(written);
    assert(again && to_line(*again) == written);
    return 0;
}
