// Messages of a client of the view, as text and as bytes: each is a request within its limits, or refused by
// name.
#include <cassert>
#include <variant>

#include "host/bridge/view/foxglove.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin::foxglove {
namespace {

void check(const Result<Request, Fault>& parsed, std::size_t bytes) {
    if (!parsed) {
        assert(!name_of(parsed.error()).empty());
        return;
    }
    if (const auto* request = std::get_if<Subscribe>(&*parsed))
        assert(request->subscriptions.size() <= kListMax);
    if (const auto* request = std::get_if<Unsubscribe>(&*parsed))
        assert(request->subscriptions.size() <= kListMax);
    if (const auto* request = std::get_if<ServiceCall>(&*parsed))
        assert(request->encoding.size() + request->payload.size() + 13 == bytes);
    if (const auto* request = std::get_if<Unsupported>(&*parsed)) assert(request->operation.size() <= 64);
}

}  // namespace
}  // namespace octoskin::foxglove

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin::foxglove;
    const std::string_view bytes = octoskin::fuzz::text_of({data, size});
    check(parse_text(bytes), size);
    check(parse_binary(bytes), size);
    return 0;
}
