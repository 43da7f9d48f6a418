// The programs that the documents show do what the documents say, word for word.
#include <gmock/gmock.h>
#include <octomap/octomap.h>

#include <memory>
#include <sstream>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

/// The only block of Python under this heading.
std::string python_below(const std::string& document, const std::string& heading) {
    const std::string text = content(source(document));
    const std::string fence = "\n```python\n";
    const auto section = text.find("\n" + heading + "\n");
    const auto begin = section == std::string::npos ? section : text.find(fence, section);
    if (begin == std::string::npos) return {};
    const auto end = text.find("```", begin + fence.size());
    return text.substr(begin + fence.size(), end - begin - fence.size());
}

class DocumentedExample : public ProgramTest {
  protected:
    /// In the test's folder, with this octoskin on the PATH.
    [[nodiscard]] Said python(const std::string& program) const {
        write(path("example.py"), program);
        const auto programs = std::filesystem::path(OCTOSKIN_PROGRAM).parent_path().string();
        return run("cd " + directory_.string() + " && PATH=" + programs + ":$PATH python3 example.py");
    }
};

TEST_F(DocumentedExample, of_a_daemon_without_a_can_interface_makes_a_map) {
    record_short("bench");
    const std::string program =
        python_below("docs/reference/control-socket.md", "## A bus without a CAN interface");
    ASSERT_FALSE(program.empty());
    const Said said = python(program);
    EXPECT_EQ(said.exit_code, 0) << said.output;
    const std::unique_ptr<octomap::AbstractOcTree> map(octomap::AbstractOcTree::read(path("tried/fused.ot")));
    ASSERT_TRUE(map) << said.output;
    EXPECT_GT(map->size(), 1'000U) << said.output;
}

/// octomap_msgs and moveit_msgs have stand-ins with the fields of their messages. Its msgToMap makes a tree
/// of that resolution and lets it read `data`, as is done here.
TEST_F(DocumentedExample, of_a_ros_message_gives_octomap_the_map_that_was_saved) {
    record_short("bench");
    ASSERT_EQ(octoskin("replay " + path("bench") + " --fused-only").exit_code, 0);
    const std::string program = python_below("docs/how-to/query.md", "## ROS");
    ASSERT_FALSE(program.empty());
    std::filesystem::create_directories(path("octomap_msgs"));
    write(path("octomap_msgs/__init__.py"), "");
    write(path("octomap_msgs/msg.py"),
          "import types\nclass Octomap:\n    def __init__(self, binary, id, resolution):\n"
          "        self.binary, self.id, self.resolution = binary, id, resolution\n"
          "        self.header = types.SimpleNamespace()\n");
    std::filesystem::create_directories(path("moveit_msgs"));
    write(path("moveit_msgs/__init__.py"), "");
    write(path("moveit_msgs/msg.py"),
          "import types\nclass Fields:\n    def __getattr__(self, name):\n"
          "        if name.startswith('__'): raise AttributeError(name)\n"
          "        setattr(self, name, Fields())\n        return getattr(self, name)\n"
          "class PlanningScene(Fields):\n    def __init__(self, is_diff=False):\n"
          "        self.is_diff = is_diff\n");
    const Said said =
        python(program +
               "scene = planning_scene_diff('bench/maps/fused.bt')\n"
               "print(scene.is_diff, scene.robot_state.is_diff, scene.world.octomap.octomap.id, "
               "sorted(vars(scene.world)))\n"
               "for name in ('fused.ot', 'fused.bt'):\n"
               "    message = octomap_message('bench/maps/' + name)\n"
               "    print(name, message.binary, message.id, message.resolution, message.header.frame_id)\n"
               "    open(name + '.data', 'wb').write(message.data.tobytes())\n");
    ASSERT_EQ(said.exit_code, 0) << said.output;
    EXPECT_EQ(said.output,
              "True True OcTree ['octomap']\n"
              "fused.ot False OcTree 0.04 map\nfused.bt True OcTree 0.04 map\n");
    const std::unique_ptr<octomap::AbstractOcTree> saved(
        octomap::AbstractOcTree::read(path("bench/maps/fused.ot")));
    const auto* const expected = dynamic_cast<const octomap::OcTree*>(saved.get());
    ASSERT_NE(expected, nullptr);
    octomap::OcTree full(0.04);
    std::istringstream full_data(content(path("fused.ot.data")));
    full.readData(full_data);
    EXPECT_TRUE(full == *expected);
    octomap::OcTree binary(0.04);
    std::istringstream binary_data(content(path("fused.bt.data")));
    binary.readBinaryData(binary_data);
    EXPECT_GT(binary.size(), 1'000U);
}

}  // namespace
}  // namespace octoskin
