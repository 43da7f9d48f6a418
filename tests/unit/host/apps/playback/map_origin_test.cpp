#include "host/apps/playback/map_origin.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

/// The bytes of these files one after the other.
std::optional<std::uint32_t> crc32_of_text(const std::string& text) {
    const ScratchFolder folder;
    return crc32_of(FilePlace(folder.write("all", text)));
}

TEST(ChecksumOfRecording, is_that_of_the_log_the_images_and_the_order) {
    const ScratchFolder folder;
    const RecordingPaths recording(folder.path());
    EXPECT_FALSE(crc32_of_recording(recording)) << "without a log";
    folder.write("can.log", "log,");
    folder.write("rig.yaml", "not counted");
    EXPECT_EQ(crc32_of_recording(recording), crc32_of_text("log,"));
    folder.write("depth.oni", "oni,");
    folder.write("depth.epoch.yaml", "epoch,");
    folder.write("order.log", "order,");
    folder.write("first.snapshot", "first");
    EXPECT_EQ(crc32_of_recording(recording), crc32_of_text("log,oni,epoch,order,first"));
}

TEST(ChecksumOfRecording, takes_the_cameras_in_the_order_of_their_names) {
    const ScratchFolder folder;
    const RecordingPaths recording(folder.path());
    std::filesystem::create_directory(folder / "depth");
    for (const char* name : {"right", "left"}) {
        folder.write(std::string("depth/") + name + ".oni", std::string(name) + ",");
        folder.write(std::string("depth/") + name + ".epoch.yaml", std::string(name) + " epoch,");
    }
    folder.write("depth/notes.txt", "not counted");
    folder.write("can.log", "log,");
    folder.write("order.log", "order");
    EXPECT_EQ(crc32_of_recording(recording), crc32_of_text("log,left,left epoch,right,right epoch,order"));
    folder.write("depth.oni", "oni,");
    EXPECT_EQ(crc32_of_recording(recording),
              crc32_of_text("log,oni,left,left epoch,right,right epoch,order"));
}

}  // namespace
}  // namespace octoskin
