// What a command line says of the headers of messages: --frame and --stamp-now.
#pragma once

#include "tests/ros/arguments.hpp"
#include "tests/ros/codec.hpp"

namespace octoskin::ros {

class Headers {
  public:
    explicit Headers(const Arguments& arguments)
        : frame_(arguments.text("--frame", "")), is_stamped_now_(arguments.has("--stamp-now")) {}

    /// Changes all headers of a message of the type, also those within its fields.
    void change(Json& fields, const Codec& codec) const;

  private:
    std::string frame_;
    bool is_stamped_now_;
};

}  // namespace octoskin::ros
