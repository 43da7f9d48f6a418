// What `record start` is given: a folder that is taken is absolute, plain, and can be shown as it is.
#include <cassert>

#include "host/apps/daemon/record_requests.hpp"
#include "host/core/text/printable.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    const auto start = read_record_start(fuzz::text_of({data, size}));
    if (!start) {
        assert(!start.error().message().empty());
        return 0;
    }
    assert(start->folder.is_absolute() && plain(start->folder) == start->folder);
    assert(printable(start->folder.string()) == start->folder.string());
    assert(!start->limit || (start->limit->count() >= 0 && start->limit->count() <= 1'000'000'000'000'000));
    return 0;
}
