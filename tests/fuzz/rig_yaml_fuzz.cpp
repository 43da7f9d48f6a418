// A rig file: read, or refused by its name; what is read has a canonical text that reads the same.
#include <cassert>

#include "hw/rigfile/rig.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

namespace octoskin::rig {
namespace {

class RigInput {
  public:
    RigInput() {
        for (const char* name : {"two-links.urdf", "small-board.yaml", "one-sensor.yaml"}) {
            directory_.offer(std::filesystem::path(OCTOSKIN_SOURCE_DIR "/tests/data/rigs") / name);
        }
    }
    void check(std::string_view text) const {
        const auto file = directory_.write("input.yaml", text);
        const auto rig = read_rig(file);
        if (!rig) {
            assert(!rig.error().what.empty() && !rig.error().file.empty());
            return;
        }
        const std::string canonical = canonical_text(*rig, rig->urdf.shown().string());
        const auto again = read_rig(directory_.write("canonical.yaml", canonical));
        assert(again);
        assert(canonical_text(*again, again->urdf.shown().string()) == canonical);
        assert(rig_hash(*again) == rig_hash(*rig));
    }

  private:
    fuzz::InputDirectory directory_;
};

}  // namespace
}  // namespace octoskin::rig

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const octoskin::rig::RigInput input;
    input.check(octoskin::fuzz::text_of({data, size}));
    return 0;
}
