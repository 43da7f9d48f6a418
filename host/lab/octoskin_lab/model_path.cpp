#include "host/lab/octoskin_lab/model_path.hpp"

#include <string>
#include <vector>

#include "host/apps/command_line/arguments.hpp"
#include "hw/sim/world/model_folders.hpp"

namespace octoskin::app {

void add_model_path(CLI::App& command) {
    command
        .add_option_function<std::vector<std::string>>(
            "--model-path",
            [](const std::vector<std::string>& folders) { sim::put_model_folders_first(folders); },
            "Folders for the world's model:// URIs, searched before those of SDF_PATH, "
            "GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH and GAZEBO_MODEL_PATH; separated by colons")
        ->delimiter(':')
        ->type_name("FOLDERS")
        ->expected(1)
        ->take_all()
        ->check(existing_path());
}

}  // namespace octoskin::app
