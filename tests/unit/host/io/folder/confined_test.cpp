#include "host/io/folder/confined.hpp"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;
using testing_support::ScratchFolder;

/// What is read of the place; empty if it cannot be opened.
std::string text_of(const FilePlace& place) {
    const auto opened = place.open();
    return opened ? opened->read(100).value() : "";
}

TEST(ConfinedToRecording, a_file_beside_a_log_or_a_meta_is_below_that_folder_however_it_is_named) {
    for (const char* mark : {"can.log", "meta.yaml"}) {
        const ScratchFolder scratch;
        fs::create_directories(scratch / "rec/sub");
        scratch.write(std::string("rec/") + mark, "");
        scratch.write("rec/rig.yaml", "of the recording");
        scratch.write("outside", "a secret");
        fs::create_symlink("../outside", scratch / "rec/link.yaml");
        fs::create_directory_symlink("rec", scratch / "rec2");
        fs::create_symlink("rec/rig.yaml", scratch / "rig.yaml");
        for (const char* name : {"rec/rig.yaml", "rec/sub/../rig.yaml", "rec2/rig.yaml", "rig.yaml"}) {
            const FilePlace place = confined_to_recording(scratch / name);
            ASSERT_NE(place.folder(), nullptr) << name;
            EXPECT_EQ(text_of(place), "of the recording") << name;
            EXPECT_EQ(text_of(place.beside("../outside")), "") << name;
            EXPECT_EQ(text_of(place.beside((scratch / "outside").string())), "") << name;
        }
        EXPECT_EQ(text_of(confined_to_recording(scratch / "rec/link.yaml")), "");
    }
}

TEST(ConfinedToRecording, a_link_in_the_place_of_the_log_marks_a_recording_as_well) {
    const ScratchFolder scratch;
    fs::create_directory(scratch / "rec");
    fs::create_symlink("/nonexistent", scratch / "rec/can.log");
    scratch.write("rec/rig.yaml", "rig");
    EXPECT_NE(confined_to_recording(scratch / "rec/rig.yaml").folder(), nullptr);
}

TEST(ConfinedToRecording, any_other_place_stays_as_it_is) {
    const ScratchFolder scratch;
    const auto file = scratch.write("rig.yaml", "rig");
    scratch.write("other.yaml", "other");
    const FilePlace place = confined_to_recording(file);
    EXPECT_EQ(place.folder(), nullptr);
    EXPECT_EQ(text_of(place.beside((scratch / "other.yaml").string())), "other");
    EXPECT_EQ(confined_to_recording(scratch / "none").folder(), nullptr);
    EXPECT_TRUE(confined_to_recording(FilePlace()).empty());
    const FilePlace below(NamedFolder(scratch.path()), "rig.yaml");
    EXPECT_EQ(text_of(confined_to_recording(below)), "rig");
}

}  // namespace
}  // namespace octoskin
