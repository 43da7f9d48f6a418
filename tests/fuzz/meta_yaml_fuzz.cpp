// A recording's meta.yaml: read, or refused with its file and a reason; what is read is written back as the
// same.
#include <cassert>

#include "host/apps/recording/recording.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

namespace octoskin {
namespace {

bool is_same(const SourceFile& a, const SourceFile& b) {
    // Without a file there is nothing that a checksum could be of: it is not written.
    return a.file == b.file && (a.file.empty() || a.crc32 == b.crc32);
}

void check(const RecordingPaths& recording) {
    const auto meta = read_meta(recording);
    if (!meta) {
        assert(!meta.error().what.empty() && meta.error().file == recording.meta().shown());
        return;
    }
    assert(write_meta(recording, *meta));
    const auto again = read_meta(recording);
    assert(again);
    assert(again->made_by == meta->made_by && again->source == meta->source);
    assert(is_same(again->world, meta->world) && is_same(again->scenario, meta->scenario));
    assert(is_same(again->rig, meta->rig));
    assert(again->seed == meta->seed && again->is_depth_noise_free == meta->is_depth_noise_free);
    assert(again->can_frames == meta->can_frames && again->depth_frames == meta->depth_frames);
    assert(again->duration_s == meta->duration_s);
}

}  // namespace
}  // namespace octoskin

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    static const fuzz::InputDirectory directory;
    const auto file = directory.write("meta.yaml", fuzz::text_of({data, size}));
    check(RecordingPaths(file.parent_path()));
    return 0;
}
