// A mapping file: read, or refused with a reason; what is read has a text that reads the same.
#include <cassert>

#include "host/io/mapping/mapping_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    static const fuzz::InputDirectory directory;
    const auto config = read_mapping(directory.write("input.yaml", fuzz::text_of({data, size})).string());
    if (!config) {
        assert(!config.error().message().empty());
        return 0;
    }
    const std::string text = mapping_text(*config);
    const auto again = read_mapping(directory.write("written.yaml", text).string());
    assert(again && *again == *config);
    assert(mapping_text(*again) == text);
    return 0;
}
